use std::fmt;

use crate::observer::Observer;
use crate::words::word;
use crate::{ObjectId, OrientationSet};

/// A question in words.
///
/// | words | asks |
/// |---|---|
/// | `relation A from B [seen from C]` | where A is at B |
/// | `within CLASSES of X [and CONDITION]..` | which objects are at such a distance from X |
/// | `LABELS of X [seen from C] [and CONDITION]..` | which objects bear such a label at X |
/// | `between A and B` | which objects lie between A and B |
/// | `reachable A [within METRES] [radius METRES]` | whether an arm of 1 m gets to A |
/// | `free_path from A to B [radius METRES]` | whether the straight way is free |
/// | `last_seen A` | when A was seen last |
/// | `where A` | where A is for the robot |
/// | `explain A from B` | why the distance of A from B is what it is |
///
/// Names and classes are single words, or stand in double quotes; `robot` is the robot. CLASSES and LABELS are joined by
/// commas. Of the labels, `front`, `back`, `left` and `right` are half the plane each with its two
/// quadrants and the ray between (`right` is `fr,r,br`); the nine names and short labels of
/// [`Orientation`](crate::Orientation) are themselves, so an exact ray is asked for as `sf`, `l`, `r` or `sb`. Labels
/// at an object are seen from the robot unless said otherwise.
///
/// A query reads and writes the same: `parse` of `to_string` is the query.
#[derive(Clone, Debug, PartialEq)]
pub enum Query {
    /// `relation A from B seen from C`.
    Relation {
        /// What is placed.
        of: ObjectId,
        /// Where it is told from.
        from: ObjectId,
        /// Who looks.
        seen_from: Observer,
    },
    /// All conditions together.
    Which(Vec<Condition>),
    /// `between A and B`.
    Between(ObjectId, ObjectId),
    /// `reachable A within M radius M`.
    Reachable {
        /// What is reached for.
        object: ObjectId,
        /// How far the arm reaches, in metres.
        reach_m: f64,
        /// The radius of what moves, in metres.
        radius_m: f64,
    },
    /// `free_path from A to B radius M`.
    FreePath {
        /// Where the way begins.
        from: Observer,
        /// Where it ends.
        to: Observer,
        /// The radius of what moves, in metres.
        radius_m: f64,
    },
    /// `last_seen A`.
    LastSeen(ObjectId),
    /// `where A`.
    Where(ObjectId),
    /// `explain A from B`.
    Explain(ObjectId, ObjectId),
}

/// One thing asked of an object.
#[derive(Clone, Debug, PartialEq)]
pub enum Condition {
    /// `within vc,c of X`: the class labels as written, and the centre.
    Within(Vec<String>, Observer),
    /// `fr,r,br of X seen from C`.
    Oriented(OrientationSet, Observer, Observer),
}

/// Words that are no query.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadQuery {
    /// There are no words.
    #[error("an empty question; ask for example `relation pc_screen from cd_box seen from robot`")]
    Empty,
    /// A word is missing or another stands in its place.
    #[error("`{found}` where {expected} should stand")]
    Word {
        /// What stands there; empty at the end.
        found: String,
        /// What should.
        expected: &'static str,
    },
}

impl fmt::Display for Query {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Relation {
                of,
                from,
                seen_from,
            } => {
                let (of, from, by) = (word(of), word(from), place(seen_from));
                write!(f, "relation {of} from {from} seen from {by}")
            }
            Self::Which(conditions) => {
                for (at, condition) in conditions.iter().enumerate() {
                    let and = if at > 0 { " and " } else { "" };
                    match condition {
                        Condition::Within(classes, centre) => {
                            write!(f, "{and}within {} of {}", classes.join(","), place(centre))?;
                        }
                        Condition::Oriented(labels, at, from) => {
                            let labels = labels.labels().join(",");
                            let (at, from) = (place(at), place(from));
                            write!(f, "{and}{labels} of {at} seen from {from}")?;
                        }
                    }
                }
                Ok(())
            }
            Self::Between(a, b) => write!(f, "between {} and {}", word(a), word(b)),
            Self::Reachable {
                object,
                reach_m,
                radius_m,
            } => {
                let object = word(object);
                write!(f, "reachable {object} within {reach_m} radius {radius_m}")
            }
            Self::FreePath { from, to, radius_m } => {
                let (from, to) = (place(from), place(to));
                write!(f, "free_path from {from} to {to} radius {radius_m}")
            }
            Self::LastSeen(object) => write!(f, "last_seen {}", word(object)),
            Self::Where(object) => write!(f, "where {}", word(object)),
            Self::Explain(of, from) => write!(f, "explain {} from {}", word(of), word(from)),
        }
    }
}

/// A place in words. A pose has none of its own in the language, where the robot is meant.
fn place(at: &Observer) -> String {
    match at {
        Observer::Object(object) => word(object),
        Observer::Robot | Observer::At(_) => "robot".to_owned(),
    }
}
