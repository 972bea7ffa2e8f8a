use crate::rotation::Rotation;
use crate::{CameraIntrinsics, Head, Position};

/// A camera in its place in the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// The camera.
    pub intrinsics: CameraIntrinsics,
    /// Turns a direction of the camera frame into one of the head frame.
    pub rotation: Rotation,
    /// Where the centre of projection sits in the head.
    pub centre: Position<Head>,
}

/// A line of sight in the head frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where it starts.
    pub origin: Position<Head>,
    /// Where it goes; of any length but 0.
    pub direction: [f64; 3],
}

impl Eye {
    /// The line of sight of the pixel `(u, v)`.
    #[must_use]
    pub fn ray(&self, pixel: (f64, f64)) -> Ray {
        let (x, y) = self.intrinsics.normalised(pixel);
        Ray {
            origin: self.centre,
            direction: self.rotation.apply([x, y, 1.0]),
        }
    }

    /// The pixel `(u, v)` at which a point appears, `None` if it lies beside or behind the eye.
    ///
    /// The pixel may lie outside the image; an eye does not know how large its image is.
    #[must_use]
    pub fn project(&self, point: Position<Head>) -> Option<(f64, f64)> {
        let [x, y, z] = self.rotation.apply_inverse([
            point.x_m - self.centre.x_m,
            point.y_m - self.centre.y_m,
            point.z_m - self.centre.z_m,
        ]);
        (z > 0.0).then(|| self.intrinsics.pixel((x / z, y / z)))
    }
}
