use ndarray::Array2;
use rayon::prelude::*;

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
    let shrink = 1.0 / grow;
    let (most_x, most_y) = (width as f32 - 0.5, height as f32 - 0.5);
    let (back_dx, back_dy) = (numbers(&back.dx), numbers(&back.dy));
    there
        .validity
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width)
        .zip(numbers(&there.dx).par_chunks(width))
        .zip(numbers(&there.dy).par_chunks(width))
        .enumerate()
        .for_each(|(y, ((validity, dx), dy))| {
            for (x, ((validity, &dx), &dy)) in validity.iter_mut().zip(dx).zip(dy).enumerate() {
                if !validity.is_valid() {
                    continue;
                }
                let (u, v) = (x as f32 + dx, y as f32 + dy);
                if !(u >= -0.5 && v >= -0.5 && u < most_x && v < most_y) {
                    *validity = Validity::OutOfView;
                    continue;
                }
                // The nearest pixel of the other eye; what is above zero rounds by truncation.
                let nearest =
                    |at: f32, length: usize| ((at * shrink + 0.5) as usize).min(length - 1);
                let place = nearest(v, back_height) * back_width + nearest(u, back_width);
                let (miss_x, miss_y) = (dx + grow * back_dx[place], dy + grow * back_dy[place]);
                if miss_x * miss_x + miss_y * miss_y > tolerance_px * tolerance_px {
                    *validity = if miss_x > 0.0 {
                        Validity::Occluded
                    } else {
                        Validity::Inconsistent
                    };
                }
            }
        });
}

const CONTIGUOUS: &str = "planes are made in row-major order";

fn numbers(plane: &Array2<f32>) -> &[f32] {
    plane.as_slice().expect(CONTIGUOUS)
}
