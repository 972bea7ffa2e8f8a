use ndarray::{Array2, Zip};

use crate::Validity;
use crate::refine::Shifts;

/// Follows each valid shift to the other eye and back. Where the way does not come back to within
/// `tolerance_px`, the pixel is occluded if the other eye sees something nearer there, and
/// inconsistent if not. The way back is known at the scale `scale`, 0 being that of the way there.
///
/// What is nearer has the larger `dx` seen from the right eye, so a way back that overshoots to the
/// right (`dx` there plus `dx` back above 0) belongs to something nearer.
///
/// The other eye's best guess counts even where it does not stand behind it: a guess that leads back
/// to the start is evidence however it came about.
pub(crate) fn check(there: &mut Shifts, back: &Shifts, scale: usize, tolerance_px: f32) {
    let (height, width) = there.dx.dim();
    let (back_height, back_width) = back.dx.dim();
    let grow = 2.0f32.powi(scale as i32);
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
        let place = [
            (((y as f32 + dy) / grow).round() as usize).min(back_height - 1),
            (((x as f32 + dx) / grow).round() as usize).min(back_width - 1),
        ];
        let (miss_x, miss_y) = (dx + grow * back.dx[place], dy + grow * back.dy[place]);
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
