use dorsal::disparity_pyramid::{
    Acuity, Cost, DisparityField, LookBack, MatchParams, MedianRadius, Validity,
};
use dorsal::v1_gabor::GaborParams;
use dorsal::{DenseLook, Estimator, Rows};
use serde::Serialize;
use stereo_formats::file_sign;

use crate::drift_record::DriftRecord;
use crate::outputs::FileName;
use crate::plan::Plan;
use crate::searched::{Searched, StartRecord};
use crate::segment_record::SegmentRecord;
use crate::sight::Sight;
use crate::times::Times;

/// What `look.json` says of a look: schema `dorsal-look/1`.
#[derive(Debug, Serialize)]
pub(crate) struct LookRecord {
    schema: &'static str,
    version: &'static str,
    inputs: Inputs,
    width: usize,
    height: usize,
    estimator: &'static str,
    pub(crate) dense: bool,
    gabor: Filters,
    matching: Matching,
    search: Search,
    /// How the dense estimator matched, if it did.
    #[serde(skip_serializing_if = "Option::is_none")]
    dense_matching: Option<DenseMatching>,
    reference: Option<String>,
    /// The part of the pixels that are valid.
    density: f64,
    /// Pixels by validity.
    pixels: Counts,
    /// Disparities of valid pixels, in the sign of files.
    disparity_px: Option<Spread>,
    /// Depths that the scales reach with the rig; no farthest one is no limit.
    reach_m: Option<Span>,
    /// How the right eye has slipped from where the rig has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    drift: Option<DriftRecord>,
    /// Whether depth was taken with that corrected.
    recalibrated: bool,
    /// What was found without labels.
    #[serde(skip_serializing_if = "Option::is_none")]
    segments: Option<SegmentRecord>,
    threads: usize,
    time_ms: Times,
    /// The files beside this one.
    pub(crate) files: Vec<FileName>,
}

/// The files that were looked at.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Inputs {
    pub(crate) left: String,
    pub(crate) right: String,
    pub(crate) rig: Option<String>,
    pub(crate) labels: Option<String>,
    pub(crate) names: Option<String>,
}

#[derive(Debug, Serialize)]
pub(crate) struct Filters {
    orientations: usize,
    scales: usize,
    peak_frequency: f32,
    bandwidth_octaves: f32,
    taps: usize,
}

#[derive(Debug, Serialize)]
pub(crate) struct Matching {
    energy_threshold: f32,
    /// In the sign of files; the vertical shift is 0.
    zero_disparity_px: f32,
    warps: usize,
    finest_warps: usize,
    sparse_scales: usize,
    robust_rounds: usize,
    medians: usize,
    median_width_px: usize,
    least_coherence: f32,
    vertical_prior: f32,
    left_right_px: Option<f32>,
    look_back_warps: usize,
    rows_only: bool,
    slanted_scales: usize,
    contradictions: Option<usize>,
    singularity_tau: Option<f32>,
}

/// Where the vector pyramid searched: from each start over the finest scales of the bank.
#[derive(Debug, Serialize)]
struct Search {
    /// Whether a coarse look chose them; `false` if they were given, or the defaults were.
    found: bool,
    starts: Vec<StartRecord>,
    scales: usize,
}

#[derive(Debug, Serialize)]
struct DenseMatching {
    /// How rows came to correspond.
    rows: &'static str,
    cost: &'static str,
    silent_energy: f32,
    opponent: f32,
    opponent_silent_energy: f32,
    colour: bool,
    small_step: f32,
    large_step: f32,
    edge_softness: f32,
    look_back: &'static str,
    left_right_px: f32,
    least_patch: usize,
    votes: usize,
    median: bool,
    acuity: &'static str,
    surface_radius: usize,
    choice_radius: usize,
    surface_stride: usize,
    choice_stride: usize,
    slants: usize,
    noisy: f32,
}

#[derive(Debug, Serialize)]
pub(crate) struct Counts {
    valid: usize,
    no_energy: usize,
    singular: usize,
    incoherent: usize,
    out_of_view: usize,
    occluded: usize,
    inconsistent: usize,
}

#[derive(Debug, Serialize)]
struct Spread {
    least: f32,
    median: f32,
    most: f32,
}

#[derive(Debug, Serialize)]
struct Span {
    nearest: f64,
    farthest: Option<f64>,
}

impl LookRecord {
    pub(crate) fn new(
        plan: &Plan,
        sight: &Sight,
        times: &Times,
        inputs: Inputs,
        dense: bool,
    ) -> Self {
        let field = &sight.disparity;
        Self {
            schema: "dorsal-look/1",
            version: env!("CARGO_PKG_VERSION"),
            inputs,
            width: field.size().width,
            height: field.size().height,
            estimator: match plan.estimator {
                Estimator::Vector(_) => "vector",
                Estimator::Dense(_) => "dense",
            },
            dense,
            dense_matching: DenseMatching::of(&plan.estimator),
            gabor: Filters::of(&plan.gabor),
            matching: Matching::of(&plan.matching),
            search: Search::of(&sight.searched),
            reference: sight
                .scene
                .is_some()
                .then(|| plan.reference.name().to_owned()),
            density: field.density(),
            pixels: Counts::of(field),
            disparity_px: spread(field),
            reach_m: plan
                .rig
                .and_then(|rig| sight.searched.reach(&rig))
                .map(|reach| Span {
                    nearest: reach.nearest_m,
                    farthest: Some(reach.farthest_m).filter(|farthest_m| farthest_m.is_finite()),
                }),
            drift: sight.drift.as_ref().map(DriftRecord::of),
            recalibrated: plan.recalibrate && matches!(sight.drift, Some(Ok(_))),
            segments: sight.segments(),
            threads: rayon::current_num_threads(),
            time_ms: times.clone(),
            files: Vec::new(),
        }
    }

    /// The median disparity of the valid pixels in the sign of files; `None` if there are none.
    pub(crate) fn median_disparity_px(&self) -> Option<f32> {
        self.disparity_px.as_ref().map(|spread| spread.median)
    }
}

impl Filters {
    pub(crate) fn of(params: &GaborParams) -> Self {
        Self {
            orientations: params.orientations,
            scales: params.scales,
            peak_frequency: params.peak_frequency,
            bandwidth_octaves: params.bandwidth,
            taps: params.taps(),
        }
    }
}

impl Matching {
    pub(crate) fn of(params: &MatchParams) -> Self {
        Self {
            energy_threshold: params.energy_threshold,
            zero_disparity_px: 0.0 - params.zero_disparity_px.0,
            warps: params.warps,
            finest_warps: params.finest_warps,
            sparse_scales: params.sparse_scales,
            robust_rounds: params.robust_rounds,
            medians: params.medians,
            median_width_px: match params.median_radius {
                MedianRadius::One => 3,
                MedianRadius::Two => 5,
            },
            least_coherence: params.least_coherence,
            vertical_prior: params.vertical_prior,
            left_right_px: params.left_right_px,
            look_back_warps: params.look_back_warps,
            rows_only: params.rows_only,
            slanted_scales: params.slanted_scales,
            contradictions: params.contradictions,
            singularity_tau: params.singularity_tau,
        }
    }
}

impl Search {
    fn of(searched: &Searched) -> Self {
        Self {
            found: searched.found,
            starts: searched.starts.clone(),
            scales: searched.scales,
        }
    }
}

impl DenseMatching {
    fn of(estimator: &Estimator) -> Option<Self> {
        let Estimator::Dense(DenseLook { params, rows, .. }) = estimator else {
            return None;
        };
        Some(Self {
            rows: match rows {
                Rows::AsTaken => "as taken",
                Rows::Aligned => "aligned",
                Rows::Rectified => "rectified by the rig",
            },
            cost: match params.cost {
                Cost::PhaseAgreement => "phase agreement",
                Cost::PhaseQuadrants => "phase quadrants",
            },
            silent_energy: params.silent_energy,
            opponent: params.opponent,
            opponent_silent_energy: params.opponent_silent_energy,
            colour: params.colour,
            small_step: params.small_step,
            large_step: params.large_step,
            edge_softness: params.edge_softness,
            look_back: match params.look_back {
                LookBack::OwnPaths => "own paths",
                LookBack::SamePaths => "same paths",
            },
            left_right_px: params.left_right_px,
            least_patch: params.least_patch,
            votes: params.votes,
            median: params.median,
            acuity: match params.acuity {
                Acuity::Parabola => "parabola",
                Acuity::CostBank => "cost bank",
                Acuity::TwoBanks => "two banks",
            },
            surface_radius: params.surface_radius,
            choice_radius: params.choice_radius,
            surface_stride: params.surface_stride,
            choice_stride: params.choice_stride,
            slants: params.slants,
            noisy: params.noisy,
        })
    }
}

impl Counts {
    pub(crate) fn of(field: &DisparityField) -> Self {
        let validity = field.validity();
        let count = |wanted| {
            validity
                .iter()
                .filter(|&&validity| validity == wanted)
                .count()
        };
        Self {
            valid: count(Validity::Valid),
            no_energy: count(Validity::NoEnergy),
            singular: count(Validity::Singular),
            incoherent: count(Validity::Incoherent),
            out_of_view: count(Validity::OutOfView),
            occluded: count(Validity::Occluded),
            inconsistent: count(Validity::Inconsistent),
        }
    }
}

/// The disparities of the valid pixels in the sign of files; `None` if there are none.
fn spread(field: &DisparityField) -> Option<Spread> {
    let d = file_sign::d_of_field(field, false);
    let mut known: Vec<f32> = d.into_iter().filter(|d| d.is_finite()).collect();
    if known.is_empty() {
        return None;
    }
    let middle = known.len() / 2;
    let (_, median, _) = known.select_nth_unstable_by(middle, f32::total_cmp);
    Some(Spread {
        median: *median,
        least: known.iter().copied().fold(f32::INFINITY, f32::min),
        most: known.iter().copied().fold(f32::NEG_INFINITY, f32::max),
    })
}
