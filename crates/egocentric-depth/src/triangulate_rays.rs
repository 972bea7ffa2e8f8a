use disparity_pyramid::DisparityField;
use ndarray::{Array2, Zip};
use v1_gabor::Binocular;

use crate::DepthMap;
use crate::eye::Eye;
use crate::midpoint::{Midpoint, midpoint};

/// Depth by the midpoint of two lines of sight, and how far these pass each other.
#[derive(Clone, Debug)]
pub struct RayTriangulation {
    /// Head-frame z of the midpoints in metres, unknown where the disparity is not valid or the
    /// lines do not meet in front.
    pub depth: DepthMap,
    /// The gap between the two lines `[[y, x]]` in metres, NaN where the depth is unknown. Divided
    /// by the depth and multiplied by the focal length it is a misalignment in pixels.
    pub gap_m: Array2<f32>,
}

/// Depth of every valid pixel for eyes of any attitude, from both components of its disparity.
///
/// This needs no rectified images: [`RigDrift::eyes`](crate::RigDrift::eyes) gives the eyes of a
/// rig that has drifted, and [`StereoRig::eyes`](crate::StereoRig::eyes) those of one that has not, for which the depths
/// are those of [`triangulate`](crate::triangulate()) as far as the lines of sight meet.
#[must_use]
pub fn triangulate_rays(disparity: &DisparityField, eyes: &Binocular<Eye>) -> RayTriangulation {
    let mut depth = Array2::from_elem(disparity.size().dim(), f32::NAN);
    let mut gap_m = depth.clone();
    Zip::indexed(disparity.dx())
        .and(disparity.dy())
        .and(disparity.validity())
        .and(&mut depth)
        .and(&mut gap_m)
        .par_for_each(|(y, x), &dx, &dy, &validity, depth, gap_m| {
            let found = validity.is_valid().then(|| meeting(eyes, (x, y), (dx, dy)));
            if let Some(found) = found.flatten() {
                *depth = found.position.z_m as f32;
                *gap_m = found.gap_m as f32;
            }
        });
    RayTriangulation {
        depth: DepthMap::new(depth),
        gap_m,
    }
}

/// Where the lines of sight of a pixel and of its match come nearest in front of the eyes.
pub(crate) fn meeting(
    eyes: &Binocular<Eye>,
    (x, y): (usize, usize),
    (dx, dy): (f32, f32),
) -> Option<Midpoint> {
    let (u, v) = (x as f64, y as f64);
    let right = (u + f64::from(dx), v + f64::from(dy));
    let (left, right) = (eyes.left.ray((u, v))?, eyes.right.ray(right)?);
    midpoint(Binocular { left, right }).filter(|found| found.position.z_m > 0.0)
}
