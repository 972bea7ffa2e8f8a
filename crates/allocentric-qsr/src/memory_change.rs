use std::fmt;

use serde::{Deserialize, Serialize};

use crate::memory_object::MemoryObject;
use crate::{Life, ObjectId};

/// One thing that became different in a memory.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "change", rename_all = "snake_case")]
pub enum Change {
    /// An object is seen for the first time, or again after its tombstone.
    Appeared {
        /// The object.
        object: ObjectId,
    },
    /// The life of an object went on.
    Became {
        /// The object.
        object: ObjectId,
        /// What it was.
        from: Life,
        /// What it is.
        to: Life,
    },
    /// An object is elsewhere; what was derived from its old place is void.
    Moved {
        /// The object.
        object: ObjectId,
        /// How often it has moved.
        epoch: u32,
    },
    /// A new map frame opened.
    NewFrame {
        /// Its number.
        frame: u32,
    },
    /// A fact was told.
    Told {
        /// Its words.
        fact: String,
    },
    /// A fact was taken back.
    Retracted {
        /// Its words.
        fact: String,
    },
}

/// A change with its time.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Dated {
    /// When, in milliseconds of the caller's clock.
    pub time_ms: u64,
    /// In which look, counted from 1; between looks it is the look before.
    pub look: u64,
    /// What.
    #[serde(flatten)]
    pub change: Change,
}

impl fmt::Display for Change {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Appeared { object } => write!(f, "{object} appeared"),
            Self::Became { object, from, to } => {
                write!(f, "{object} was {}, is {}", from.words(), to.words())
            }
            Self::Moved { object, epoch } => write!(f, "{object} moved ({epoch})"),
            Self::NewFrame { frame } => write!(f, "the pose was lost: map frame {frame} opens"),
            Self::Told { fact } => write!(f, "told: {fact}"),
            Self::Retracted { fact } => write!(f, "retracted: {fact}"),
        }
    }
}

/// Gives an object another life in the look of this time, and says so if it differs.
pub(crate) fn become_(
    object: ObjectId,
    kept: &mut MemoryObject,
    to: Life,
    time_ms: u64,
    changes: &mut Vec<Change>,
) {
    let from = kept.life;
    kept.life = to;
    kept.given_up_ms = match to {
        Life::Missing | Life::Removed => kept.given_up_ms.or(Some(time_ms)),
        _ => None,
    };
    if from != to {
        changes.push(Change::Became { object, from, to });
    }
}
