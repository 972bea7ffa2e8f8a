use crate::depth_reference::DepthReference;
use crate::interval::Interval;
use crate::{BaseRelation, Depth, DepthSet};

/// The lower bounds of the classes as squares, planned once for many pairs: a root for each pair
/// would be most of the work.
#[derive(Clone, Debug)]
pub(crate) struct SquaredBounds {
    /// In square metres; the first is zero.
    squares: Vec<f64>,
}

impl SquaredBounds {
    pub(crate) fn of(reference: &DepthReference) -> Self {
        let bounds = reference
            .classes()
            .iter()
            .map(|class| f64::from(class.from_mm) / 1e3);
        Self {
            squares: bounds.map(|bound| bound * bound).collect(),
        }
    }

    /// The classes of the lengths of a vector with these parts.
    ///
    /// A bound is rounded twice and a square thrice, by half a step each; four steps outward are
    /// more than all of it.
    pub(crate) fn classes(&self, x: Interval, z: Interval) -> DepthSet {
        const OUTWARD: f64 = 4.0 * f64::EPSILON;
        let [x, z] = [x.magnitude(), z.magnitude()];
        let low = (x.low * x.low + z.low * z.low) * (1.0 - OUTWARD);
        let high = (x.high * x.high + z.high * z.high) * (1.0 + OUTWARD);
        DepthSet::run(self.class(low), self.class(high))
    }

    /// The last class whose bound is not above this square; zero is above none.
    fn class(&self, square: f64) -> Depth {
        // Counting compares every bound and branches on none.
        let passed = self.squares.iter().skip(1);
        Depth::of_index(passed.map(|&bound| usize::from(bound <= square)).sum())
    }
}
