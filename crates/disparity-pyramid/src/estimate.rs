use ndarray::{Array2, Zip};
use v1_gabor::{Binocular, GaborParams, MonogenicParams, Responses, Size, V1Responses};

use crate::coarse_to_fine::coarse_to_fine;
use crate::left_right::check;
use crate::refine::{Eyes, Shifts, refine};
use crate::shift_covariance::pooled;
use crate::singular::mark_singular;
use crate::{DisparityField, MatchParams};

/// Why the responses of two eyes cannot be matched.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Mismatch {
    /// The images differ in size.
    #[error("the left eye saw {left} pixels and the right eye {right}; both need one size")]
    Sizes {
        /// Size of the left image.
        left: Size,
        /// Size of the right image.
        right: Size,
    },
    /// The responses come from different banks.
    #[error("the eyes were filtered with different banks: {left:?} and {right:?}")]
    Banks {
        /// Parameters of the left eye's bank.
        left: GaborParams,
        /// Parameters of the right eye's bank.
        right: GaborParams,
    },
    /// The monogenic responses come from different banks.
    #[error("the eyes were filtered with different banks: {left:?} and {right:?}")]
    SphericalBanks {
        /// Parameters of the left eye's bank.
        left: MonogenicParams,
        /// Parameters of the right eye's bank.
        right: MonogenicParams,
    },
    /// A parameter is not a number, or out of its range.
    #[error("{name} = {value} cannot be: {need}")]
    Parameter {
        /// Name of the field of [`MatchParams`].
        name: &'static str,
        /// Its value.
        value: f32,
        /// What it must be.
        need: &'static str,
    },
}

/// The vector disparity of every pixel of the left image, from the responses of both eyes.
///
/// From the coarsest scale to the finest, the right responses are read at the shifts found so far,
/// each orientation's phase difference gives a component disparity, and a robust fit over the
/// orientations gives the shift that remains (equations 2 to 4). Nothing is assumed of the rig: the
/// search is two-dimensional.
///
/// # Errors
/// [`Mismatch`] if the eyes differ in size or bank, or a parameter cannot be.
pub fn estimate(
    eyes: &Binocular<V1Responses>,
    params: MatchParams,
) -> Result<DisparityField, Mismatch> {
    estimate_over(eyes, params, eyes.left.scales().len())
}

/// The same over the finest `scales` of those that the eyes hold.
pub(crate) fn estimate_over(
    eyes: &Binocular<V1Responses>,
    params: MatchParams,
    scales: usize,
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
        return Err(Mismatch::Banks {
            left: left.params(),
            right: right.params(),
        });
    }
    let heard = params
        .singularity_tau
        .map(|tau| eyes.as_ref().map(|eye| eye.without_singularities(tau)));
    let (left, right) = heard
        .as_ref()
        .map_or((left, right), |heard| (&heard.left, &heard.right));
    let waves = left.params().wave_vectors();
    let sizes: Vec<Size> = left
        .scales()
        .iter()
        .map(Responses::size)
        .take(scales)
        .collect();
    let warp = |from: &V1Responses, to: &V1Responses, scale: usize, shifts: &mut Shifts, dy: &_| {
        let eyes = Eyes {
            left: &from.scales()[scale],
            right: &to.scales()[scale],
            waves: &waves,
        };
        refine(&eyes, shifts, dy, &params);
    };
    let field = both_ways(
        &params,
        &sizes,
        Some(left.params()),
        |scale, shifts, parent_dy| warp(left, right, scale, shifts, parent_dy),
        |scale, shifts, parent_dy| warp(right, left, scale, shifts, parent_dy),
    );
    Ok(match heard {
        None => field,
        Some(_) => mark_singular(field, eyes, params.energy_threshold),
    })
}

/// The field of the way there, checked against the way back if that is asked for. `there` and
/// `back` are one warp at one scale, as [`coarse_to_fine`] takes it; of `bank` depends how far
/// the noise of orientations and pixels goes together, if fits have a covariance.
pub(crate) fn both_ways(
    params: &MatchParams,
    sizes: &[Size],
    bank: Option<GaborParams>,
    there: impl Fn(usize, &mut Shifts, &Array2<f32>) + Send,
    back: impl Fn(usize, &mut Shifts, &Array2<f32>) + Send,
) -> DisparityField {
    let (start_x, start_y) = params.zero_disparity_px;
    let there = || coarse_to_fine(sizes, 0, (start_x, start_y), params, there);
    let there = match params.left_right_px {
        None => there(),
        // Side by side: steps of one that keep a single thread busy leave the others to the other.
        Some(tolerance_px) => {
            let last = params.look_back_scale.min(sizes.len() - 1);
            let start = (-start_x, -start_y);
            let back = || coarse_to_fine(sizes, last, start, params, back);
            let (mut there, back) = rayon::join(there, back);
            check(&mut there, &back, last, tolerance_px);
            there
        }
    };
    let confidence =
        Zip::from(&there.residual)
            .and(&there.validity)
            .map_collect(|&residual, validity| {
                if validity.is_valid() {
                    confidence(residual)
                } else {
                    0.0
                }
            });
    let fits = there.covariance.as_ref().zip(bank);
    let covariance = fits.map(|(fits, bank)| pooled(fits, &there.validity, bank, params));
    DisparityField::trusted(there.dx, there.dy, confidence, there.validity)
        .with_covariance(covariance)
}

/// From what the orientations leave unexplained, in pixels, to a confidence from 0 to 1.
fn confidence(residual_px: f32) -> f32 {
    1.0 / (1.0 + (residual_px / 0.2).powi(2))
}

impl MatchParams {
    pub(crate) fn check(&self) -> Result<(), Mismatch> {
        let refuse = |name, value, need| Err(Mismatch::Parameter { name, value, need });
        if !(self.energy_threshold >= 0.0 && self.energy_threshold.is_finite()) {
            return refuse(
                "energy_threshold",
                self.energy_threshold,
                "not negative, and finite",
            );
        }
        for shift in [self.zero_disparity_px.0, self.zero_disparity_px.1] {
            if !shift.is_finite() {
                return refuse("zero_disparity_px", shift, "finite");
            }
        }
        if self.warps.min(self.finest_warps) == 0 {
            return refuse("warps", 0.0, "at least 1");
        }
        if !(self.vertical_prior >= 0.0 && self.vertical_prior.is_finite()) {
            return refuse(
                "vertical_prior",
                self.vertical_prior,
                "not negative, and finite",
            );
        }
        if self.least_coherence.is_nan() {
            return refuse("least_coherence", self.least_coherence, "a number");
        }
        if let Some(tau) = self.singularity_tau
            && (tau.is_nan() || tau <= 0.0)
        {
            return refuse("singularity_tau", tau, "positive");
        }
        match self.left_right_px {
            Some(tolerance) if tolerance.is_nan() || tolerance <= 0.0 => {
                refuse("left_right_px", tolerance, "positive")
            }
            _ => Ok(()),
        }
    }
}
