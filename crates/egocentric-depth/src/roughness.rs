use disparity_pyramid::{DisparityField, Validity};
use ndarray::Array2;

use crate::neighbours::Neighbours;

/// How rough a field of shifts is, in pixels: how far its valid shifts are from their valid neighbours
/// up to four pixels away, at most, in nine pixels of ten. `None` for a field without valid shifts.
///
/// Of the two components the geometric mean, that of `dx` counting twice: slopes and edges of the scene
/// show in `dx` alone, errors in both. A field whose `dy` is everywhere the same, as one along rows, has
/// the roughness of its `dx`.
///
/// It says what a confidence cannot, which compares the pixels of one pair with each other: how hard
/// this pair is.
#[must_use]
pub fn roughness_px(field: &DisparityField) -> Option<f64> {
    Neighbours::default().roughness_px(field)
}

/// The roughness of `dx` alone: of a field that was found along rows, whose `dy` is the rig's and not
/// the estimator's.
#[must_use]
pub fn roughness_across_px(field: &DisparityField) -> Option<f64> {
    Neighbours::default().roughness_across_px(field)
}

/// How far away the farthest neighbours of a pixel are, along rows and columns.
pub(crate) const REACH: usize = 4;

/// How far each valid shift is from its valid neighbours two and four pixels away, at most, in each
/// component; `None` where there is no valid shift. Between every second pixel the vector pyramid
/// interpolates, so nearer neighbours tell nothing.
#[must_use]
pub fn scatter(field: &DisparityField) -> Array2<Option<(f32, f32)>> {
    let size = field.size();
    let (dx, dy, validity) = (field.dx(), field.dy(), field.validity());
    Array2::from_shape_fn(size.dim(), |(y, x)| {
        if validity[[y, x]] != Validity::Valid {
            return None;
        }
        let around = |at: usize, length: usize| {
            let first = if at < REACH { at % 2 } else { at - REACH };
            (first..(at + REACH + 1).min(length)).step_by(2)
        };
        let mut most = (0.0f32, 0.0f32);
        for row in around(y, size.height) {
            for column in around(x, size.width) {
                if validity[[row, column]] == Validity::Valid {
                    most.0 = most.0.max((dx[[row, column]] - dx[[y, x]]).abs());
                    most.1 = most.1.max((dy[[row, column]] - dy[[y, x]]).abs());
                }
            }
        }
        Some(most)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field(dx: impl Fn(usize, usize) -> f32, dy: impl Fn(usize, usize) -> f32) -> DisparityField {
        let plane = |value: &dyn Fn(usize, usize) -> f32| {
            Array2::from_shape_fn((20, 30), |(y, x)| value(x, y))
        };
        let valid = Array2::from_shape_fn((20, 30), |(y, _)| {
            if y < 15 {
                Validity::Valid
            } else {
                Validity::NoEnergy
            }
        });
        DisparityField::new(plane(&dx), plane(&dy), Array2::ones((20, 30)), valid).unwrap()
    }

    #[test]
    fn slopes_are_rough_and_planes_that_face_are_not() {
        let sloped = field(|x, _| 0.25 * x as f32, |_, _| 0.0);
        // Four columns on, a quarter of a pixel each.
        assert_eq!(roughness_px(&sloped), Some(1.0));
        assert_eq!(scatter(&sloped)[[16, 4]], None);
        // What lies in the rows without answers is not looked at.
        let noisy = field(|_, y| if y < 15 { 1.0 } else { 9.0 }, |_, _| 0.0);
        assert_eq!(roughness_px(&noisy), Some(0.0));
        let both = field(|x, _| 0.5 * x as f32, |x, _| 0.0625 * x as f32);
        assert_eq!(roughness_px(&both), Some(1.0));
        assert_eq!(roughness_across_px(&both), Some(2.0));
    }
}
