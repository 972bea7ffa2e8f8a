use serde::Serialize;

use crate::machine::Machine;
use crate::metrics::Metrics;
use crate::robustness_series::Series;

/// One run over the scenes: what was measured, when, where and how.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct RobustnessRun {
    /// Version of this form.
    pub(crate) schema: &'static str,
    /// Date of the run, UTC.
    pub(crate) date: String,
    /// The machine.
    pub(crate) machine: Machine,
    /// The command that gives these numbers again; folders are left out.
    pub(crate) command: String,
    /// OpenCV's version, if it ran beside us.
    pub(crate) opencv: Option<String>,
    /// One list of trials a scene.
    pub(crate) scenes: Vec<SceneTrials>,
}

/// What became of one scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct SceneTrials {
    /// Name of the scene.
    pub(crate) scene: String,
    /// The paper to cite.
    pub(crate) citation: String,
    /// With the right picture untouched.
    pub(crate) untouched: Trial,
    /// With what befell it, series by series.
    pub(crate) altered: Vec<AlteredTrial>,
}

/// One altered pair.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct AlteredTrial {
    /// What befell the right camera.
    pub(crate) series: Series,
    /// How much of it.
    pub(crate) amount: f64,
    /// What the matchers made of it.
    pub(crate) trial: Trial,
}

/// How well each matcher did on one pair, over visible pixels whose match lies in the right picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Trial {
    /// Our horizontal component, valid pixels.
    pub(crate) ours: Option<Metrics>,
    /// The same, the best guess everywhere.
    pub(crate) ours_dense: Option<Metrics>,
    /// Our vertical component, valid pixels.
    pub(crate) ours_vertical: Option<Metrics>,
    /// OpenCV's SGBM, the pixels that it answers.
    pub(crate) sgbm: Option<Metrics>,
    /// OpenCV's BM, the pixels that it answers.
    pub(crate) bm: Option<Metrics>,
}

/// A matcher of a trial, by the name that tables and curves have.
pub(crate) type Matcher = (&'static str, fn(&Trial) -> Option<Metrics>);

impl Trial {
    /// The matchers whose horizontal errors are compared.
    pub(crate) const MATCHERS: [Matcher; 3] = [
        ("dorsal", |trial| trial.ours),
        ("SGBM", |trial| trial.sgbm),
        ("BM", |trial| trial.bm),
    ];
}

impl RobustnessRun {
    /// The form that this version writes.
    pub(crate) const SCHEMA: &'static str = "dorsal-robustness/1";

    /// The mean over the scenes of a measure at one amount of a series; `None` if a scene lacks it.
    pub(crate) fn mean(
        &self,
        series: Series,
        amount: f64,
        measure: impl Fn(&Trial) -> Option<f64>,
    ) -> Option<f64> {
        let found: Option<Vec<f64>> = self
            .scenes
            .iter()
            .map(|scene| measure(scene.trial(series, amount)?))
            .collect();
        let found = found.filter(|found| !found.is_empty())?;
        Some(found.iter().sum::<f64>() / found.len() as f64)
    }
}

impl SceneTrials {
    /// The trial of an amount of a series, if it was run.
    pub(crate) fn trial(&self, series: Series, amount: f64) -> Option<&Trial> {
        self.altered
            .iter()
            .find(|altered| altered.series == series && altered.amount == amount)
            .map(|altered| &altered.trial)
    }
}
