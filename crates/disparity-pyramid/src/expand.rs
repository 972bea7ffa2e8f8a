use ndarray::{Array2, ArrayView2, Zip};
use v1_gabor::Size;

/// A plane of shifts on the next finer grid: the grid doubled (bilinear), and the values with it.
///
/// Fine pixel `(x, y)` lies at coarse `(x / 2, y / 2)`; beyond the last coarse pixel its value
/// holds.
pub(crate) fn expand(shifts: ArrayView2<'_, f32>, fine: Size) -> Array2<f32> {
    let (height, width) = shifts.dim();
    let split = |at: usize, length: usize| {
        let low = (at / 2).min(length - 1);
        let high = at.div_ceil(2).min(length - 1);
        (low, high)
    };
    let mut expanded = Array2::zeros(fine.dim());
    Zip::indexed(&mut expanded).par_for_each(|(y, x), out| {
        let (top, bottom) = split(y, height);
        let (left, right) = split(x, width);
        // The mean of the (up to four, at even places equal) neighbours, times two.
        *out = 0.5
            * (shifts[[top, left]]
                + shifts[[top, right]]
                + shifts[[bottom, left]]
                + shifts[[bottom, right]]);
    });
    expanded
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
