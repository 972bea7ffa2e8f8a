/// A pinhole camera: what turns a pixel into a direction.
///
/// A point `(x, y, z)` of the camera frame (x right, y down, z forward) appears at
/// `u = cx + fx x / z`, `v = cy + fy y / z`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraIntrinsics {
    /// Focal lengths `(fx, fy)` in pixels.
    pub focal_px: (f64, f64),
    /// Principal point `(cx, cy)` in pixels.
    pub principal_point_px: (f64, f64),
}

impl CameraIntrinsics {
    /// Where the line of sight of the pixel `(u, v)` crosses the plane `z = 1` of the camera
    /// frame: `((u - cx) / fx, (v - cy) / fy)`, without unit.
    #[must_use]
    pub fn normalised(&self, (u, v): (f64, f64)) -> (f64, f64) {
        let (cx, cy) = self.principal_point_px;
        let (fx, fy) = self.focal_px;
        ((u - cx) / fx, (v - cy) / fy)
    }

    /// The pixel `(u, v)` whose line of sight crosses the plane `z = 1` at `(x, y)`: the inverse
    /// of [`CameraIntrinsics::normalised`].
    #[must_use]
    pub fn pixel(&self, (x, y): (f64, f64)) -> (f64, f64) {
        let (cx, cy) = self.principal_point_px;
        let (fx, fy) = self.focal_px;
        (cx + fx * x, cy + fy * y)
    }
}
