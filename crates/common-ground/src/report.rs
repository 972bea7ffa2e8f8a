use allocentric_qsr::MemoryLine;
use serde::{Deserialize, Serialize};

use crate::RobotId;

/// What a robot sends to the map: a look, or a fact told or taken back, with its place in what it has sent.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Report {
    /// Who.
    pub robot: RobotId,
    /// Which run of the robot's program; a later run has a greater number, such as the time it began. Sequence
    /// numbers begin anew with each.
    pub run: u64,
    /// The number of this report within its run, from 1 on, without gaps: a gap is a report lost on the way.
    pub seq: u64,
    /// The oldest report of this run that the robot keeps until its receipt, and will send again; without it, none is
    /// kept. What is missing from there on is still to come, and what is missing before is lost.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kept_from: Option<u64>,
    /// What; a question is no report.
    pub line: MemoryLine,
}
