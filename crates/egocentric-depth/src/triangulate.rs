use disparity_pyramid::{DisparityField, Validity};
use ndarray::{Array2, Zip};
use v1_gabor::Binocular;

use crate::general_form::{depth_of_tangents, tangent_of_sum};
use crate::rectified_form::rectified_form;
use crate::triangulate_rays::meeting;
use crate::{DepthMap, DisparitySigma, SigmaWorkspace, StereoRig};

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

/// Depth of every pixel whose disparity the estimator stands behind, and one standard deviation of that
/// disparity: `triangulate(disparity, rig).with_disparity_sigma(sigma.of(disparity))`, bit for bit, written
/// over an earlier map in buffers that are kept.
pub fn triangulate_into(
    disparity: &DisparityField,
    rig: &StereoRig,
    sigma: &DisparitySigma,
    workspace: &mut SigmaWorkspace,
    depth: &mut DepthMap,
) {
    depth.write_over(disparity.size(), |metres, sigma_px| {
        sigma.of_into(disparity, workspace, sigma_px);
        write_depths(disparity, rig, Validity::is_valid, metres);
        Zip::from(metres)
            .and(&*sigma_px)
            .par_for_each(|metres, &sigma_px| {
                if !(sigma_px.is_finite() && sigma_px >= 0.0) {
                    *metres = f32::NAN;
                }
            });
    });
}

fn depth_where(
    disparity: &DisparityField,
    rig: &StereoRig,
    trusted: impl Fn(Validity) -> bool + Sync,
) -> DepthMap {
    let mut depth = DepthMap::default();
    depth.write_over(disparity.size(), |metres, _| {
        write_depths(disparity, rig, trusted, metres);
    });
    depth
}

fn write_depths(
    disparity: &DisparityField,
    rig: &StereoRig,
    trusted: impl Fn(Validity) -> bool + Sync,
    metres: &mut Array2<f32>,
) {
    if !rig.only_pans() {
        let eyes = rig.eyes();
        Zip::indexed(metres)
            .and(disparity.dx())
            .and(disparity.dy())
            .and(disparity.validity())
            .par_for_each(|pixel, metres, &dx, &dy, &validity| {
                let (y, x) = pixel;
                let found = trusted(validity).then(|| meeting(&eyes, (x, y), (dx, dy)));
                *metres = known(found.flatten().map_or(f64::NAN, |found| found.position.z_m));
            });
        return;
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
        return write_by_column(disparity, trusted, metres, |_, dx| {
            rectified_form(focal_baseline, -dx, doffs)
        });
    }

    write_by_column(disparity, trusted, metres, |x, dx| {
        let in_eyes = Binocular {
            left: (x as f64 - centre_px.left) / focal_px.left,
            right: (x as f64 + dx - centre_px.right) / focal_px.right,
        };
        let tangent = Binocular {
            left: tangent_of_sum(pan.left, in_eyes.left),
            right: tangent_of_sum(pan.right, in_eyes.right),
        };
        depth_of_tangents(baseline_m, tangent)
    });
}

/// Walks the rows; `depth` takes a column and the horizontal shift there.
fn write_by_column(
    disparity: &DisparityField,
    trusted: impl Fn(Validity) -> bool + Sync,
    metres: &mut Array2<f32>,
    depth: impl Fn(usize, f64) -> f64 + Sync,
) {
    Zip::from(metres.rows_mut())
        .and(disparity.dx().rows())
        .and(disparity.validity().rows())
        .par_for_each(|mut metres, dx, validity| {
            let matches = dx.iter().zip(validity);
            for (x, (metres, (&dx, &validity))) in metres.iter_mut().zip(matches).enumerate() {
                *metres = if trusted(validity) {
                    known(depth(x, f64::from(dx)))
                } else {
                    f32::NAN
                };
            }
        });
}

/// A depth as a map holds it: unknown where it is not positive and finite.
fn known(metres: f64) -> f32 {
    let metres = metres as f32;
    if metres.is_finite() && metres > 0.0 {
        metres
    } else {
        f32::NAN
    }
}
