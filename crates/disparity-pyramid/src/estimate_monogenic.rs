use ndarray::Array2;
use v1_gabor::{Binocular, MonogenicResponses};

use crate::coarse_to_fine::smooth;
use crate::estimate::both_ways;
use crate::expand::expand;
use crate::pooled_fit::pooled_refine;
use crate::refine::Shifts;
use crate::{DisparityField, MatchParams, Mismatch, Validity};

/// The vector disparity of every pixel of the left image, from the monogenic responses of both
/// eyes: [`estimate`](crate::estimate) for filters that know one orientation a pixel.
///
/// One orientation tells the component of a shift along itself and nothing of the other, so each
/// pixel's fit takes in its neighbourhood (a Gaussian of 2 px of the scale): what several
/// orientations are to the oriented families, several pixels are here. Where a neighbourhood has one
/// orientation only, there is no answer.
///
/// The fit is a plain one: [`MatchParams::robust_rounds`] and [`MatchParams::least_coherence`] have
/// nothing to act on, and a pixel counts as heard if its own energy in both eyes is above
/// [`MatchParams::energy_threshold`]. All other parameters mean what they mean to `estimate`.
///
/// # Errors
/// [`Mismatch`] if the eyes differ in size or bank, or a parameter cannot be.
pub fn estimate_monogenic(
    eyes: &Binocular<MonogenicResponses>,
    params: MatchParams,
) -> Result<DisparityField, Mismatch> {
    params.check()?;
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
    Ok(both_ways(
        &params,
        |start_px| coarse_to_fine(left, right, start_px, &params),
        |start_px| coarse_to_fine(right, left, start_px, &params),
    ))
}

/// The shifts that take one eye's image to the other's, from the coarsest scale to the finest
/// (equation 4), each scale refined by pooled fits.
fn coarse_to_fine(
    from: &MonogenicResponses,
    to: &MonogenicResponses,
    start_px: (f32, f32),
    params: &MatchParams,
) -> Shifts {
    let omega = from.params().peak_frequency;
    let shrink = 0.5f32.powi(from.scales().len() as i32 - 1);
    let mut shifts: Option<Shifts> = None;
    for (scale, (left, right)) in from.scales().iter().zip(to.scales()).enumerate().rev() {
        let size = left.size();
        let mut here = match &shifts {
            None => Shifts::silent(
                Array2::from_elem(size.dim(), start_px.0 * shrink),
                Array2::from_elem(size.dim(), start_px.1 * shrink),
            ),
            Some(coarser) => Shifts::silent(
                expand(coarser.dx.view(), size),
                expand(coarser.dy.view(), size),
            ),
        };
        let parent_dy = here.dy.clone();
        let warps = if scale == 0 {
            params.finest_warps
        } else {
            params.warps
        };
        for warp in 1..=warps {
            pooled_refine((left, right), omega, &mut here, &parent_dy, params);
            let medians = if warp < warps {
                params.medians.min(1)
            } else {
                params.medians
            };
            smooth(&mut here, medians, params.median_radius);
        }
        shifts = Some(here);
    }
    shifts.expect("responses have at least one scale")
}

impl Shifts {
    /// Shifts of which nothing is known yet.
    fn silent(dx: Array2<f32>, dy: Array2<f32>) -> Self {
        Self {
            validity: Array2::from_elem(dx.dim(), Validity::NoEnergy),
            residual: Array2::zeros(dx.dim()),
            dx,
            dy,
        }
    }
}
