use crate::{DepthSet, ObjectId};

/// A told fact: which classes the distance between two objects may be in.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ToldFact {
    /// The two objects; a fact may speak of what has not been seen.
    pub between: [ObjectId; 2],
    /// The classes.
    pub depth: DepthSet,
}
