use anyhow::Context;
use clap::ValueEnum;
use disparity_pyramid::{DisparityField, MatchParams, estimate};
use serde::Serialize;
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage};

/// A way from two images to a disparity field. Each has one fixed parameter set for all scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Estimator {
    /// The vector pyramid over eight orientations (equations 1 to 4), with its default parameters.
    Vector,
}

impl Estimator {
    /// What the command line calls it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Vector => "vector",
        }
    }

    /// The disparity of a pair.
    pub(crate) fn look(self, eyes: &Binocular<LumaImage>) -> anyhow::Result<DisparityField> {
        match self {
            Self::Vector => vector(eyes),
        }
    }
}

fn vector(eyes: &Binocular<LumaImage>) -> anyhow::Result<DisparityField> {
    let size = eyes.left.size();
    let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size)
        .context("level 1 has no bank for these images")?;
    let responses = eyes.as_ref().try_map(|eye| bank.respond(eye))?;
    estimate(&responses, MatchParams::default()).context("level 2 cannot match these eyes")
}
