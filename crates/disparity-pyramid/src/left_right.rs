use ndarray::{Array2, Zip};

use crate::Validity;
use crate::refine::Shifts;

/// Follows each valid shift to the other eye and back. Where the way does not come back to within
/// `tolerance_px`, the pixel is occluded if the other eye sees something nearer there, and
/// inconsistent if not. Where the other eye has no answer there is nothing to check against, and
/// the pixel is inconsistent.
///
/// What is nearer has the larger `dx` seen from the right eye, so a way back that overshoots to the
/// right (`dx` there plus `dx` back above 0) belongs to something nearer.
pub(crate) fn check(there: &mut Shifts, back: &Shifts, tolerance_px: f32) {
    let (height, width) = there.dx.dim();
    let verdicts = Array2::from_shape_fn((height, width), |(y, x)| {
        let validity = there.validity[[y, x]];
        if !validity.is_valid() {
            return validity;
        }
        let (dx, dy) = (there.dx[[y, x]], there.dy[[y, x]]);
        let (u, v) = ((x as f32 + dx).round(), (y as f32 + dy).round());
        if !(u >= 0.0 && v >= 0.0 && u < width as f32 && v < height as f32) {
            return Validity::OutOfView;
        }
        let place = [v as usize, u as usize];
        if !back.validity[place].is_valid() {
            return Validity::Inconsistent;
        }
        let (miss_x, miss_y) = (dx + back.dx[place], dy + back.dy[place]);
        if miss_x.hypot(miss_y) <= tolerance_px {
            Validity::Valid
        } else if miss_x > 0.0 {
            Validity::Occluded
        } else {
            Validity::Inconsistent
        }
    });
    Zip::from(&mut there.validity)
        .and(&verdicts)
        .for_each(|validity, verdict| *validity = *verdict);
}
