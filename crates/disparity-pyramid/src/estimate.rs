use ndarray::{Array2, Zip};
use v1_gabor::{Binocular, GaborParams, MonogenicParams, Responses, Size, V1Responses, WrongSize};

use crate::coarse_to_fine::coarse_to_fine;
use crate::contradicted::refuse_contradicted;
use crate::fill::fill;
use crate::grid::Grid;
use crate::left_right::check;
use crate::refine::{Eyes, refine};
use crate::shift_covariance::pooled;
use crate::shifts::Shifts;
use crate::singular::mark_singular;
use crate::speckles::reject_speckles;
use crate::spread::{spread, spread_covariance};
use crate::{DisparityField, MatchParams, MatchWorkspace};

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
    /// An image has another size than the matcher was planned for.
    #[error(transparent)]
    WrongSize(#[from] WrongSize),
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
    let mut field = DisparityField::default();
    estimate_into(eyes, params, &mut MatchWorkspace::new(), &mut field)?;
    Ok(field)
}

/// The same into a field that may be of another pair, in buffers that are kept: for pair after pair,
/// of which none but the first of a size allocates anything large.
///
/// # Errors
/// [`Mismatch`] as [`estimate`]; the field stays as it is then.
pub fn estimate_into(
    eyes: &Binocular<V1Responses>,
    params: MatchParams,
    workspace: &mut MatchWorkspace,
    field: &mut DisparityField,
) -> Result<(), Mismatch> {
    estimate_scales_into(eyes, params, eyes.left.scales().len(), (workspace, field))
}

/// The same over the finest `scales` of those that the eyes hold.
pub(crate) fn estimate_scales_into(
    eyes: &Binocular<V1Responses>,
    params: MatchParams,
    scales: usize,
    (workspace, field): (&mut MatchWorkspace, &mut DisparityField),
) -> Result<(), Mismatch> {
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
    let sizes = left.scales().iter().map(Responses::size).take(scales);
    let grids = Grid::of_scales(sizes, &params);
    let warp = |from: &V1Responses,
                to: &V1Responses,
                scale: usize,
                shifts: &mut Shifts,
                dy: Option<&_>| {
        let eyes = Eyes {
            left: &from.scales()[scale],
            right: &to.scales()[scale],
            waves: &waves,
            step: grids[scale].step,
        };
        refine(&eyes, shifts, dy, &params);
    };
    both_ways(
        (workspace, field),
        &params,
        (left.size(), &grids),
        Some(left.params()),
        |scale, shifts, parent_dy| warp(left, right, scale, shifts, parent_dy),
        |scale, shifts, parent_dy| warp(right, left, scale, shifts, parent_dy),
    );
    if heard.is_some() {
        mark_singular(field, eyes, params.energy_threshold);
    }
    Ok(())
}

/// The field of the way there, checked against the way back if that is asked for. `there` and
/// `back` are one warp at one scale, as [`coarse_to_fine`] takes it; of `bank` depends how far
/// the noise of orientations and pixels goes together, if fits have a covariance.
pub(crate) fn both_ways(
    (workspace, field): (&mut MatchWorkspace, &mut DisparityField),
    params: &MatchParams,
    (size, grids): (Size, &[Grid]),
    bank: Option<GaborParams>,
    there: impl FnMut(usize, &mut Shifts, Option<&Array2<f32>>) + Send,
    back: impl FnMut(usize, &mut Shifts, Option<&Array2<f32>>) + Send,
) {
    let (start_x, start_y) = params.zero_disparity_px;
    let MatchWorkspace {
        there: track,
        back: track_back,
        confidence,
        ones,
        patches,
    } = workspace;
    let there = || coarse_to_fine(track, (grids, 0), (start_x, start_y), params, there);
    let last = params.look_back_scale.min(grids.len() - 1);
    if params.left_right_px.is_some() {
        let start = (-start_x, -start_y);
        let params = MatchParams {
            warps: params.look_back_warps.min(params.warps),
            finest_warps: params.look_back_warps.min(params.finest_warps),
            covariance: false,
            ..*params
        };
        let back = move || coarse_to_fine(track_back, (grids, last), start, &params, back);
        // Side by side: steps of one that keep a single thread busy leave the others to the other.
        rayon::join(there, back);
    } else {
        there();
    }
    let (finest, coarser) = workspace.there.levels.split_at_mut(1);
    let found = &mut finest[0].shifts;
    let fitted = grids[0];
    if let (Some(least), Some(coarser)) = (params.contradictions, coarser.first()) {
        let halvings = u32::from(grids[1].step >= fitted.step);
        refuse_contradicted(
            &mut found.validity,
            &coarser.shifts.validity,
            halvings,
            least,
        );
    }
    if confidence.dim() != fitted.size.dim() {
        *confidence = Array2::zeros(fitted.size.dim());
    }
    if ones.dim() != fitted.size.dim() {
        *ones = Array2::zeros(fitted.size.dim());
    }
    fill(found, confidence, ones, params.fill_neighbours);
    if let Some(tolerance_px) = params.left_right_px {
        let back = (&workspace.back.levels[last].shifts, last, grids[last]);
        check((found, fitted), confidence, back, (size, tolerance_px));
    }
    let least = params.least_patch.div_ceil(fitted.step * fitted.step);
    reject_speckles(found.dx.view(), &mut found.validity, least, patches);
    Zip::from(&mut *confidence)
        .and(&found.validity)
        .for_each(|confidence, validity| {
            *confidence = if validity.is_valid() {
                *confidence
            } else {
                0.0
            };
        });
    let fits = found.covariance.take().zip(bank);
    let covariance =
        fits.map(|(fits, bank)| pooled(&fits, &found.validity, (bank, fitted.step), params));
    if fitted.step > 1 {
        spread(found, confidence, size, field);
        field.covariance = covariance.map(|plane| spread_covariance(&plane, confidence, size));
        return;
    }
    field.covariance = covariance;
    // The planes that the field had are the next pair's.
    let planes = [
        (&mut field.dx, &mut found.dx),
        (&mut field.dy, &mut found.dy),
        (&mut field.confidence, confidence),
    ];
    for (given, found) in planes {
        exchange(given, found);
    }
    exchange(&mut field.validity, &mut found.validity);
}

/// Gives a plane that was found away for one of the same size.
fn exchange<T: Clone>(given: &mut Array2<T>, found: &mut Array2<T>) {
    if given.dim() != found.dim() {
        given.clone_from(found);
    }
    std::mem::swap(given, found);
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
        let warps = [self.warps, self.finest_warps, self.look_back_warps];
        if warps.contains(&0) {
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
