use std::ops::Range;

use ndarray::Array2;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::Validity;
use crate::shifts::Shifts;

/// Half the width of the window that is looked at, in pixels.
const REACH: usize = 2;

const CONTIGUOUS: &str = "planes are made in row-major order";

/// Says how sure each pixel is, and makes one without an answer of its own (too little energy, or
/// incoherent) valid if at least so many of the 5 x 5 pixels around it are: the medians have given it
/// their value by then. What is left unexplained there is taken to be their mean.
///
/// A texture's own quiet spots, where an orientation or two fall below the threshold, are filled so;
/// an empty wall is not. `None` fills nothing. `ones` is room for a plane.
pub(crate) fn fill(
    shifts: &mut Shifts,
    confidence: &mut Array2<f32>,
    ones: &mut Array2<u8>,
    least: Option<usize>,
) {
    // More than there are fill nothing.
    let least = least.map_or(u8::MAX, |least| {
        u8::try_from(least.max(1)).unwrap_or(u8::MAX)
    });
    let (height, width) = shifts.dx.dim();
    let ones = ones.as_slice_mut().expect(CONTIGUOUS);
    let validity = shifts.validity.as_slice_mut().expect(CONTIGUOUS);
    ones.par_chunks_mut(width)
        .zip(validity.par_chunks(width))
        .for_each(|(ones, validity)| {
            for (one, validity) in ones.iter_mut().zip(validity) {
                *one = u8::from(validity.is_valid());
            }
        });
    let ones = &*ones;
    let residual = shifts.residual.as_slice().expect(CONTIGUOUS);
    let confidence = confidence.as_slice_mut().expect(CONTIGUOUS);
    validity
        .par_chunks_mut(width)
        .zip(confidence.par_chunks_mut(width))
        .enumerate()
        .for_each(|(y, (validity, confidence))| {
            Arch::new().dispatch(Row {
                rows: around(y, height),
                y,
                ones,
                residual,
                least,
                validity,
                confidence,
            });
        });
}

/// One row's work.
struct Row<'a> {
    /// The rows that windows around this one reach.
    rows: Range<usize>,
    y: usize,
    /// Of the whole plane.
    ones: &'a [u8],
    residual: &'a [f32],
    least: u8,
    /// Of this row.
    validity: &'a mut [Validity],
    confidence: &'a mut [f32],
}

impl WithSimd for Row<'_> {
    type Output = ();

    // The loops are compiled for the machine's vectors.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Row {
            rows,
            y,
            ones,
            residual,
            least,
            validity,
            confidence,
        } = self;
        let width = validity.len();
        let row = |y: usize| y * width..(y + 1) * width;
        let own = confidence.iter_mut().zip(&residual[row(y)]);
        for ((confidence, &residual), &one) in own.zip(&ones[row(y)]) {
            *confidence = heard(one, sureness(residual));
        }
        let strips = validity.chunks_mut(STRIP).zip(confidence.chunks_mut(STRIP));
        for (strip, (validity, confidence)) in strips.enumerate() {
            let mut columns = Columns::NONE;
            let start = strip * STRIP;
            let (first, last) = (start.saturating_sub(REACH), start + validity.len() + REACH);
            for y in rows.clone() {
                let here = y * width + first..y * width + last.min(width);
                let place = first + REACH - start;
                columns.add(&ones[here.clone()], &residual[here], place);
            }
            columns.count_windows();
            let asking = validity.iter_mut().zip(confidence).enumerate();
            for (x, (validity, confidence)) in asking {
                let asks = matches!(validity, Validity::NoEnergy | Validity::Incoherent);
                if asks && columns.windows[x] >= least {
                    *validity = Validity::Valid;
                    let sum: f32 = columns.sums[x..=x + 2 * REACH].iter().sum();
                    *confidence = sureness(sum / f32::from(columns.windows[x]));
                }
            }
        }
    }
}

/// From what the orientations leave unexplained, in pixels, to a confidence from 0 to 1.
#[inline(always)]
fn sureness(residual_px: f32) -> f32 {
    1.0 / (1.0 + (residual_px / 0.2).powi(2))
}

/// A number where a pixel is valid, and 0 where not, whatever the number is there.
#[inline(always)]
fn heard(one: u8, number: f32) -> f32 {
    if one == 1 { number } else { 0.0 }
}

/// Pixels whose windows are counted at a time.
const STRIP: usize = 256;

/// What the rows about one of them hold, column by column from [`REACH`] before a strip to as far
/// behind it, with nothing beyond either end of a row.
struct Columns {
    /// How many of each column are valid.
    counts: [u8; STRIP + 2 * REACH],
    /// The sum of what these leave unexplained.
    sums: [f32; STRIP + 2 * REACH],
    /// How many of the window around each pixel are valid.
    windows: [u8; STRIP],
}

impl Columns {
    const NONE: Self = Self {
        counts: [0; STRIP + 2 * REACH],
        sums: [0.0; STRIP + 2 * REACH],
        windows: [0; STRIP],
    };

    /// Adds part of a row, whose first pixel belongs to the column of this number.
    #[inline(always)]
    fn add(&mut self, ones: &[u8], residual: &[f32], first: usize) {
        for (count, one) in self.counts[first..].iter_mut().zip(ones) {
            *count += one;
        }
        let numbers = residual.iter().zip(ones);
        for (sum, (&residual, &one)) in self.sums[first..].iter_mut().zip(numbers) {
            *sum += heard(one, residual);
        }
    }

    #[inline(always)]
    fn count_windows(&mut self) {
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

#[cfg(test)]
mod tests {
    use v1_gabor::Size;

    use super::*;

    #[test]
    fn a_quiet_spot_is_filled_and_a_wall_is_not() {
        let size = Size {
            width: 30,
            height: 20,
        };
        let mut shifts = Shifts::silent(size);
        shifts.residual.fill(0.1);
        for y in 0..20 {
            for x in 0..15 {
                shifts.validity[[y, x]] = Validity::Valid;
            }
        }
        shifts.validity[[10, 5]] = Validity::Incoherent;
        shifts.residual[[10, 5]] = 3.0;
        shifts.validity[[4, 7]] = Validity::OutOfView;
        let mut confidence = Array2::from_elem(size.dim(), 7.0);
        let mut ones = Array2::from_elem(size.dim(), 7);
        fill(&mut shifts, &mut confidence, &mut ones, Some(13));
        assert!(shifts.validity[[10, 5]].is_valid());
        // Its neighbours leave half of what halves a confidence, and its own residual does not count.
        for pixel in [[10, 5], [10, 6]] {
            assert!((confidence[pixel] - 0.8).abs() < 1e-6);
        }
        assert_eq!(shifts.validity[[4, 7]], Validity::OutOfView);
        assert_eq!(confidence[[4, 7]], 0.0);
        // Beside an edge, two columns of five are valid: ten of twenty-five.
        assert_eq!(shifts.validity[[10, 15]], Validity::NoEnergy);
        assert_eq!(confidence[[10, 15]], 0.0);
        assert_eq!(shifts.validity[[10, 25]], Validity::NoEnergy);
        fill(&mut shifts, &mut confidence, &mut ones, Some(10));
        assert!(shifts.validity[[10, 15]].is_valid());
        assert_eq!(shifts.validity[[10, 25]], Validity::NoEnergy);
    }
}
