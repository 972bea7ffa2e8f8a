//! Conceptual neighbourhoods: which base relations follow each other while a point moves without
//! jumps.
//!
//! A robot that is a little off, or a world that moved a little, is off by one neighbour at most;
//! widening a set to its neighbourhood is the weakest honest answer to "about so".

use crate::depth_reference::DepthReference;
use crate::{BaseRelation, Depth, DepthSet, Orientation, OrientationSet};

impl DepthReference {
    /// The classes next to this one: one nearer, one farther, where the system has them.
    ///
    /// # Panics
    /// If the class is of a larger system.
    #[must_use]
    pub fn neighbours(&self, depth: Depth) -> DepthSet {
        assert!(depth <= self.last(), "the class is of a larger system");
        let at = depth.index();
        let nearer = at.checked_sub(1).map(Depth::of_index);
        let farther = (depth < self.last()).then(|| Depth::of_index(at + 1));
        nearer.into_iter().chain(farther).collect()
    }

    /// The classes of the set and all their neighbours.
    ///
    /// # Panics
    /// If the set is of a larger system.
    #[must_use]
    pub fn neighbourhood(&self, depths: DepthSet) -> DepthSet {
        let around = depths.iter().map(|depth| self.neighbours(depth));
        around.fold(depths, |all, some| all | some)
    }
}

impl Orientation {
    /// The labels that may come next to this one while the reference directions stand and the
    /// point moves: a quadrant has its two rays and `none`, a ray its two quadrants and `none`,
    /// and from the reference point itself every direction is next.
    #[must_use]
    pub fn neighbours(self) -> OrientationSet {
        if self == Self::None {
            return OrientationSet::ALL.without(Self::None);
        }
        // Two labels touch where neither the sign ahead nor the sign leftward jumps over zero,
        // and one of the two is in the closure of the other: a ray beside a quadrant.
        let [ahead, leftward] = self.signs();
        Self::ALL
            .into_iter()
            .filter(|&other| {
                let [a, l] = other.signs();
                let jump = (a - ahead).abs() > 1 || (l - leftward).abs() > 1;
                let (mine, theirs) = (self.zeros(), other.zeros());
                !jump && mine != theirs && (other == Self::None || (a == ahead) != (l == leftward))
            })
            .collect()
    }

    /// The signs of how far ahead and how far to the left: the order of the nine labels is three
    /// rows of three.
    const fn signs(self) -> [i8; 2] {
        let place = self as i8;
        [1 - place / 3, 1 - place % 3]
    }

    /// On how many axes the label lies.
    const fn zeros(self) -> u8 {
        let [ahead, leftward] = self.signs();
        (ahead == 0) as u8 + (leftward == 0) as u8
    }
}

impl OrientationSet {
    /// The labels of the set and all their neighbours.
    #[must_use]
    pub fn neighbourhood(self) -> Self {
        self.iter()
            .map(Orientation::neighbours)
            .fold(self, |all, some| all | some)
    }
}
