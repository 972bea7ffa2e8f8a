use std::collections::BTreeSet;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::ObjectId;

/// Why a relation holds: a tree down to what was told and what was seen.
///
/// The steps stand in order, premises before what follows from them, the explained one last; a
/// premise that several steps share stands once. As data it is `{"steps": [..]}`; `Display`
/// writes the tree, indented, each shared part once.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Explanation {
    /// The steps; never empty.
    pub steps: Vec<Step>,
}

/// One relation of an explanation: the distance classes between two objects.
///
/// As data `{"between": ["cup", "box"], "depth": ["vc"], "because": {"by": "told", "fact": ".."}}`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Step {
    /// The two objects.
    pub between: [ObjectId; 2],
    /// The short labels of the classes that may hold, nearest first; none is the contradiction.
    pub depth: Vec<String>,
    /// Why no other may.
    pub because: Because,
}

/// Why a step holds. Premises are places in the list of steps.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "by", rename_all = "snake_case")]
pub enum Because {
    /// Nothing is known of this pair by itself.
    Unknown,
    /// It was told.
    Told {
        /// The words of the fact.
        fact: String,
    },
    /// It was measured.
    Measured {
        /// The looks that show the two objects last, counted from 1.
        looks: [u64; 2],
    },
    /// The distances to a third object leave no other.
    Composed {
        /// The third object.
        through: ObjectId,
        /// The relation of the first object with it, and of it with the second.
        premises: [usize; 2],
    },
    /// Two reasons together.
    Both {
        /// The two.
        premises: [usize; 2],
    },
}

impl Explanation {
    /// What is explained.
    #[must_use]
    pub fn conclusion(&self) -> Option<&Step> {
        self.steps.last()
    }

    /// Adds a step and gives its place.
    pub(crate) fn push(&mut self, step: Step) -> usize {
        self.steps.push(step);
        self.steps.len() - 1
    }

    fn branch(
        &self,
        f: &mut fmt::Formatter<'_>,
        at: usize,
        depth: usize,
        shown: &mut BTreeSet<usize>,
    ) -> fmt::Result {
        let Some(step) = self.steps.get(at) else {
            return Ok(());
        };
        let [from, to] = &step.between;
        write!(f, "{:indent$}{from} - {to}: ", "", indent = 2 * depth)?;
        if step.depth.is_empty() {
            write!(f, "nothing is left")?;
        } else {
            write!(f, "{{{}}}", step.depth.join(", "))?;
        }
        let premises: &[usize] = match &step.because {
            Because::Unknown => {
                writeln!(f, ", nothing known")?;
                &[]
            }
            Because::Told { fact } => {
                writeln!(f, ", told: {fact}")?;
                &[]
            }
            Because::Measured { looks: [a, b] } => {
                writeln!(f, ", measured in looks {a} and {b}")?;
                &[]
            }
            Because::Composed { through, premises } => {
                write!(f, ", through {through}")?;
                premises
            }
            Because::Both { premises } => {
                write!(f, ", both of")?;
                premises
            }
        };
        if premises.is_empty() {
            return Ok(());
        }
        if !shown.insert(at) {
            return writeln!(f, " (as above)");
        }
        writeln!(f)?;
        for &premise in premises.iter().filter(|&&premise| premise < at) {
            self.branch(f, premise, depth + 1, shown)?;
        }
        Ok(())
    }
}

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let root = self.steps.len().saturating_sub(1);
        self.branch(f, root, 0, &mut BTreeSet::new())
    }
}
