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
