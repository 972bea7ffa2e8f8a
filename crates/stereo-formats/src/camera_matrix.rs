//! The camera matrix of calibration files, `[fx 0 cx; 0 fy cy; 0 0 1]`.

use egocentric_depth::CameraIntrinsics;

/// The camera of nine numbers, row by row; `None` if they are no camera without skew.
pub(crate) fn camera(k: &[f64]) -> Option<CameraIntrinsics> {
    match *k {
        [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0] => Some(CameraIntrinsics {
            focal_px: (fx, fy),
            principal_point_px: (cx, cy),
        }),
        _ => None,
    }
}

/// The nine numbers of a camera.
pub(crate) const fn numbers(camera: &CameraIntrinsics) -> [f64; 9] {
    let ((fx, fy), (cx, cy)) = (camera.focal_px, camera.principal_point_px);
    [fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]
}

/// Nine numbers as three rows; `None` if they are not nine.
pub(crate) fn rows(numbers: &[f64]) -> Option<[[f64; 3]; 3]> {
    match *numbers {
        [a, b, c, d, e, f, g, h, i] => Some([[a, b, c], [d, e, f], [g, h, i]]),
        _ => None,
    }
}
