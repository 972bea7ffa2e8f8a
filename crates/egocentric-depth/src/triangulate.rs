use disparity_pyramid::{DisparityField, Validity};
use ndarray::{Array2, Zip};
use v1_gabor::Binocular;

use crate::general_form::{depth_of_tangents, tangent_of_sum};
use crate::rectified_form::rectified_form;
use crate::triangulate_rays::rays_where;
use crate::{DepthMap, StereoRig};

/// Depth of every pixel whose disparity the estimator stands behind; all others are unknown.
///
/// For eyes that only pan the horizontal shift alone decides: a parallel rig uses
/// `Z = f b / (d + doffs)`, a vergent one the [`general_form`](crate::general_form()), which is exact
/// for every row. Eyes with tilt, torsion, a lens or a displaced centre need both components of the
/// shift, by [`triangulate_rays`](crate::triangulate_rays()). What would lie at infinity, beyond or
/// behind is unknown. Depths are head-frame z in metres; the rig's own tilt does not enter.
#[must_use]
pub fn triangulate(disparity: &DisparityField, rig: &StereoRig) -> DepthMap {
    depth_where(disparity, rig, Validity::is_valid)
}

/// Depth of every pixel from the estimator's best guess, whatever its validity: the dense twin of
/// [`triangulate`].
///
/// Only what would lie at infinity, beyond or behind stays unknown.
#[must_use]
pub fn triangulate_guesses(disparity: &DisparityField, rig: &StereoRig) -> DepthMap {
    depth_where(disparity, rig, |_| true)
}

fn depth_where(
    disparity: &DisparityField,
    rig: &StereoRig,
    trusted: impl Fn(Validity) -> bool + Sync,
) -> DepthMap {
    if !rig.only_pans() {
        return rays_where(disparity, &rig.eyes(), trusted).depth;
    }
    let eyes = rig.intrinsics();
    let focal_px = eyes.map(|eye| eye.focal_px.0);
    let centre_px = eyes.map(|eye| eye.principal_point_px.0);
    let pan = rig.pan_rad().map(f64::tan);
    let baseline_m = rig.baseline_m();

    let parallel = pan.left == 0.0 && pan.right == 0.0;
    if parallel && focal_px.left == focal_px.right {
        let doffs = centre_px.right - centre_px.left;
        let focal_baseline = focal_px.left * baseline_m;
        return depth_by_column(disparity, trusted, |_, dx| {
            rectified_form(focal_baseline, -dx, doffs)
        });
    }

    // The left azimuth is one number to a column; the right one depends on the disparity too.
    let left: Vec<f64> = (0..disparity.size().width)
        .map(|x| tangent_of_sum(pan.left, (x as f64 - centre_px.left) / focal_px.left))
        .collect();
    depth_by_column(disparity, trusted, |x, dx| {
        let in_right_eye = (x as f64 + dx - centre_px.right) / focal_px.right;
        let tangent = Binocular {
            left: left[x],
            right: tangent_of_sum(pan.right, in_right_eye),
        };
        depth_of_tangents(baseline_m, tangent)
    })
}

/// Walks the rows; `depth` takes a column and the horizontal shift there.
fn depth_by_column(
    disparity: &DisparityField,
    trusted: impl Fn(Validity) -> bool,
    depth: impl Fn(usize, f64) -> f64,
) -> DepthMap {
    let mut metres = Array2::from_elem(disparity.size().dim(), f32::NAN);
    Zip::from(metres.rows_mut())
        .and(disparity.dx().rows())
        .and(disparity.validity().rows())
        .for_each(|mut metres, dx, validity| {
            let matches = dx.iter().zip(validity);
            for (x, (metres, (&dx, &validity))) in metres.iter_mut().zip(matches).enumerate() {
                if trusted(validity) {
                    *metres = depth(x, f64::from(dx)) as f32;
                }
            }
        });
    DepthMap::new(metres)
}
