use std::ops::Range;

use ndarray::Array2;
use rayon::prelude::*;

use crate::Validity;
use crate::refine::Shifts;

/// Half the width of the window that is looked at, in pixels.
const REACH: usize = 2;

const CONTIGUOUS: &str = "planes are made in row-major order";

/// Makes a pixel without an answer of its own (too little energy, or incoherent) valid if at least
/// so many of the 5 x 5 pixels around it are: the medians have given it their value by then. What
/// is left unexplained there is taken to be their mean.
///
/// A texture's own quiet spots, where an orientation or two fall below the threshold, are filled so;
/// an empty wall is not. `None` fills nothing.
pub(crate) fn fill(shifts: &mut Shifts, least: Option<usize>) {
    let Some(least) = least else {
        return;
    };
    let least = u8::try_from(least.max(1)).unwrap_or(u8::MAX);
    let (height, width) = shifts.dx.dim();
    let validity = shifts.validity.as_slice().expect(CONTIGUOUS);
    let residual = shifts.residual.as_slice().expect(CONTIGUOUS);
    // One for what is valid and what it leaves unexplained, nothing for the rest: sums of these need no
    // choice.
    let (mut ones, mut heard) = (vec![0u8; validity.len()], vec![0.0f32; validity.len()]);
    ones.par_chunks_mut(width)
        .zip(heard.par_chunks_mut(width))
        .zip(validity.par_chunks(width).zip(residual.par_chunks(width)))
        .for_each(|((ones, heard), (validity, residual))| {
            for (one, validity) in ones.iter_mut().zip(validity) {
                *one = u8::from(validity.is_valid());
            }
            for ((heard, residual), validity) in heard.iter_mut().zip(residual).zip(validity) {
                *heard = if validity.is_valid() { *residual } else { 0.0 };
            }
        });
    let (mut filled, mut residuals) = (shifts.validity.clone(), shifts.residual.clone());
    let rows = filled
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width);
    let residual_rows = residuals
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width);
    rows.zip(residual_rows).enumerate().for_each_init(
        || Columns::new(width),
        |columns, (y, (filled, residuals))| {
            columns.clear();
            for row in around(y, height) {
                let row = row * width..(row + 1) * width;
                columns.add(&ones[row.clone()], &heard[row]);
            }
            columns.count_windows();
            for x in 0..width {
                let asks = matches!(filled[x], Validity::NoEnergy | Validity::Incoherent);
                if asks && columns.windows[x] >= least {
                    filled[x] = Validity::Valid;
                    let sum: f32 = columns.sums[x..=x + 2 * REACH].iter().sum();
                    residuals[x] = sum / f32::from(columns.windows[x]);
                }
            }
        },
    );
    shifts.validity = filled;
    shifts.residual = residuals;
}

/// What the rows about one of them hold, column by column, with nothing beyond either end.
struct Columns {
    /// How many of each column are valid.
    counts: Vec<u8>,
    /// The sum of what these leave unexplained.
    sums: Vec<f32>,
    /// How many of the window around each pixel are valid.
    windows: Vec<u8>,
}

impl Columns {
    fn new(width: usize) -> Self {
        Self {
            counts: vec![0; width + 2 * REACH],
            sums: vec![0.0; width + 2 * REACH],
            windows: vec![0; width],
        }
    }

    fn clear(&mut self) {
        self.counts.fill(0);
        self.sums.fill(0.0);
    }

    fn add(&mut self, ones: &[u8], heard: &[f32]) {
        for (count, one) in self.counts[REACH..].iter_mut().zip(ones) {
            *count += one;
        }
        for (sum, heard) in self.sums[REACH..].iter_mut().zip(heard) {
            *sum += heard;
        }
    }

    fn count_windows(&mut self) {
        self.windows.fill(0);
        for offset in 0..=2 * REACH {
            for (window, count) in self.windows.iter_mut().zip(&self.counts[offset..]) {
                *window += count;
            }
        }
    }
}

/// The rows that a window around one of them reaches, of `length`.
fn around(at: usize, length: usize) -> Range<usize> {
    at.saturating_sub(REACH)..(at + REACH + 1).min(length)
}

impl Shifts {
    /// Shifts of which nothing is known yet.
    pub(crate) fn silent(dx: Array2<f32>, dy: Array2<f32>) -> Self {
        Self {
            validity: Array2::from_elem(dx.dim(), Validity::NoEnergy),
            residual: Array2::zeros(dx.dim()),
            covariance: None,
            dx,
            dy,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quiet_spot_is_filled_and_a_wall_is_not() {
        let mut shifts = Shifts::silent(Array2::zeros((20, 30)), Array2::zeros((20, 30)));
        shifts.residual.fill(0.25);
        for y in 0..20 {
            for x in 0..15 {
                shifts.validity[[y, x]] = Validity::Valid;
            }
        }
        shifts.validity[[10, 5]] = Validity::Incoherent;
        shifts.validity[[4, 7]] = Validity::OutOfView;
        fill(&mut shifts, Some(13));
        assert!(shifts.validity[[10, 5]].is_valid());
        assert_eq!(shifts.residual[[10, 5]], 0.25);
        assert_eq!(shifts.validity[[4, 7]], Validity::OutOfView);
        // Beside an edge, two columns of five are valid: ten of twenty-five.
        assert_eq!(shifts.validity[[10, 15]], Validity::NoEnergy);
        assert_eq!(shifts.validity[[10, 25]], Validity::NoEnergy);
        fill(&mut shifts, Some(10));
        assert!(shifts.validity[[10, 15]].is_valid());
        assert_eq!(shifts.validity[[10, 25]], Validity::NoEnergy);
    }
}
