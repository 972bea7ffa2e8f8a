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
    let least = least.max(1);
    let (height, width) = shifts.dx.dim();
    let validity = shifts.validity.as_slice().expect(CONTIGUOUS);
    let filled: Vec<_> = (0..height)
        .into_par_iter()
        .flat_map_iter(|y| {
            let mut columns = vec![0u8; width];
            for row in around(y, height) {
                for (column, validity) in columns.iter_mut().zip(&validity[row * width..]) {
                    *column += u8::from(validity.is_valid());
                }
            }
            let asks = move |x: &usize| {
                matches!(
                    validity[y * width + x],
                    Validity::NoEnergy | Validity::Incoherent
                )
            };
            let answered = move |x: &usize| {
                let columns = &columns[around(*x, width)];
                columns
                    .iter()
                    .map(|&valid| usize::from(valid))
                    .sum::<usize>()
                    >= least
            };
            (0..width)
                .filter(asks)
                .filter(answered)
                .map(move |x| (y, x))
        })
        .collect();
    let residuals: Vec<f32> = filled
        .iter()
        .map(|&(y, x)| {
            let places = around(y, height).flat_map(|v| around(x, width).map(move |u| [v, u]));
            let valid = places.filter(|&place| shifts.validity[place].is_valid());
            let (count, sum) = valid.fold((0.0, 0.0), |(count, sum), place| {
                (count + 1.0, sum + shifts.residual[place])
            });
            sum / count
        })
        .collect();
    for (place, residual) in filled.into_iter().zip(residuals) {
        shifts.validity[place] = Validity::Valid;
        shifts.residual[place] = residual;
    }
}

/// The rows or columns that a window around one of them reaches, of `length`.
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
