use v1_gabor::{Binocular, MonogenicResponses};

use crate::estimate::both_ways;
use crate::grid::Grid;
use crate::pooled_fit::pooled_refine;
use crate::{DisparityField, MatchParams, MatchWorkspace, Mismatch};

/// The vector disparity of every pixel of the left image, from the monogenic responses of both
/// eyes: [`estimate`](crate::estimate) for filters that know one orientation a pixel.
///
/// One orientation tells the component of a shift along itself and nothing of the other, so each
/// pixel's fit takes in its neighbourhood (a Gaussian of 2 px of the scale): what several
/// orientations are to the oriented families, several pixels are here. Where a neighbourhood has one
/// orientation only, there is no answer.
///
/// The fit is a plain one: [`MatchParams::robust_rounds`], [`MatchParams::least_coherence`] and
/// [`MatchParams::singularity_tau`] have nothing to act on, every pixel is fitted ([`MatchParams::sparse_scales`] counts as 0), the field
/// carries no covariance, and a pixel counts as heard if its own energy in both eyes is above
/// [`MatchParams::energy_threshold`]. All other parameters mean what they mean to `estimate`.
///
/// # Errors
/// [`Mismatch`] if the eyes differ in size or bank, or a parameter cannot be.
pub fn estimate_monogenic(
    eyes: &Binocular<MonogenicResponses>,
    params: MatchParams,
) -> Result<DisparityField, Mismatch> {
    params.check()?;
    let params = MatchParams {
        covariance: false,
        sparse_scales: 0,
        ..params
    };
    let (left, right) = (&eyes.left, &eyes.right);
    if left.size() != right.size() {
        return Err(Mismatch::Sizes {
            left: left.size(),
            right: right.size(),
        });
    }
    if left.params() != right.params() {
        return Err(Mismatch::SphericalBanks {
            left: left.params(),
            right: right.params(),
        });
    }
    let omega = left.params().peak_frequency;
    let sizes = left.scales().iter().map(|scale| scale.size());
    let grids = Grid::of_scales(sizes, &params);
    let warp = |from: &MonogenicResponses,
                to: &MonogenicResponses,
                scale,
                shifts: &mut _,
                dy: Option<&_>| {
        let eyes = (&from.scales()[scale], &to.scales()[scale]);
        pooled_refine(eyes, omega, shifts, dy, &params);
    };
    let mut field = DisparityField::default();
    both_ways(
        (&mut MatchWorkspace::new(), &mut field),
        &params,
        (left.size(), &grids),
        None,
        |scale, shifts, parent_dy| warp(left, right, scale, shifts, parent_dy),
        |scale, shifts, parent_dy| warp(right, left, scale, shifts, parent_dy),
    );
    Ok(field)
}
