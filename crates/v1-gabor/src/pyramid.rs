use ndarray::{Array2, ArrayView2};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::Size;

/// The binomial low-pass `[1 4 6 4 1] / 16`.
const BINOMIAL: [f32; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];

/// The next coarser scale of a plane: low-passed with [`BINOMIAL`] along both axes, every second
/// pixel kept (the first one first), borders replicated.
///
/// Coarse pixel `(x, y)` lies at fine pixel `(2 x, 2 y)`.
pub(crate) fn reduce(plane: ArrayView2<'_, f32>) -> Array2<f32> {
    let mut reduced = Array2::zeros(Size::of_dim(plane.dim()).halved().dim());
    reduce_into(plane, &mut reduced);
    reduced
}

/// The same into a plane of the right size.
pub(crate) fn reduce_into(plane: ArrayView2<'_, f32>, reduced: &mut Array2<f32>) {
    let width = reduced.ncols();
    reduced
        .as_slice_mut()
        .expect("a planned plane is contiguous")
        .par_chunks_exact_mut(width)
        .enumerate()
        .for_each(|(y, out)| Arch::new().dispatch(ReduceRow { plane, y, out }));
}

/// Coarse pixels of a row that are made together, so that what they are made from needs no buffer.
const STRIP: usize = 256;

/// Columns under the outer taps of a pixel, on either side.
const REACH: usize = BINOMIAL.len() / 2;

/// Row `y` of the coarser plane, compiled for the machine's vectors.
struct ReduceRow<'a> {
    plane: ArrayView2<'a, f32>,
    y: usize,
    out: &'a mut [f32],
}

impl NullaryFnOnce for ReduceRow<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { plane, y, out } = self;
        let (height, width) = plane.dim();
        for (strip, out) in out.chunks_mut(STRIP).enumerate() {
            // The columns from the first pixel's first tap to the last pixel's last one; the first of
            // those that the plane has stands at `first`.
            let start = 2 * STRIP * strip;
            let columns =
                start.saturating_sub(REACH)..(start + 2 * out.len() - 1 + REACH).min(width);
            let first = columns.start + REACH - start;
            let mut low_passed = [0.0f32; 2 * STRIP + 2 * REACH];
            let own = &mut low_passed[first..first + columns.len()];
            for (k, tap) in BINOMIAL.iter().enumerate() {
                let row = plane.row((2 * y + k).saturating_sub(REACH).min(height - 1));
                let row = row.to_slice().expect("a plane is contiguous");
                for (sum, sample) in own.iter_mut().zip(&row[columns.clone()]) {
                    *sum += tap * sample;
                }
            }
            let (before, after) = (own[0], own[own.len() - 1]);
            low_passed[..first].fill(before);
            low_passed[first + columns.len()..].fill(after);
            let windows = low_passed.windows(BINOMIAL.len()).step_by(2);
            for (out, window) in out.iter_mut().zip(windows) {
                let mut sum = 0.0;
                for k in 0..BINOMIAL.len() {
                    sum += BINOMIAL[k] * window[k];
                }
                *out = sum;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// The low-pass has unit gain at standstill, borders included.
        #[test]
        fn a_constant_stays_constant(
            width in 1usize..40, height in 1usize..40, luma in -2.0f32..2.0,
        ) {
            let reduced = reduce(Array2::from_elem((height, width), luma).view());
            prop_assert_eq!(reduced.dim(), (height.div_ceil(2), width.div_ceil(2)));
            // Five taps that sum to one in f32, twice: a few units in the last place.
            prop_assert!(reduced.iter().all(|&v| (v - luma).abs() <= 1e-6));
        }

        /// Strips of a row and single pixels of it are made alike.
        #[test]
        fn strips_are_pixels(width in 1usize..1200, seed in 1u32..1000) {
            let sample = |x: usize| ((x as u32).wrapping_mul(seed) % 251) as f32 / 251.0;
            let reduced = reduce(Array2::from_shape_fn((1, width), |(_, x)| sample(x)).view());
            for (x, found) in reduced.iter().enumerate() {
                let tap = |k: usize| sample((2 * x + k).saturating_sub(REACH).min(width - 1));
                let want: f32 = (0..BINOMIAL.len()).map(|k| BINOMIAL[k] * tap(k)).sum();
                // Sixteen sums of numbers below 1.
                prop_assert!((found - want).abs() < 2e-6, "{found} and {want} at {x}");
            }
        }

        /// A slope keeps its place: coarse `(x, y)` is fine `(2 x, 2 y)` away from the borders.
        #[test]
        fn a_slope_keeps_its_place(along_x in -1.0f32..1.0, along_y in -1.0f32..1.0) {
            let plane = Array2::from_shape_fn((24, 30), |(y, x)| {
                along_x * x as f32 + along_y * y as f32
            });
            let reduced = reduce(plane.view());
            for y in 1..11 {
                for x in 1..14 {
                    let expected = plane[[2 * y, 2 * x]];
                    // Values reach 54; f32 steps there are 4e-6, ten sums a pixel.
                    prop_assert!((reduced[[y, x]] - expected).abs() < 1e-4);
                }
            }
        }
    }
}
