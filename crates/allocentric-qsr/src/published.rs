//! The published composition of two distance classes, whatever their directions.
//!
//! The same orientation bounds the answer from one side and the opposite orientation from the
//! other (section 2.2); the handling of the open last class and of the ends of a run is what
//! Tables 2 and 3 show.

use crate::depth_reference::DepthReference;
use crate::{Depth, DepthSet};

/// CASE 1: from the class of the difference to the class of the sum, both included.
///
/// The last class absorbs every other, for its upper bound is open and no sum leaves it; two of
/// the last class can differ by anything.
pub(crate) fn sum(reference: &DepthReference, first: Depth, second: Depth) -> DepthSet {
    let last = reference.last();
    let (Some(first_high), Some(second_high)) =
        (reference.high_mm(first), reference.high_mm(second))
    else {
        return if first == second {
            reference.all()
        } else {
            last.into()
        };
    };
    let gap = reference
        .low_mm(first)
        .saturating_sub(second_high)
        .max(reference.low_mm(second).saturating_sub(first_high));
    DepthSet::run(
        reference.qualify_mm(gap),
        reference.qualify_mm(first_high + second_high),
    )
}

/// CASE 2 and CASE 3: the one class that holds the largest difference, or ends with it.
///
/// The largest difference is a bound that no pair of distances attains, so a class that only
/// begins there is left out.
pub(crate) fn difference(reference: &DepthReference, first: Depth, second: Depth) -> DepthSet {
    let (Some(first_high), Some(second_high)) =
        (reference.high_mm(first), reference.high_mm(second))
    else {
        return reference.last().into();
    };
    let largest = first_high
        .saturating_sub(reference.low_mm(second))
        .max(second_high.saturating_sub(reference.low_mm(first)));
    reference
        .last_where(|from_mm| u64::from(from_mm) < largest)
        .into()
}
