use ndarray::{Array2, Zip};

use crate::eye::Eye;
use crate::rotation::{Rotation, cross, dot};
use crate::{DepthMap, StereoRig};

/// How far the depths of neighbours may be apart to be of one surface, as a part of the depth.
const ONE_SURFACE: f64 = 0.05;

/// The direction that the surface of every pixel faces, of length 1, in the level observer frame: from
/// the surface toward the eye. NaN where the depth or that of a neighbour is unknown, and on edges.
///
/// It is square to the lines between the neighbours on either side, two pixels away: nearer ones share
/// too much of their noise with the pixel.
#[must_use]
pub fn normals(depth: &DepthMap, rig: &StereoRig) -> Array2<[f32; 3]> {
    const STEP: usize = 2;
    let eye = rig.eyes().left;
    let level = rig.head_to_observer();
    let size = depth.size();
    let mut normals = Array2::from_elem(size.dim(), [f32::NAN; 3]);
    Zip::indexed(&mut normals).par_for_each(|(y, x), normal| {
        let inside = (STEP..size.width.saturating_sub(STEP)).contains(&x)
            && (STEP..size.height.saturating_sub(STEP)).contains(&y);
        if !inside {
            return;
        }
        let place = |x: usize, y: usize| place(depth, &eye, (x, y));
        let found = || {
            let here = place(x, y)?;
            let (left, right) = (place(x - STEP, y)?, place(x + STEP, y)?);
            let (above, below) = (place(x, y - STEP)?, place(x, y + STEP)?);
            let one = [left, right, above, below]
                .iter()
                .all(|there| (there[2] - here[2]).abs() < ONE_SURFACE * here[2]);
            one.then(|| facing(here, [left, right], [above, below], &eye, &level))
        };
        if let Some(found) = found().flatten() {
            *normal = found.map(|component| component as f32);
        }
    });
    normals
}

/// Where a pixel lies in the head frame.
fn place(depth: &DepthMap, eye: &Eye, (x, y): (usize, usize)) -> Option<[f64; 3]> {
    let z_m = f64::from(depth.at(x, y)?);
    let place = eye.at_depth((x as f64, y as f64), z_m)?;
    Some(place.to_array())
}

fn facing(
    here: [f64; 3],
    [left, right]: [[f64; 3]; 2],
    [above, below]: [[f64; 3]; 2],
    eye: &Eye,
    level: &Rotation,
) -> Option<[f64; 3]> {
    let apart = |a: [f64; 3], b: [f64; 3]| std::array::from_fn(|i| b[i] - a[i]);
    let square = cross(apart(left, right), apart(above, below));
    let length = dot(square, square).sqrt();
    let to_eye = apart(here, eye.centre.to_array());
    let sign = if dot(square, to_eye) < 0.0 { -1.0 } else { 1.0 };
    (length > 0.0).then(|| level.apply(square.map(|component| sign * component / length)))
}

#[cfg(test)]
mod tests {
    use v1_gabor::Binocular;

    use super::*;
    use crate::CameraIntrinsics;

    /// A wall that leans back by half a right angle faces half up; what is beside an edge faces nowhere.
    #[test]
    fn a_leaning_wall_faces_up() {
        let eye = CameraIntrinsics {
            focal_px: (100.0, 100.0),
            principal_point_px: (20.0, 15.0),
        };
        let both = Binocular {
            left: eye,
            right: eye,
        };
        let rig = StereoRig::parallel(both, 0.1).unwrap();
        // z = 2 - y / tan 45 with y = z v: the higher, the farther.
        let leaning = Array2::from_shape_fn((31, 41), |(y, x)| {
            if x == 30 {
                return 9.0;
            }
            2.0 / (1.0 + (y as f32 - 15.0) / 100.0)
        });
        let found = normals(&DepthMap::new(leaning), &rig);
        let half = std::f32::consts::FRAC_1_SQRT_2;
        for (got, want) in found[[10, 12]].iter().zip([0.0, -half, -half]) {
            // Depths of f32, over lines of four hundredths of a metre.
            assert!((got - want).abs() < 1e-4, "{:?}", found[[10, 12]]);
        }
        assert!(found[[10, 28]][0].is_nan() && found[[0, 12]][0].is_nan());
    }
}
