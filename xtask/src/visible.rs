use ndarray::{Array2, ArrayView2};

/// How much nearer, in pixels of disparity, a surface must be to hide another one. Less is the
/// slant of one surface from a pixel to the next, and the rounding of the truth.
const HIDES_PX: f32 = 1.0;

/// Which pixels `[[y, x]]` of the left image the right eye sees too, from the true disparity `d`
/// (NaN = unknown, which is not visible).
///
/// Every pixel is carried to its column in the right image, where a z-buffer keeps the nearest;
/// what lies behind it by more than a pixel, or outside the image, is hidden.
pub(crate) fn visible(truth: ArrayView2<'_, f32>) -> Array2<bool> {
    let width = truth.ncols();
    let mut mask = Array2::from_elem(truth.dim(), false);
    let mut nearest = vec![f32::NEG_INFINITY; width];
    for (truth, mut mask) in truth.rows().into_iter().zip(mask.rows_mut()) {
        nearest.fill(f32::NEG_INFINITY);
        for (x, &d) in truth.iter().enumerate() {
            if let Some(column) = column(x, d, width) {
                nearest[column] = nearest[column].max(d);
            }
        }
        for (x, (&d, mask)) in truth.iter().zip(&mut mask).enumerate() {
            *mask = column(x, d, width).is_some_and(|column| nearest[column] <= d + HIDES_PX);
        }
    }
    mask
}

/// The column of the right image that sees what the left image sees at `x`; `None` if `d` is
/// unknown or the column lies outside.
fn column(x: usize, d: f32, width: usize) -> Option<usize> {
    let column = (x as f32 - d).round();
    (0.0 <= column && column < width as f32).then_some(column as usize)
}

#[cfg(test)]
mod tests {
    use ndarray::array;
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_near_bar_hides_what_is_behind_it() {
        // A bar two pixels wide, at d = 3, before a wall at d = 1: it hides the two pixels of the
        // wall left of it, and the wall's first pixel is out of view.
        let truth = array![[1.0, 1.0, 1.0, 1.0, 1.0, 3.0, 3.0, 1.0, 1.0, f32::NAN]];
        let want = array![[
            false, true, true, false, false, true, true, true, true, false
        ]];
        assert_eq!(visible(truth.view()), want);
    }

    #[test]
    fn a_slope_hides_nothing() {
        // Two pixels that share a column differ by less than a pixel of disparity.
        let truth = Array2::from_shape_fn((2, 40), |(_, x)| 2.0 + 0.45 * x as f32);
        for ((_, x), &seen) in visible(truth.view()).indexed_iter() {
            // The first three pixels lead out of the image by more than half a pixel.
            assert_eq!(seen, x > 2, "column {x}");
        }
    }

    proptest! {
        /// Of all pixels that fall on one column, the nearest is visible; nothing is where the
        /// truth is unknown or leads out of the image.
        #[test]
        fn the_nearest_is_seen(truth in prop::collection::vec(-3.0f32..25.0, 20)) {
            let width = truth.len();
            let row = Array2::from_shape_vec((1, width), truth.clone()).unwrap();
            let mask = visible(row.view());
            for (x, &d) in truth.iter().enumerate() {
                let hidden = (0..width).any(|other| {
                    column(other, truth[other], width) == column(x, d, width)
                        && truth[other] > d + HIDES_PX
                });
                let inside = column(x, d, width).is_some();
                prop_assert_eq!(mask[[0, x]], inside && !hidden);
            }
        }
    }

    /// The derived mask agrees with the published ones on 99 % of the pixels whose truth counts.
    ///
    /// The data is not part of the repository; without it there is nothing to compare.
    #[test]
    fn the_derived_mask_is_the_published_one() {
        use stereo_formats::scene_folder::{Mask, StereoScene};
        let Some(data) = crate::data_folder::beside_the_checkout() else {
            return;
        };
        for scene in [
            "middlebury2001/tsukuba",
            "middlebury2001/venus",
            "middlebury2003/teddy",
        ] {
            let scene = StereoScene::open(data.join("stereo").join(scene)).unwrap();
            let truth = scene.truth().unwrap().unwrap();
            let published = scene.mask(Mask::Visible).unwrap().unwrap();
            let counts = scene.mask(Mask::Known).unwrap().unwrap();
            let derived = visible(truth.view());
            let mut total = 0;
            let mut same = 0;
            for ((derived, published), counts) in derived.iter().zip(&published).zip(&counts) {
                total += usize::from(*counts);
                same += usize::from(*counts && derived == published);
            }
            let agreement = same as f64 / total as f64;
            assert!(agreement >= 0.99, "{}: {agreement}", scene.description.name);
        }
    }
}
