use disparity_pyramid::{DisparityField, EyeView};
use egocentric_depth::{Rectification, StereoRig, WrongFieldSize, resampled_rgb};
use ndarray::Array2;
use v1_gabor::{Binocular, LumaImage};

use crate::Error;

/// What two eyes of any rig see, turned into what parallel pinholes would see.
#[derive(Clone, Debug)]
pub struct RectifiedEyes {
    plan: Rectification,
    luma: Binocular<LumaImage>,
    rgb: Binocular<Option<Array2<[u8; 3]>>>,
}

impl RectifiedEyes {
    /// Rectifies a pair that this rig took.
    ///
    /// # Errors
    /// [`Error::Rig`] if the eyes are no rig along their own baseline.
    pub fn of(eyes: &Binocular<EyeView<'_>>, rig: &StereoRig) -> Result<Self, Error> {
        let plan = Rectification::plan(rig, eyes.left.luma.size())?;
        let maps = plan.maps();
        let luma = plan.rectify(&eyes.as_ref().map(|eye| eye.luma))?;
        let rgb = Binocular {
            left: eyes.left.rgb.map(|rgb| resampled_rgb(rgb, &maps.left)),
            right: eyes.right.rgb.map(|rgb| resampled_rgb(rgb, &maps.right)),
        };
        Ok(Self { plan, luma, rgb })
    }

    /// The rectified pair, as the dense estimator takes it.
    #[must_use]
    pub fn views(&self) -> Binocular<EyeView<'_>> {
        Binocular {
            left: EyeView {
                luma: &self.luma.left,
                rgb: self.rgb.left.as_ref().map(|rgb| rgb.view()),
            },
            right: EyeView {
                luma: &self.luma.right,
                rgb: self.rgb.right.as_ref().map(|rgb| rgb.view()),
            },
        }
    }

    /// A field of the rectified pair as one of the pair as it was taken; see
    /// [`Rectification::as_taken`].
    ///
    /// # Errors
    /// [`WrongFieldSize`] if the field is not one of this pair.
    pub fn as_taken(&self, field: &DisparityField) -> Result<DisparityField, WrongFieldSize> {
        self.plan.as_taken(field)
    }
}
