use std::fmt;

use serde::{Deserialize, Serialize};

use crate::{BaseRelation, RelationSet};

/// How sure an answer is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Certainty {
    /// In no case that what is known allows.
    No,
    /// In some.
    Possible,
    /// In every.
    Certain,
}

impl Certainty {
    /// How sure it is that what holds, one of `known`, is one of `asked`.
    #[must_use]
    pub fn of<R: BaseRelation>(known: RelationSet<R>, asked: RelationSet<R>) -> Self {
        if (known & asked).is_empty() {
            Self::No
        } else if known.is_subset(asked) {
            Self::Certain
        } else {
            Self::Possible
        }
    }
}

impl fmt::Display for Certainty {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::No => "no",
            Self::Possible => "possible",
            Self::Certain => "certain",
        })
    }
}
