use disparity_pyramid::{DisparityField, EyeView};
use egocentric_depth::{Rectification, StereoRig, WrongFieldSize, resampled_into, resampled_rgb};
use ndarray::Array2;
use v1_gabor::{Binocular, LumaImage, Size};

use crate::Error;

/// What two eyes of any rig see, turned into what parallel pinholes would see.
#[derive(Clone, Debug)]
pub struct RectifiedEyes {
    rig: StereoRig,
    plan: Rectification,
    maps: Binocular<Array2<(f32, f32)>>,
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
        let black = LumaImage::new(Array2::zeros((1, 1)))?;
        let mut rectified = Self {
            rig: *rig,
            maps: plan.maps(),
            plan,
            luma: Binocular {
                left: black.clone(),
                right: black,
            },
            rgb: Binocular::default(),
        };
        rectified.take_in(eyes)?;
        Ok(rectified)
    }

    /// Rectifies another pair of the same rig, in the maps and the room of the last one. (Colours are
    /// made anew.)
    ///
    /// # Errors
    /// [`Error::Rig`] if the pair has another size and the eyes cannot be rectified in that.
    pub fn retake(&mut self, eyes: &Binocular<EyeView<'_>>) -> Result<(), Error> {
        if eyes.left.luma.size().dim() != self.maps.left.dim() {
            *self = Self::of(eyes, &self.rig)?;
            return Ok(());
        }
        self.take_in(eyes)
    }

    /// The rig that the pairs are taken with.
    #[must_use]
    pub const fn rig(&self) -> &StereoRig {
        &self.rig
    }

    fn take_in(&mut self, eyes: &Binocular<EyeView<'_>>) -> Result<(), Error> {
        let Self {
            maps, luma, rgb, ..
        } = self;
        for (eye, map, luma, rgb) in [
            (&eyes.left, &maps.left, &mut luma.left, &mut rgb.left),
            (&eyes.right, &maps.right, &mut luma.right, &mut rgb.right),
        ] {
            luma.write_over(Size::of_dim(map.dim()), |plane| {
                resampled_into(eye.luma.plane(), map, plane);
            })?;
            *rgb = eye.rgb.map(|rgb| resampled_rgb(rgb, map));
        }
        Ok(())
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

    /// The same, written over an earlier field.
    ///
    /// # Errors
    /// [`WrongFieldSize`] if the field is not one of this pair.
    pub fn as_taken_into(
        &self,
        field: &DisparityField,
        taken: &mut DisparityField,
    ) -> Result<(), WrongFieldSize> {
        self.plan.as_taken_into(field, taken)
    }
}
