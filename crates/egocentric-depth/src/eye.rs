use crate::rotation::Rotation;
use crate::{CameraIntrinsics, Head, Lens, Position};

/// A camera in its place in the head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// The camera.
    pub intrinsics: CameraIntrinsics,
    /// What its lens bends.
    pub lens: Lens,
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
    /// The line of sight of the pixel `(u, v)`; `None` where the lens shows nothing that lies in
    /// front of it.
    #[must_use]
    pub fn ray(&self, pixel: (f64, f64)) -> Option<Ray> {
        let (x, y) = self.straight(pixel)?;
        Some(Ray {
            origin: self.centre,
            direction: self.rotation.apply([x, y, 1.0]),
        })
    }

    /// The point at a depth along the line of sight of a pixel, the depth being the z of the head frame;
    /// `None` if that line does not point forward.
    pub(crate) fn at_depth(&self, pixel: (f64, f64), depth_m: f64) -> Option<Position<Head>> {
        let ray = self.ray(pixel)?;
        let [x, y, z] = ray.direction;
        let from = ray.origin;
        (z > 0.0).then(|| {
            let stretch = (depth_m - from.z_m) / z;
            Position::new(from.x_m + stretch * x, from.y_m + stretch * y, depth_m)
        })
    }

    /// Where the line of sight of a pixel crosses the plane `z = 1` of the eye's own frame.
    pub(crate) fn straight(&self, pixel: (f64, f64)) -> Option<(f64, f64)> {
        self.lens.undistort(self.intrinsics.normalised(pixel))
    }

    /// A point of the head in the eye's own frame.
    pub(crate) fn coordinates(&self, point: Position<Head>) -> [f64; 3] {
        self.rotation.apply_inverse([
            point.x_m - self.centre.x_m,
            point.y_m - self.centre.y_m,
            point.z_m - self.centre.z_m,
        ])
    }

    /// The pixel `(u, v)` at which a point appears, `None` if it lies beside or behind the eye.
    ///
    /// The pixel may lie outside the image; an eye does not know how large its image is.
    #[must_use]
    pub fn project(&self, point: Position<Head>) -> Option<(f64, f64)> {
        let [x, y, z] = self.coordinates(point);
        (z > 0.0).then(|| self.intrinsics.pixel(self.lens.distort((x / z, y / z))))
    }
}
