//! The fifteen relations of Freksa and Zimmermann's double cross.

use crate::Orientation::{
    self, BackLeft, BackRight, FrontLeft, FrontRight, Left, None as Nowhere, Right, StraightBack,
    StraightFront,
};
use crate::depth_reference::DepthReference;
use crate::{Depth, OrientationSet};

/// The label of d at c and the label of d at b, both against the direction from b to c, that
/// can hold together when b and c are two points.
pub(crate) const DOUBLE_CROSS: [(Orientation, Orientation); 15] = [
    (StraightFront, StraightFront),
    (FrontLeft, FrontLeft),
    (Left, FrontLeft),
    (BackLeft, FrontLeft),
    (BackLeft, Left),
    (BackLeft, BackLeft),
    (FrontRight, FrontRight),
    (Right, FrontRight),
    (BackRight, FrontRight),
    (BackRight, Right),
    (BackRight, BackRight),
    (StraightBack, StraightFront),
    (StraightBack, StraightBack),
    (StraightBack, Nowhere),
    (Nowhere, StraightFront),
];

/// The labels of d at c that go with these labels of d at b.
pub(crate) fn at_second(at_first: OrientationSet) -> OrientationSet {
    DOUBLE_CROSS
        .into_iter()
        .filter(|&(_, psi)| at_first.contains(psi))
        .map(|(p, _)| p)
        .collect()
}

/// Whether a class meets an open interval of distances, given by the squares of its ends.
///
/// Squares of whole millimetres compare exactly, where their roots would have to be rounded.
pub(crate) fn within(
    reference: &DepthReference,
    class: Depth,
    low_squared: u128,
    high_squared: Option<u128>,
) -> bool {
    let square = |mm: u64| u128::from(mm).pow(2);
    let ends_above = reference
        .high_mm(class)
        .is_none_or(|high| square(high) > low_squared);
    let begins_below = high_squared.is_none_or(|sup| square(reference.low_mm(class)) < sup);
    ends_above && begins_below
}
