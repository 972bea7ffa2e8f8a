use crate::ground_estimate::GroundEstimate;
use crate::sighting::BadSighting;
use crate::{Explanation, ObjectId};

/// What is refused; the memory stays as it was.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refused {
    /// A sighting shows nothing.
    #[error(transparent)]
    Sighting(#[from] BadSighting),
    /// The look is older than the last one.
    #[error("a look at {look_ms} ms comes after one at {last_ms} ms: time does not run backwards")]
    Time {
        /// The time of the look.
        look_ms: u64,
        /// The time of the last one.
        last_ms: u64,
    },
    /// Objects are not where they were.
    #[error("{} seen elsewhere than remembered ({} of {known} known objects in view)", names(.moved), .moved.len())]
    Moved {
        /// The objects, with their places.
        moved: Vec<Displaced>,
        /// How many objects of the look were known in this frame.
        known: usize,
    },
    /// What is seen, remembered and told cannot hold together.
    #[error("these cannot hold together:\n{0}")]
    Contradiction(Explanation),
    /// The fact is none.
    #[error("no fact: {0}")]
    Fact(#[from] crate::NotAFact),
    /// The fact was never told.
    #[error("nobody told that: {0}")]
    NeverTold(String),
}

/// An object that is not where it was.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Displaced {
    /// The object.
    pub object: ObjectId,
    /// Where it was, and since which look.
    pub remembered: GroundEstimate,
    /// The look that shows it there last.
    pub last_look: u64,
    /// Where the look has it.
    pub seen: GroundEstimate,
}

/// The names of the objects, for a sentence.
fn names(moved: &[Displaced]) -> String {
    let names: Vec<String> = moved.iter().map(|m| format!("`{}`", m.object)).collect();
    names.join(", ")
}
