use ndarray::{Array2, ArrayView2, Zip};
use stereo_formats::scene_folder::{Mask, SceneBroken, StereoScene};

use crate::continuous::continuous;
use crate::textured::textured;
use crate::visible::visible;

/// The pixels of a scene over which errors are taken. All planes are `[[y, x]]`, and none holds a
/// pixel whose truth is unknown.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Masks {
    /// The truth is known.
    pub(crate) all: Array2<bool>,
    /// The right eye sees it too.
    pub(crate) visible: Array2<bool>,
    /// Visible, in texture, and on a continuous surface.
    pub(crate) textured: Array2<bool>,
}

impl Masks {
    /// The masks of a scene: visible pixels from its own `mask_nonocc` if there is one, else from
    /// the truth; texture from the left picture.
    pub(crate) fn of(
        scene: &StereoScene,
        truth: ArrayView2<'_, f32>,
        left: ArrayView2<'_, [u8; 3]>,
    ) -> Result<Self, SceneBroken> {
        let visible = match scene.mask(Mask::Visible)? {
            Some(published) => published,
            None => visible(truth),
        };
        Ok(Self::new(truth, visible, left))
    }

    fn new(
        truth: ArrayView2<'_, f32>,
        visible: Array2<bool>,
        left: ArrayView2<'_, [u8; 3]>,
    ) -> Self {
        let all = truth.mapv(f32::is_finite);
        let visible = both(&all, &visible);
        let textured = both(&textured(left), &continuous(truth));
        Self {
            textured: both(&textured, &visible),
            visible,
            all,
        }
    }

    /// The pixels that are visible and that the estimator itself calls valid.
    pub(crate) fn estimated(&self, valid: &Array2<bool>) -> Array2<bool> {
        both(&self.visible, valid)
    }
}

fn both(one: &Array2<bool>, other: &Array2<bool>) -> Array2<bool> {
    Zip::from(one)
        .and(other)
        .map_collect(|&one, &other| one && other)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Textured pixels are visible, visible ones known, whatever the published mask says.
        #[test]
        fn each_mask_lies_in_the_one_before(
            truth in prop::collection::vec(prop_oneof![9 => 0.0f32..9.0, 1 => Just(f32::NAN)], 60),
            published in prop::collection::vec(any::<bool>(), 60),
            valid in prop::collection::vec(any::<bool>(), 60),
            seed: u8,
        ) {
            let shape = (5, 12);
            let truth = Array2::from_shape_vec(shape, truth).unwrap();
            let published = Array2::from_shape_vec(shape, published).unwrap();
            let valid = Array2::from_shape_vec(shape, valid).unwrap();
            let left = Array2::from_shape_fn(shape, |(y, x)| {
                [seed.wrapping_mul((3 * x + 7 * y) as u8); 3]
            });
            let masks = Masks::new(truth.view(), published.clone(), left.view());
            let estimated = masks.estimated(&valid);
            for (index, &d) in truth.indexed_iter() {
                prop_assert_eq!(masks.all[index], d.is_finite());
                prop_assert_eq!(masks.visible[index], d.is_finite() && published[index]);
                prop_assert!(masks.visible[index] || !masks.textured[index]);
                prop_assert_eq!(estimated[index], masks.visible[index] && valid[index]);
            }
        }
    }
}
