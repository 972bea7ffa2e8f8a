use crate::{BaseRelation, RelationSet};

/// A distance class: the index of a class in its [`DepthReference`](crate::DepthReference).
///
/// 0 is the class at the reference point. The labels are run-time data of the reference system,
/// so the index means nothing without it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Depth(u8);

/// The distance classes that may hold.
pub type DepthSet = RelationSet<Depth>;

impl Depth {
    /// The class at the reference point.
    pub const FIRST: Self = Self(0);
}

impl BaseRelation for Depth {
    fn index(self) -> usize {
        usize::from(self.0)
    }

    fn of_index(index: usize) -> Self {
        assert!(index < 32, "a reference system has at most 32 classes");
        Self(index as u8)
    }
}
