use std::fmt;
use std::hash::Hash;
use std::marker::PhantomData;
use std::ops::{BitAnd, BitAndAssign, BitOr, BitOrAssign};

/// A base relation: one of at most 32 that exclude each other and leave nothing out.
///
/// [`Depth`](crate::Depth) and [`Orientation`](crate::Orientation) are the two of this calculus.
pub trait BaseRelation: Copy + Eq + Ord + Hash + fmt::Debug {
    /// Its place in the list of base relations, below 32.
    fn index(self) -> usize;

    /// The base relation at this place of the list.
    ///
    /// # Panics
    /// If the list is shorter.
    fn of_index(index: usize) -> Self;
}

/// A relation set: the disjunction of the base relations it contains.
///
/// The empty set is the contradiction. One word of bits, so union and intersection are one
/// instruction each. Elements come in ascending order of their index.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RelationSet<R> {
    bits: u32,
    of: PhantomData<R>,
}

impl<R: BaseRelation> RelationSet<R> {
    /// Nothing may hold: the contradiction.
    pub const EMPTY: Self = Self::of_bits(0);

    pub(crate) const fn of_bits(bits: u32) -> Self {
        Self {
            bits,
            of: PhantomData,
        }
    }

    pub(crate) const fn bits(self) -> u32 {
        self.bits
    }

    /// The first `count` base relations, at most 32.
    pub(crate) const fn first(count: usize) -> Self {
        Self::of_bits(if count >= 32 {
            u32::MAX
        } else {
            (1 << count) - 1
        })
    }

    /// The set of one base relation.
    #[must_use]
    pub fn only(relation: R) -> Self {
        Self::of_bits(1 << relation.index())
    }

    /// Every base relation from `low` to `high`, both included; empty if `low` comes after `high`.
    #[must_use]
    pub fn run(low: R, high: R) -> Self {
        let (low, high) = (low.index(), high.index());
        if low > high {
            return Self::EMPTY;
        }
        Self::of_bits(Self::first(high + 1).bits & !Self::first(low).bits)
    }

    /// The set less one base relation.
    #[must_use]
    pub fn without(self, relation: R) -> Self {
        Self::of_bits(self.bits & !Self::only(relation).bits)
    }

    /// Whether this base relation may hold.
    #[must_use]
    pub fn contains(self, relation: R) -> bool {
        self.bits >> relation.index() & 1 == 1
    }

    /// Whether everything that may hold here may also hold there.
    #[must_use]
    pub const fn is_subset(self, other: Self) -> bool {
        self.bits & !other.bits == 0
    }

    /// Whether nothing may hold.
    #[must_use]
    pub const fn is_empty(self) -> bool {
        self.bits == 0
    }

    /// How many base relations may hold.
    #[must_use]
    pub const fn len(self) -> usize {
        self.bits.count_ones() as usize
    }

    /// The base relation that certainly holds, if only one may.
    #[must_use]
    pub fn single(self) -> Option<R> {
        (self.len() == 1).then(|| R::of_index(self.bits.trailing_zeros() as usize))
    }

    /// The base relations that may hold, in ascending order.
    pub fn iter(self) -> impl Iterator<Item = R> + Clone {
        (0..32)
            .filter(move |index| self.bits >> index & 1 == 1)
            .map(R::of_index)
    }
}

impl<R: BaseRelation> Default for RelationSet<R> {
    fn default() -> Self {
        Self::EMPTY
    }
}

impl<R: BaseRelation> From<R> for RelationSet<R> {
    fn from(relation: R) -> Self {
        Self::only(relation)
    }
}

impl<R: BaseRelation> FromIterator<R> for RelationSet<R> {
    fn from_iter<I: IntoIterator<Item = R>>(relations: I) -> Self {
        relations
            .into_iter()
            .map(Self::only)
            .fold(Self::EMPTY, BitOr::bitor)
    }
}

impl<R: BaseRelation> BitOr for RelationSet<R> {
    type Output = Self;
    fn bitor(self, other: Self) -> Self {
        Self::of_bits(self.bits | other.bits)
    }
}

impl<R: BaseRelation> BitAnd for RelationSet<R> {
    type Output = Self;
    fn bitand(self, other: Self) -> Self {
        Self::of_bits(self.bits & other.bits)
    }
}

impl<R: BaseRelation> BitOrAssign for RelationSet<R> {
    fn bitor_assign(&mut self, other: Self) {
        *self = *self | other;
    }
}

impl<R: BaseRelation> BitAndAssign for RelationSet<R> {
    fn bitand_assign(&mut self, other: Self) {
        *self = *self & other;
    }
}

impl<R: BaseRelation> fmt::Debug for RelationSet<R> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.iter()).finish()
    }
}
