use anyhow::Context;
use clap::ValueEnum;
use disparity_pyramid::{
    DenseMatcher, DenseParams, DisparityField, EyeView, MatchParams, RowAlignment, SearchRange,
    estimate,
};
use dorsal::{DenseLook, Rows, Search};
use ndarray::ArrayView2;
use serde::Serialize;
use stereo_formats::picture::Picture;
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage};

/// A way from two images to a disparity field. Each has one fixed parameter set for all scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Estimator {
    /// The vector pyramid over eight orientations (equations 1 to 4), with its default parameters.
    Vector,
    /// The dense epipolar estimator.
    Dense,
}

/// A parameter set of the dense estimator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Preset {
    /// For robots.
    Fast,
    /// For measurement.
    #[default]
    Best,
}

impl Preset {
    /// What the command line calls it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Fast => "fast",
            Self::Best => "best",
        }
    }

    /// Its parameters.
    pub(crate) fn params(self) -> DenseParams {
        match self {
            Self::Fast => DenseParams::fast(),
            Self::Best => DenseParams::best(),
        }
    }
}

impl Estimator {
    /// What the command line calls it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Vector => "vector",
            Self::Dense => "dense",
        }
    }

    /// The disparity of a pair whose truth lies within `search`; `preset` is the dense estimator's,
    /// `matching` the vector pyramid's.
    pub(crate) fn look(
        self,
        preset: Preset,
        matching: MatchParams,
        eyes: &Binocular<Picture>,
        search: SearchRange,
    ) -> anyhow::Result<DisparityField> {
        match self {
            Self::Vector => vector(&eyes.as_ref().map(Picture::luma), matching),
            Self::Dense => dense(preset.params(), eyes, search),
        }
    }
}

/// The shifts that the dense estimators, ours and others, are told to search in a scene: from none
/// to the first multiple of 16 px above the largest true disparity `d`.
pub(crate) fn search_of(truth: ArrayView2<'_, f32>) -> anyhow::Result<SearchRange> {
    let known = truth.iter().copied().filter(|d| d.is_finite());
    let most = known.fold(0.0f32, f32::max);
    let shifts = 16 * (most as i32 / 16 + 1);
    Ok(SearchRange::new(1 - shifts, 0)?)
}

/// The disparity of a pair by the dense estimator with these parameters.
pub(crate) fn dense(
    params: DenseParams,
    eyes: &Binocular<Picture>,
    search: SearchRange,
) -> anyhow::Result<DisparityField> {
    let matcher = DenseMatcher::plan(params, eyes.left.size())?;
    Ok(matcher.estimate(&views(eyes), search)?)
}

/// The disparity of a pair that nobody rectified, as `dorsal look --rectify auto` has it without a
/// rig: rows aligned and the range found by the vector pyramid; with the alignment.
pub(crate) fn self_rectified(
    params: DenseParams,
    eyes: &Binocular<Picture>,
) -> anyhow::Result<(DisparityField, RowAlignment)> {
    let size = eyes.left.size();
    let look = DenseLook {
        params,
        search: Search::default(),
        rows: Rows::Aligned,
    };
    let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size)
        .context("level 1 has no bank for these images")?;
    let eyes = views(eyes);
    let preparation = look.prepare(&eyes, &bank, MatchParams::default())?;
    let rows = preparation.rows.context("no rows were aligned")?;
    Ok((look.look(&eyes, &preparation)?, rows))
}

fn views(eyes: &Binocular<Picture>) -> Binocular<EyeView<'_>> {
    eyes.as_ref().map(|eye| EyeView {
        luma: eye.luma(),
        rgb: Some(eye.rgb()),
    })
}

/// The disparity of a pair by the vector pyramid with these parameters.
pub(crate) fn vector(
    eyes: &Binocular<&LumaImage>,
    matching: MatchParams,
) -> anyhow::Result<DisparityField> {
    let size = eyes.left.size();
    let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size)
        .context("level 1 has no bank for these images")?;
    let responses = eyes.try_map(|eye| bank.respond(eye))?;
    estimate(&responses, matching).context("level 2 cannot match these eyes")
}
