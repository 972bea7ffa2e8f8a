use egocentric_depth::CameraIntrinsics;
use v1_gabor::Size;

use crate::{pose::Pose, vector::Vector};

/// A pinhole camera at a place of the room.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eye {
    pose: Pose,
    camera: CameraIntrinsics,
    pub(crate) size: Size,
}

impl Eye {
    pub(crate) const fn new(pose: Pose, camera: CameraIntrinsics, size: Size) -> Self {
        Self { pose, camera, size }
    }

    /// The pinhole.
    pub(crate) const fn origin(&self) -> Vector {
        self.pose.origin
    }

    /// The direction of a point of the image, scaled to 1 along the optical axis.
    pub(crate) fn ray(&self, x: f64, y: f64) -> Vector {
        let ((fx, fy), (cx, cy)) = (self.camera.focal_px, self.camera.principal_point_px);
        self.pose
            .direction(Vector::new((x - cx) / fx, (y - cy) / fy, 1.0))
    }

    /// Where a point of the room appears, in pixels; `None` behind the pinhole.
    pub(crate) fn project(&self, point: Vector) -> Option<(f64, f64)> {
        let ((fx, fy), (cx, cy)) = (self.camera.focal_px, self.camera.principal_point_px);
        let Vector { x, y, z } = self.pose.coordinates(point);
        (z > 0.0).then(|| (cx + fx * x / z, cy + fy * y / z))
    }

    /// Whether a point of the image lies between the centres of its outermost pixels, where the
    /// image can be interpolated.
    pub(crate) fn shows(&self, (x, y): (f64, f64)) -> bool {
        (0.0..=(self.size.width - 1) as f64).contains(&x)
            && (0.0..=(self.size.height - 1) as f64).contains(&y)
    }
}
