use allocentric_qsr::Change;
use serde::{Deserialize, Serialize};

use crate::RobotId;

/// What the map answers to a [`Report`](crate::Report).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Receipt {
    /// Whose report.
    pub robot: RobotId,
    /// Its run.
    pub run: u64,
    /// Its number.
    pub seq: u64,
    /// How many reports of this robot never came, over all its runs.
    pub lost: u64,
    /// What became of it.
    #[serde(flatten)]
    pub verdict: Verdict,
}

/// What became of a report.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "verdict", rename_all = "snake_case")]
pub enum Verdict {
    /// It is in the map.
    Taken {
        /// What became different in the memory of its robot.
        changes: Vec<Change>,
    },
    /// It was in the map before, or counted as lost since a later one is; the map stays as it was. A robot that got no receipt sends again.
    Again,
    /// Reports before it are still to come ([`Report::kept_from`](crate::Report::kept_from)), and it was not taken: the
    /// robot sends again from the expected one on, in order.
    Early {
        /// The number of the next report that the map takes.
        expected: u64,
    },
    /// The memory of its robot refused it, and stays as it was.
    Refused {
        /// Why.
        why: String,
    },
}

impl Receipt {
    /// Whether the report needs no sending any more: the map holds it, from this time or an earlier one.
    #[must_use]
    pub const fn is_taken(&self) -> bool {
        matches!(self.verdict, Verdict::Taken { .. } | Verdict::Again)
    }
}
