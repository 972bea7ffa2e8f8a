use egocentric_depth::{CameraIntrinsics, StereoRig};
use v1_gabor::{Binocular, Size};

use crate::{
    gaze::{Gaze, NoGaze},
    pose::Pose,
};

/// A pan-tilt-vergence head, before it looks anywhere.
///
/// Both eyes have square pixels and the principal point in the middle of the image. The default is
/// the paper's head (section 3): 270 mm between the eyes, 1024 x 768 pixels, some 60 degrees wide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Head {
    /// The point midway between the eyes, in the room frame, in metres.
    pub position_m: [f64; 3],
    /// Where the head faces over the ground, in radians: 0 is the room's y axis, positive turns to
    /// the right (toward x), as the pans of the eyes do.
    pub heading_rad: f64,
    /// Size of both images.
    pub size: Size,
    /// Focal length of both eyes, in pixels.
    pub focal_px: f64,
    /// Distance between the eyes, in metres.
    pub baseline_m: f64,
}

impl Default for Head {
    fn default() -> Self {
        Self {
            position_m: [0.0; 3],
            heading_rad: 0.0,
            size: Size {
                width: 1024,
                height: 768,
            },
            focal_px: 887.0,
            baseline_m: 0.27,
        }
    }
}

impl Head {
    /// The same head with another number of pixels over the same width of the field of view.
    #[must_use]
    pub fn resized(self, size: Size) -> Self {
        Self {
            focal_px: self.focal_px * size.width as f64 / self.size.width as f64,
            size,
            ..self
        }
    }

    /// The camera of both eyes: principal point in the middle, ((width - 1)/2, (height - 1)/2).
    #[must_use]
    pub fn intrinsics(&self) -> CameraIntrinsics {
        CameraIntrinsics {
            focal_px: (self.focal_px, self.focal_px),
            principal_point_px: (
                (self.size.width as f64 - 1.0) / 2.0,
                (self.size.height as f64 - 1.0) / 2.0,
            ),
        }
    }

    /// Looks at a point of the room (metres): the head tilts until the point is on its horizontal
    /// plane, and each eye pans until the point is at its principal point.
    ///
    /// The head itself does not turn: a point to the side gives unequal pans.
    ///
    /// # Errors
    /// [`NoGaze`] if the point is not in front of the head, or the head has no pixels, no focal
    /// length or no baseline.
    pub fn fixate(&self, point_m: [f64; 3]) -> Result<Gaze, NoGaze> {
        let level = Pose::level(self.position_m.into(), self.heading_rad);
        let [x, y, z] = level.coordinates(point_m.into()).to_array();
        if z.is_nan() || z <= 0.0 {
            return Err(NoGaze::Behind { point_m });
        }
        // Both eyes lie on the axis of the tilt, so the tilt does not move them.
        let depth_m = z.hypot(y);
        let half_m = self.baseline_m / 2.0;
        let rig = StereoRig::vergent(
            Binocular {
                left: self.intrinsics(),
                right: self.intrinsics(),
            },
            self.baseline_m,
            Binocular {
                left: (x + half_m).atan2(depth_m),
                right: (x - half_m).atan2(depth_m),
            },
        )?
        .tilted((-y).atan2(z))?;
        Gaze::new(self.position_m, self.heading_rad, self.size, rig)
    }
}
