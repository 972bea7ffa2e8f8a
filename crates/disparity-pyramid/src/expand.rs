use ndarray::{Array2, ArrayView2, Zip};
use rayon::prelude::*;
use v1_gabor::Size;

/// A plane of shifts on the next finer grid: the grid doubled (bilinear), and the values with it.
///
/// Fine pixel `(x, y)` lies at coarse `(x / 2, y / 2)`; beyond the last coarse pixel its value
/// holds.
pub(crate) fn expand(shifts: ArrayView2<'_, f32>, fine: Size) -> Array2<f32> {
    let mut expanded = Array2::zeros(fine.dim());
    expand_into(shifts, &mut expanded);
    expanded
}

/// The same into a plane of the finer grid, half a row and half a column as large at least.
pub(crate) fn expand_into(shifts: ArrayView2<'_, f32>, fine: &mut Array2<f32>) {
    let (height, width) = shifts.dim();
    let coarse = shifts
        .to_slice()
        .expect("planes are made in row-major order");
    let row = |y: usize| &coarse[y.min(height - 1) * width..][..width];
    let fine_width = fine.dim().1;
    fine.as_slice_mut()
        .expect("planes are made in row-major order")
        .par_chunks_mut(fine_width)
        .enumerate()
        .for_each(|(y, out)| {
            // The mean of the (up to four, at even places equal) neighbours, times two.
            let (top, bottom) = (row(y / 2), row(y.div_ceil(2)));
            let (pairs, single) = out.as_chunks_mut::<2>();
            let neighbours = top.array_windows::<2>().zip(bottom.array_windows::<2>());
            for (pair, (top, bottom)) in pairs.iter_mut().zip(neighbours) {
                let here = top[0] + bottom[0];
                *pair = [here, 0.5 * (here + (top[1] + bottom[1]))];
            }
            let last = top[width - 1] + bottom[width - 1];
            match (single, pairs) {
                ([single], _) => *single = last,
                (_, [.., pair]) => *pair = [last, last],
                _ => {}
            }
        });
}

/// The values doubled, into a plane of the same grid.
pub(crate) fn double_into(shifts: ArrayView2<'_, f32>, fine: &mut Array2<f32>) {
    Zip::from(fine)
        .and(shifts)
        .par_for_each(|fine, &shift| *fine = 2.0 * shift);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A field that grows steadily over the coarse grid grows as steadily over the fine one.
        #[test]
        fn a_slope_stays_a_slope(a in -3.0f32..3.0, b in -0.5f32..0.5, c in -0.5f32..0.5) {
            let coarse = Array2::from_shape_fn((9, 12), |(y, x)| a + b * x as f32 + c * y as f32);
            let fine = expand(coarse.view(), Size { width: 23, height: 17 });
            for ((y, x), &value) in fine.indexed_iter() {
                let expected = 2.0 * (a + b * x as f32 / 2.0 + c * y as f32 / 2.0);
                // Values reach 30; a few steps of f32 there.
                prop_assert!((value - expected).abs() < 2e-5);
            }
        }
    }
}
