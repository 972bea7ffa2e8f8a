use serde::Serialize;

use crate::estimator::Estimator;
use crate::machine::Machine;
use crate::score::Score;
use crate::textured_marks::Textured;

/// One run over the scenes: what was measured, when, where and how.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Evaluation {
    /// Version of this form.
    pub(crate) schema: &'static str,
    /// Date of the run, UTC.
    pub(crate) date: String,
    /// The machine.
    pub(crate) machine: Machine,
    /// The command that gives these numbers again; folders are left out.
    pub(crate) command: String,
    /// The estimator.
    pub(crate) estimator: Estimator,
    /// One score a scene.
    pub(crate) scenes: Vec<Score>,
    /// The scenes of Table 1 over textured pixels, in every way that has a mark, beside the vector pyramid's
    /// default.
    pub(crate) textured: Vec<Textured>,
}

impl Evaluation {
    /// The form that this version writes.
    pub(crate) const SCHEMA: &'static str = "dorsal-evaluation/2";
}
