use std::collections::BTreeMap;

use serde::Serialize;

use crate::alteration::Alteration;
use crate::machine::Machine;
use crate::metrics::Metrics;
use crate::rig_signs::RigSigns;
use crate::robustness_series::Series;

/// What befalls a pair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Condition {
    /// Nothing; grey pictures.
    Clean,
    /// Noise of 5 grey levels in both eyes.
    Noise,
    /// The right eye's gain is .6, 20 grey levels added.
    Gain,
    /// The right eye's gamma is 1.5.
    Gamma,
    /// The right eye 3 px lower or higher, turned by a degree either way, and 2 % larger or smaller; we
    /// align the rows ourselves.
    Rig(RigSigns),
    /// The pictures of the folder as they are, in colour.
    AsTaken,
}

impl Condition {
    /// Those that every listed scene is seen under.
    pub(crate) const SERIES: [Self; 4] = [Self::Clean, Self::Noise, Self::Gain, Self::Gamma];

    /// Its name in tables.
    pub(crate) const fn title(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Noise => "noise of 5 grey levels, both eyes",
            Self::Gain => "gain .6 + 20, right eye",
            Self::Gamma => "gamma 1.5, right eye",
            Self::Rig(signs) => signs.title(),
            Self::AsTaken => "as taken",
        }
    }

    /// What it does to the pictures.
    pub(crate) fn alteration(self) -> Alteration {
        match self {
            Self::Clean | Self::AsTaken => Alteration::NONE,
            Self::Noise => Series::NoiseOfBoth.alteration(5.0),
            Self::Gain => Series::Gain.alteration(0.6),
            Self::Gamma => Series::Gamma.alteration(1.5),
            Self::Rig(signs) => signs.alteration(),
        }
    }
}

/// One pair under one condition: errors over visible pixels, a value everywhere.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct DenseTrial {
    pub(crate) scene: String,
    pub(crate) condition: Condition,
    pub(crate) best: Option<Metrics>,
    pub(crate) fast: Option<Metrics>,
    /// OpenCV's, if it ran beside us.
    pub(crate) sgbm: Option<Metrics>,
    /// Root mean square of the true vertical disparity that our alignment leaves, px.
    pub(crate) residual_px: Option<f64>,
    /// The same as the alignment itself tells it, px.
    pub(crate) told_residual_px: Option<f64>,
}

/// One run: what was measured, when, where and how.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct DenseRobustnessRun {
    pub(crate) schema: &'static str,
    pub(crate) date: String,
    pub(crate) machine: Machine,
    /// The command that gives these numbers again; folders are left out.
    pub(crate) command: String,
    /// Versions of OpenCV and numpy, if they ran beside us.
    pub(crate) versions: BTreeMap<String, String>,
    pub(crate) trials: Vec<DenseTrial>,
}

impl DenseRobustnessRun {
    /// The form that this version writes.
    pub(crate) const SCHEMA: &'static str = "dorsal-dense-robustness/1";

    /// What became of a scene under a condition.
    pub(crate) fn trial(&self, scene: &str, condition: Condition) -> Option<&DenseTrial> {
        self.trials
            .iter()
            .find(|trial| trial.scene == scene && trial.condition == condition)
    }
}
