use egocentric_depth::{CameraIntrinsics, Lens};
use v1_gabor::Size;

use crate::{pose::Pose, vector::Vector};

/// A camera at a place of the room.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eye {
    pose: Pose,
    camera: CameraIntrinsics,
    lens: Lens,
    pub(crate) size: Size,
}

impl Eye {
    /// A pinhole.
    pub(crate) const fn new(pose: Pose, camera: CameraIntrinsics, size: Size) -> Self {
        Self {
            pose,
            camera,
            lens: Lens::Pinhole,
            size,
        }
    }

    /// The same camera behind a lens.
    pub(crate) const fn behind(self, lens: Lens) -> Self {
        Self { lens, ..self }
    }

    /// The pinhole.
    pub(crate) const fn origin(&self) -> Vector {
        self.pose.origin
    }

    /// The direction of a point of the image, scaled to 1 along the optical axis. Where the lens shows
    /// nothing that lies in front, it is a pinhole's.
    pub(crate) fn ray(&self, x: f64, y: f64) -> Vector {
        let bent = self.camera.normalised((x, y));
        let (x, y) = self.lens.undistort(bent).unwrap_or(bent);
        self.pose.direction(Vector::new(x, y, 1.0))
    }

    /// Where a point of the room appears, in pixels; `None` behind the pinhole.
    pub(crate) fn project(&self, point: Vector) -> Option<(f64, f64)> {
        let Vector { x, y, z } = self.pose.coordinates(point);
        (z > 0.0).then(|| self.camera.pixel(self.lens.distort((x / z, y / z))))
    }

    /// Whether a point of the image lies between the centres of its outermost pixels, where the
    /// image can be interpolated.
    pub(crate) fn shows(&self, (x, y): (f64, f64)) -> bool {
        (0.0..=(self.size.width - 1) as f64).contains(&x)
            && (0.0..=(self.size.height - 1) as f64).contains(&y)
    }
}
