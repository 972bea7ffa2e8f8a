use crate::free_path::point_to_line;
use crate::ground_estimate::GroundEstimate;
use crate::interval::Interval;
use crate::squared_bounds::SquaredBounds;
use crate::{DepthSet, Orientation, OrientationSet};

/// Every place on the ground of a map frame where something may be: one interval for each axis,
/// in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GroundExtent {
    x: Interval,
    z: Interval,
}

impl GroundExtent {
    pub(crate) const fn point([x, z]: [f64; 2]) -> Self {
        Self {
            x: Interval::point(x),
            z: Interval::point(z),
        }
    }

    /// What lies within so many standard errors of an estimate, and the grain of its integers.
    pub(crate) fn of(estimate: &GroundEstimate, sigmas: f64) -> Self {
        let ([x, z], [[xx, _], [_, zz]]) = (estimate.position_m(), estimate.covariance_m2());
        let around = |centre: f64, variance: f64| {
            let half = sigmas * variance.max(0.0).sqrt() + 2e-6;
            Interval {
                low: centre - half,
                high: centre + half,
            }
        };
        Self {
            x: around(x, xx),
            z: around(z, zz),
        }
    }

    /// The distances from a place of this extent to one of `other`.
    pub(crate) fn distances_to(self, other: Self) -> Interval {
        (other.x - self.x).hypot(other.z - self.z)
    }

    /// The classes of those distances.
    pub(crate) fn depth_to(self, other: Self, bounds: &SquaredBounds) -> DepthSet {
        bounds.classes(other.x - self.x, other.z - self.z)
    }

    /// The labels of `other` at this place, against the direction from `observer` to it.
    pub(crate) fn orientation_of(self, other: Self, observer: Self) -> OrientationSet {
        if observer.distances_to(self).low <= 0.0 {
            // The observer may stand at this place, and then no direction leads to it.
            return OrientationSet::ALL;
        }
        let (front, way) = (self.minus(observer), other.minus(self));
        let ahead = front.x * way.x + front.z * way.z;
        // x to the right and z forward: left of +z is -x.
        let leftward = front.x * way.z - front.z * way.x;
        let labels = ahead.signs().flat_map(|a| {
            let leftward = leftward.signs();
            leftward.map(move |l| Orientation::of_offset(a, l))
        });
        let set: OrientationSet = labels.collect();
        if self.distances_to(other).low > 0.0 {
            set.without(Orientation::None)
        } else {
            set | Orientation::None.into()
        }
    }

    /// How far along the way from `from` to `to` this place lies, as the two dot products that
    /// say *beyond from* and *before to*.
    pub(crate) fn between(self, from: Self, to: Self) -> [Interval; 2] {
        let dot = |a: Self, b: Self| a.x * b.x + a.z * b.z;
        [
            dot(to.minus(from), self.minus(from)),
            dot(from.minus(to), self.minus(to)),
        ]
    }

    /// The distance between the nearest place of this extent and a segment; zero where they meet.
    pub(crate) fn distance_to_line(self, line: [[f64; 2]; 2]) -> f64 {
        let corners = [self.x.low, self.x.high]
            .into_iter()
            .flat_map(|x| [self.z.low, self.z.high].map(|z| [x, z]));
        let from_corner = corners.map(|corner| point_to_line(corner, line));
        let from_end = line
            .iter()
            .map(|&end| self.distances_to(Self::point(end)).low);
        if self.meets(line) {
            0.0
        } else {
            from_corner.chain(from_end).fold(f64::INFINITY, f64::min)
        }
    }

    /// Whether a segment passes through: the parts of it that lie within each axis overlap.
    fn meets(self, [a, b]: [[f64; 2]; 2]) -> bool {
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for (extent, a, b) in [(self.x, a[0], b[0]), (self.z, a[1], b[1])] {
            if a == b {
                if a < extent.low || a > extent.high {
                    return false;
                }
                continue;
            }
            let ends = [(extent.low - a) / (b - a), (extent.high - a) / (b - a)];
            from = from.max(ends[0].min(ends[1]));
            to = to.min(ends[0].max(ends[1]));
        }
        from <= to
    }

    fn minus(self, other: Self) -> Self {
        Self {
            x: self.x - other.x,
            z: self.z - other.z,
        }
    }
}
