use ndarray::{Array2, ArrayView2};
use rayon::prelude::*;

use crate::Size;
use crate::bank_workspace::BandWorkspace;

/// The binomial low-pass `[1 4 6 4 1] / 16`.
const BINOMIAL: [f32; 5] = [1.0 / 16.0, 4.0 / 16.0, 6.0 / 16.0, 4.0 / 16.0, 1.0 / 16.0];

/// The next coarser scale of a plane: low-passed with [`BINOMIAL`] along both axes, every second
/// pixel kept (the first one first), borders replicated.
///
/// Coarse pixel `(x, y)` lies at fine pixel `(2 x, 2 y)`.
pub(crate) fn reduce(plane: ArrayView2<'_, f32>) -> Array2<f32> {
    let fine = Size::of_dim(plane.dim());
    let mut reduced = Array2::zeros(fine.halved().dim());
    let mut low_passed = vec![0.0; fine.width];
    for (y, out) in reduced.rows_mut().into_iter().enumerate() {
        let out = out.into_slice().expect("a fresh array is contiguous");
        reduce_row(plane, y, &mut low_passed, out);
    }
    reduced
}

/// The same into a plane of the right size, with the caller's threads and buffers.
pub(crate) fn reduce_into(
    plane: ArrayView2<'_, f32>,
    reduced: &mut Array2<f32>,
    bands: &mut [BandWorkspace],
) {
    let coarse = Size::of_dim(reduced.dim());
    let rows = coarse.height.div_ceil(bands.len());
    reduced
        .as_slice_mut()
        .expect("a planned plane is contiguous")
        .par_chunks_mut(rows * coarse.width)
        .zip(bands)
        .enumerate()
        .for_each(|(band, (out, workspace))| {
            for (y, out) in out.chunks_exact_mut(coarse.width).enumerate() {
                reduce_row(plane, band * rows + y, &mut workspace.row, out);
            }
        });
}

/// Row `y` of the coarser plane. `low_passed` is a buffer of at least the finer plane's width.
fn reduce_row(plane: ArrayView2<'_, f32>, y: usize, low_passed: &mut [f32], out: &mut [f32]) {
    let (height, width) = plane.dim();
    let low_passed = &mut low_passed[..width];
    low_passed.fill(0.0);
    for (k, tap) in BINOMIAL.iter().enumerate() {
        let row = plane.row((2 * y + k).saturating_sub(2).min(height - 1));
        let row = row.to_slice().expect("a plane is contiguous");
        for (sum, sample) in low_passed.iter_mut().zip(row) {
            *sum += tap * sample;
        }
    }
    let taps = |x: usize, at: &dyn Fn(usize) -> f32| {
        let taps = BINOMIAL.iter().enumerate();
        taps.map(|(k, tap)| tap * at(2 * x + k)).sum::<f32>()
    };
    // Where no tap falls beyond either end, the samples need no choosing.
    let (first, end) = (
        1.min(out.len()),
        (width.saturating_sub(1) / 2).max(1).min(out.len()),
    );
    let windows = low_passed.windows(BINOMIAL.len()).step_by(2);
    for (out, window) in out[first..end].iter_mut().zip(windows) {
        let mut sum = 0.0;
        for k in 0..BINOMIAL.len() {
            sum += BINOMIAL[k] * window[k];
        }
        *out = sum;
    }
    for x in (0..first).chain(end..out.len()) {
        out[x] = taps(x, &|at| low_passed[at.saturating_sub(2).min(width - 1)]);
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
