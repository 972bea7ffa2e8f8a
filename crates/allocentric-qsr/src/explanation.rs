use std::collections::BTreeSet;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::{ObjectId, OrientationSet};

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

/// One statement of an explanation, and why it holds.
///
/// As data `{"between": ["cup", "box"], "depth": ["vc"], "because": {"by": "told", "fact": ".."}}`,
/// or `{"observer": "door", "reference": "cup", "object": "lamp", "at_reference": ["l"],
/// "at_observer": ["fl"], "because": {..}}`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Step {
    /// What holds.
    #[serde(flatten)]
    pub statement: Statement,
    /// Why nothing else may.
    pub because: Because,
}

/// What a step says.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Statement {
    /// The distance classes between two objects.
    Distance {
        /// The two objects.
        between: [ObjectId; 2],
        /// The short labels of the classes that may hold, nearest first; none is the contradiction.
        depth: Vec<String>,
    },
    /// Where an object is at a reference, seen from an observer.
    Direction {
        /// Where the way comes from.
        observer: ObjectId,
        /// What it leads to.
        reference: ObjectId,
        /// What is placed.
        object: ObjectId,
        /// The labels of the object at the reference that may hold; none is the contradiction.
        at_reference: OrientationSet,
        /// Its labels at the observer, against the same way.
        at_observer: OrientationSet,
    },
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
    /// Two map frames that these objects join were measured.
    Joined {
        /// The looks that show the two objects last, counted from 1.
        looks: [u64; 2],
        /// The objects that both frames have.
        landmarks: Vec<ObjectId>,
    },
    /// Directions, alone or with distances, leave no other.
    Directed {
        /// By which rule.
        rule: Rule,
        /// What it is applied to.
        premises: Vec<usize>,
    },
    /// Two reasons together.
    Both {
        /// The two.
        premises: [usize; 2],
    },
}

/// A rule by which directions are reasoned with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Rule {
    /// Three distances and a direction of one triangle: no three points have others.
    Triangle,
    /// CASE 1: c at b seen from a, and the turn at b from c to d, give d at b seen from a.
    Chain,
    /// Two turns at one place add up.
    Turn,
    /// The same three points, told with another of them in the middle.
    Exchange,
}

impl Statement {
    /// The objects it speaks of.
    pub fn objects(&self) -> impl Iterator<Item = &ObjectId> {
        let (pair, triple) = match self {
            Self::Distance { between, .. } => (Some(between), None),
            Self::Direction {
                observer,
                reference,
                object,
                ..
            } => (None, Some([observer, reference, object])),
        };
        pair.into_iter()
            .flatten()
            .chain(triple.into_iter().flatten())
    }

    /// Whether nothing is left: the contradiction.
    #[must_use]
    pub fn is_impossible(&self) -> bool {
        match self {
            Self::Distance { depth, .. } => depth.is_empty(),
            Self::Direction { at_reference, .. } => at_reference.is_empty(),
        }
    }
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Distance { between, .. } => write!(f, "{} - {}: ", between[0], between[1])?,
            Self::Direction {
                observer,
                reference,
                object,
                ..
            } => write!(f, "{object} at {reference} seen from {observer}: ")?,
        }
        if self.is_impossible() {
            return f.write_str("nothing is left");
        }
        match self {
            Self::Distance { depth, .. } => write!(f, "{{{}}}", depth.join(", ")),
            Self::Direction {
                at_reference,
                at_observer,
                observer,
                ..
            } => write!(
                f,
                "{{{}}}, at {observer} {{{}}}",
                at_reference.labels().join(", "),
                at_observer.labels().join(", ")
            ),
        }
    }
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
        write!(f, "{:indent$}{}", "", step.statement, indent = 2 * depth)?;
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
            Because::Joined {
                looks: [a, b],
                landmarks,
            } => {
                let names: Vec<&str> = landmarks.iter().map(ObjectId::as_str).collect();
                let names = names.join(", ");
                writeln!(
                    f,
                    ", measured in looks {a} and {b}, whose frames {names} join"
                )?;
                &[]
            }
            Because::Directed { rule, premises } => {
                f.write_str(match rule {
                    Rule::Triangle => ", for no other triangle has",
                    Rule::Chain => ", one way after the other:",
                    Rule::Turn => ", one turn after the other:",
                    Rule::Exchange => ", the same three points:",
                })?;
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
