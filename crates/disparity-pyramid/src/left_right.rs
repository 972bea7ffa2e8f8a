use ndarray::Zip;

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
    let (most_x, most_y) = (width as f32 - 0.5, height as f32 - 0.5);
    Zip::indexed(&mut there.validity)
        .and(&there.dx)
        .and(&there.dy)
        .par_for_each(|(y, x), validity, &dx, &dy| {
            if !validity.is_valid() {
                return;
            }
            let (u, v) = (x as f32 + dx, y as f32 + dy);
            *validity = if u >= -0.5 && v >= -0.5 && u < most_x && v < most_y {
                // The nearest pixel of the other eye; what is above zero rounds by truncation.
                let nearest = |at: f32, length: usize| ((at / grow + 0.5) as usize).min(length - 1);
                let place = [nearest(v, back_height), nearest(u, back_width)];
                let (miss_x, miss_y) = (dx + grow * back.dx[place], dy + grow * back.dy[place]);
                if miss_x * miss_x + miss_y * miss_y <= tolerance_px * tolerance_px {
                    Validity::Valid
                } else if miss_x > 0.0 {
                    Validity::Occluded
                } else {
                    Validity::Inconsistent
                }
            } else {
                Validity::OutOfView
            };
        });
}
