use std::collections::BTreeMap;

use serde::Serialize;

use crate::machine::Machine;
use crate::metrics::Metrics;
use crate::score::Score;

/// The dense estimator beside OpenCV's matchers: what was measured, when, where and how.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Comparison {
    /// Version of this form.
    pub(crate) schema: &'static str,
    /// Date of the run, UTC.
    pub(crate) date: String,
    /// The machine.
    pub(crate) machine: Machine,
    /// The command that gives these numbers again; folders are left out.
    pub(crate) command: String,
    /// Versions of OpenCV and numpy.
    pub(crate) versions: BTreeMap<String, String>,
    /// Our preset for measurement.
    pub(crate) best: Contestant,
    /// Our preset for robots.
    pub(crate) fast: Contestant,
    /// OpenCV, every mode with every setting.
    pub(crate) tried: Vec<Contestant>,
    /// Every measure of ours.
    pub(crate) best_scores: Vec<Score>,
    pub(crate) fast_scores: Vec<Score>,
}

/// One matcher with one setting.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Contestant {
    pub(crate) name: String,
    pub(crate) setting: String,
    pub(crate) scenes: Vec<OnScene>,
}

/// One matcher's result on a scene, a value at every pixel.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct OnScene {
    pub(crate) scene: String,
    pub(crate) visible: Metrics,
    pub(crate) all: Metrics,
    /// Over the visible pixels that it calls valid itself.
    pub(crate) estimated: Option<Metrics>,
    /// CPU time on one thread.
    pub(crate) seconds: f64,
    /// Our presets, best and fast, over as many of their most confident pixels as it calls valid.
    pub(crate) ours_at_its_density: Vec<Option<Metrics>>,
}

/// One number of a result on a scene.
pub(crate) type Measure = fn(&OnScene) -> f64;

impl Comparison {
    /// The form that this version writes.
    pub(crate) const SCHEMA: &'static str = "dorsal-opencv/1";

    /// Of every mode the setting with the least mean of visible bad-1 over the scenes, in the order
    /// of the modes.
    pub(crate) fn chosen(&self) -> Vec<&Contestant> {
        let mut chosen: Vec<&Contestant> = Vec::new();
        for tried in &self.tried {
            match chosen.iter_mut().find(|chosen| chosen.name == tried.name) {
                None => chosen.push(tried),
                Some(held) if tried.mean(visible_bad_1) < held.mean(visible_bad_1) => *held = tried,
                Some(_) => {}
            }
        }
        chosen
    }
}

impl Contestant {
    /// The mean of a measure over the scenes.
    pub(crate) fn mean(&self, measure: Measure) -> f64 {
        self.scenes.iter().map(measure).sum::<f64>() / self.scenes.len() as f64
    }
}

/// Per cent of the visible pixels that err by more than 1 px.
pub(crate) fn visible_bad_1(on: &OnScene) -> f64 {
    on.visible.bad.one
}

/// Mean absolute error over visible pixels, px.
pub(crate) fn visible_mean(on: &OnScene) -> f64 {
    on.visible.mean_absolute
}

/// Per cent of all pixels that err by more than 1 px.
pub(crate) fn all_bad_1(on: &OnScene) -> f64 {
    on.all.bad.one
}

/// CPU seconds.
pub(crate) fn seconds(on: &OnScene) -> f64 {
    on.seconds
}
