/// Depth in metres of a pixel of a parallel rig: `Z = f b / (d + doffs)`, NaN where `d + doffs`
/// is not positive.
///
/// `focal_baseline` is `f b` in pixel metres, `d = -dx` the disparity in pixels and
/// `doffs = cx_right - cx_left` the disparity that a point at infinity lacks.
pub(crate) fn rectified_form(focal_baseline: f64, d: f64, doffs: f64) -> f64 {
    let parallax = d + doffs;
    if parallax > 0.0 {
        focal_baseline / parallax
    } else {
        f64::NAN
    }
}
