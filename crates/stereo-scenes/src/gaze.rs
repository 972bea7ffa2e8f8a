use egocentric_depth::{BadRig, StereoRig};
use v1_gabor::{Binocular, Size};

use crate::{eye::Eye, pose::Pose, vector::Vector};

/// A head that looks somewhere: a rig of two eyes at a place of the room.
///
/// The images have at least one pixel, and the place is a finite point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaze {
    position_m: [f64; 3],
    heading_rad: f64,
    size: Size,
    rig: StereoRig,
}

/// Why a head cannot look there.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoGaze {
    /// The point to look at is not in front of the head.
    #[error("the point {point_m:?} m is not in front of the head; turn its heading first")]
    Behind {
        /// The point, in the room frame.
        point_m: [f64; 3],
    },
    /// The head stands nowhere, or faces nowhere.
    #[error("the head's position {position_m:?} m or heading {heading_rad} rad is not finite")]
    Nowhere {
        /// The place, in the room frame.
        position_m: [f64; 3],
        /// The heading.
        heading_rad: f64,
    },
    /// An image without pixels.
    #[error("an image of {0} pixels shows nothing")]
    Size(Size),
    /// The eyes cannot be.
    #[error(transparent)]
    Rig(#[from] BadRig),
}

impl Gaze {
    /// Puts a rig of two eyes, of any attitude and behind any lens, at a place of the room: `position_m` is
    /// the point midway between the eyes, `heading_rad` as in [`Head`](crate::Head), `size` that of
    /// both images.
    ///
    /// # Errors
    /// [`NoGaze`] if the place is not finite or the size is empty.
    pub fn new(
        position_m: [f64; 3],
        heading_rad: f64,
        size: Size,
        rig: StereoRig,
    ) -> Result<Self, NoGaze> {
        if !(heading_rad.is_finite() && position_m.iter().all(|c| c.is_finite())) {
            return Err(NoGaze::Nowhere {
                position_m,
                heading_rad,
            });
        }
        if size.width == 0 || size.height == 0 {
            return Err(NoGaze::Size(size));
        }
        Ok(Self {
            position_m,
            heading_rad,
            size,
            rig,
        })
    }

    /// The point midway between the eyes, in the room frame, in metres.
    #[must_use]
    pub const fn position_m(&self) -> [f64; 3] {
        self.position_m
    }

    /// Where the head faces over the ground, in radians, positive to the right of the room's y.
    #[must_use]
    pub const fn heading_rad(&self) -> f64 {
        self.heading_rad
    }

    /// Size of both images.
    #[must_use]
    pub const fn size(&self) -> Size {
        self.size
    }

    /// The eyes: what level 3 needs to turn disparity into depth.
    #[must_use]
    pub const fn rig(&self) -> StereoRig {
        self.rig
    }

    /// A point of the room in the observer frame: origin midway between the eyes, x right, y down,
    /// z forward over the ground, whatever the tilt. Metres.
    #[must_use]
    pub fn observe(&self, point_m: [f64; 3]) -> [f64; 3] {
        self.level().coordinates(point_m.into()).to_array()
    }

    /// A point of the room in the left and the right image, in pixels; `None` for an eye that has
    /// it behind. The point may lie outside the image.
    #[must_use]
    pub fn project(&self, point_m: [f64; 3]) -> Binocular<Option<(f64, f64)>> {
        self.eyes().map(|eye| eye.project(point_m.into()))
    }

    fn level(&self) -> Pose {
        Pose::level(Vector::from(self.position_m), self.heading_rad)
    }

    /// The head frame: the observer frame, tilted.
    pub(crate) fn head(&self) -> Pose {
        self.level().tilted(self.rig.tilt_rad())
    }

    pub(crate) fn eyes(&self) -> Binocular<Eye> {
        let (head, half_m) = (self.head(), self.rig.baseline_m() / 2.0);
        if !self.rig.only_pans() {
            return self.rig.eyes().map(|eye| {
                let pose = head.placed(eye.centre.to_array(), &eye.rotation);
                Eye::new(pose, eye.intrinsics, self.size).behind(eye.lens)
            });
        }
        // Eyes that only pan are the usual ones, and need one turn fewer.
        let (pan, camera) = (self.rig.pan_rad(), self.rig.intrinsics());
        Binocular {
            left: Eye::new(
                head.shifted(-half_m).panned(pan.left),
                camera.left,
                self.size,
            ),
            right: Eye::new(
                head.shifted(half_m).panned(pan.right),
                camera.right,
                self.size,
            ),
        }
    }
}
