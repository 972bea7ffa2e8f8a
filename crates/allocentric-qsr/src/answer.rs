use std::fmt;

use serde::Serialize;

use crate::certainty::Certainty;
use crate::{Explanation, FreePath, Life, ObjectId, RelationRecord};

/// An answer; as data an object with `"answer"` and what belongs to it.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "answer", rename_all = "snake_case")]
pub enum Answer {
    /// Where one object is at another.
    Relation(RelationRecord),
    /// Objects, by name, those that certainly answer and those that possibly do.
    Objects {
        /// Certainly.
        certain: Vec<ObjectId>,
        /// Possibly, beside those.
        possible: Vec<ObjectId>,
    },
    /// Whether an arm gets there.
    Reachable {
        /// Whether it is near enough.
        reach: Certainty,
        /// What is on the way.
        way: FreePath,
    },
    /// What is on the way.
    FreePath(FreePath),
    /// When an object was seen last.
    LastSeen {
        /// The look, counted from 1.
        look: u64,
        /// Its time, in milliseconds.
        time_ms: u64,
        /// Where in its life the object is.
        life: Life,
    },
    /// Where an object is for the robot.
    Where {
        /// To the right, in metres.
        right_m: f64,
        /// Ahead, in metres.
        forward_m: f64,
        /// The covariance of the two, in square metres.
        covariance_m2: [[f64; 2]; 2],
    },
    /// Why.
    Explain(Explanation),
}

impl Answer {
    pub(crate) fn of_objects(found: Vec<(ObjectId, Certainty)>) -> Self {
        let (certain, possible): (Vec<_>, Vec<_>) = found
            .into_iter()
            .partition(|(_, sure)| *sure == Certainty::Certain);
        let names = |found: Vec<(ObjectId, Certainty)>| found.into_iter().map(|f| f.0).collect();
        Self::Objects {
            certain: names(certain),
            possible: names(possible),
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list = |names: &[ObjectId]| {
            let names: Vec<&str> = names.iter().map(ObjectId::as_str).collect();
            if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            }
        };
        match self {
            Self::Relation(relation) => {
                write!(
                    f,
                    "{} at {}: {{{}}}, {{{}}}",
                    relation.to,
                    relation.from,
                    relation.depth.join(", "),
                    relation.orientation.labels().join(", ")
                )?;
                if let Some(read) = &relation.read {
                    write!(f, "; read {} {}", read.depth, read.orientation.short())?;
                }
                Ok(())
            }
            Self::Objects { certain, possible } => {
                write!(
                    f,
                    "certainly {}; possibly {}",
                    list(certain),
                    list(possible)
                )
            }
            Self::Reachable { reach, way } => write!(f, "in reach: {reach}; the way: {way}"),
            Self::FreePath(path) => write!(f, "{path}"),
            Self::LastSeen {
                look,
                time_ms,
                life,
            } => {
                write!(f, "in look {look}, at {time_ms} ms; now {life}")
            }
            Self::Where {
                right_m,
                forward_m,
                covariance_m2: [[rr, _], [_, ff]],
            } => write!(
                f,
                "{right_m:.3} m to the right (sigma {:.3}), {forward_m:.3} m ahead (sigma {:.3})",
                rr.sqrt(),
                ff.sqrt()
            ),
            Self::Explain(explanation) => write!(f, "{explanation}"),
        }
    }
}
