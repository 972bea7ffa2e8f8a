use ndarray::{Array2, ArrayView2, Zip};
use v1_gabor::Size;

use crate::alteration::Alteration;

/// How much wider than the untouched truth OpenCV's range is on either side, px.
const RANGE_MARGIN_PX: f32 = 16.0;

/// The true disparity of an altered pair, px, NaN unknown or out of view.
pub(crate) struct AlteredTruth {
    /// `x_left - x_right`.
    pub(crate) d: Array2<f32>,
    /// `y_right - y_left`.
    pub(crate) dy: Array2<f32>,
}

impl AlteredTruth {
    /// The truth of an altered pair, from that of the untouched one; both components in the sign of
    /// files: left `(x, y)` matches `W(x - d, y)`; NaN where that lies outside the right picture.
    pub(crate) fn of(truth: ArrayView2<'_, f32>, alteration: &Alteration) -> Self {
        let size = Size::of_dim(truth.dim());
        let warp = alteration.warp(size);
        let inside = |at: f64, side: usize| 0.0 <= at && at <= (side - 1) as f64;
        let mut d = Array2::from_elem(truth.dim(), f32::NAN);
        let mut dy = d.clone();
        Zip::indexed(&mut d)
            .and(&mut dy)
            .and(truth)
            .for_each(|(y, x), d, dy, true_d| {
                let (x, y) = (x as f64, y as f64);
                let (u, v) = warp.at(x - f64::from(*true_d), y);
                // An unknown truth is nowhere.
                if inside(u, size.width) && inside(v, size.height) {
                    (*d, *dy) = ((x - u) as f32, (v - y) as f32);
                }
            });
        Self { d, dy }
    }
}

/// OpenCV's range on pairs whose right eye is out of place: the least disparity, and how many, a
/// multiple of 16.
pub(crate) fn opencv_range(truth: ArrayView2<'_, f32>) -> (i32, i32) {
    let known = || truth.iter().copied().filter(|d| d.is_finite());
    let least = (known().fold(f32::INFINITY, f32::min) - RANGE_MARGIN_PX).floor();
    let most = (known().fold(f32::NEG_INFINITY, f32::max) + RANGE_MARGIN_PX).ceil();
    let count = ((most - least) / 16.0).ceil() * 16.0;
    (least as i32, count as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_truth_is_carried_through_the_warp() {
        let truth = Array2::from_elem((21, 41), 4.0);
        let lower = Alteration {
            down_px: 2.5,
            ..Alteration::NONE
        };
        let lower = AlteredTruth::of(truth.view(), &lower);
        assert_eq!((lower.d[[5, 20]], lower.dy[[5, 20]]), (4.0, 2.5));
        assert!(lower.d[[19, 20]].is_nan(), "out of view below");
        assert!(lower.d[[5, 3]].is_nan(), "out of view to the left");
        let larger = Alteration {
            scale_percent: 10.0,
            ..Alteration::NONE
        };
        let larger = AlteredTruth::of(truth.view(), &larger);
        // The middle is (20, 10); the point that the right eye sees at 26 moves to 26.6.
        assert!((larger.d[[10, 30]] - 3.4).abs() < 1e-5);
        assert_eq!(opencv_range(truth.view()), (-12, 32));
    }
}
