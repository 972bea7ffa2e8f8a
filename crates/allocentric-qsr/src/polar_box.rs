use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::depth_reference::DepthReference;
use crate::{DepthSet, Orientation, OrientationSet, Places, Sighting};

/// The part of a bound that rounding may cost. The longest chain here is a dozen operations of
/// at most one unit in the last place, 2.2e-16, on angles below three turns; this is a hundred
/// times that.
const ROUNDING: f64 = 1e-12;

/// Every position an object may have, as an observer sees it: an interval of distances and an
/// arc of bearings, each rounded outward.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PolarBox {
    near_m: f64,
    far_m: f64,
    from_rad: f64,
    to_rad: f64,
}

impl PolarBox {
    /// The box of these distances and bearings; the arc runs counter-clockwise.
    pub(crate) fn new((near_m, far_m): (f64, f64), (from_rad, to_rad): (f64, f64)) -> Self {
        Self {
            near_m: (near_m * (1.0 - ROUNDING)).max(0.0),
            far_m: far_m * (1.0 + ROUNDING),
            from_rad: from_rad - ROUNDING,
            to_rad: to_rad + ROUNDING,
        }
    }

    /// The box of a checked sighting, `sigmas` standard errors to either side.
    pub(crate) fn of_sighting(sighting: &Sighting, sigmas: f64) -> Self {
        let distance = sigmas * sighting.sigma_distance_m;
        // More than half a turn to either side is every direction, and stays a small number.
        let bearing = (sigmas * sighting.sigma_bearing_rad).min(PI);
        let centre = sighting.bearing_rad.rem_euclid(TAU);
        Self::new(
            (
                sighting.distance_m - distance,
                sighting.distance_m + distance,
            ),
            (centre - bearing, centre + bearing),
        )
    }

    /// The box for an observer whose heading may be off by so much to either side.
    pub(crate) fn turned_within(self, half_rad: f64) -> Self {
        Self::new(
            (self.near_m, self.far_m),
            (self.from_rad - half_rad, self.to_rad + half_rad),
        )
    }

    /// The classes and orientations of the object for the observer.
    pub(crate) fn egocentric(self, reference: &DepthReference) -> Places {
        let mut orientation = directions(self.from_rad, self.to_rad);
        if self.near_m == 0.0 {
            orientation |= Orientation::None.into();
        }
        Places {
            depth: run(reference, (self.near_m, self.far_m)),
            orientation,
        }
    }

    /// The label of `other` at the observer, against the direction to this object.
    pub(crate) fn turn_to(self, other: Self) -> OrientationSet {
        if self.near_m == 0.0 {
            return OrientationSet::ALL;
        }
        let (from, to) = self.angle_to(other);
        let mut turn = directions(FRAC_PI_2 + from, FRAC_PI_2 + to);
        if other.near_m == 0.0 {
            turn |= Orientation::None.into();
        }
        turn
    }

    /// The places of `other` at this object, against the direction from the observer to it.
    pub(crate) fn places_of(self, other: Self, reference: &DepthReference) -> Places {
        let distances = self.distances_to(other);
        Places {
            depth: run(reference, distances),
            orientation: self.orientations_of(other, distances.0),
        }
    }

    /// The signs of how far ahead and how far to the left `other` may lie decide the label:
    /// ahead is `b cos D - a` and leftward `b sin D`, with a and b the two distances from the
    /// observer and D the turn between them.
    fn orientations_of(self, other: Self, nearest_m: f64) -> OrientationSet {
        if self.near_m == 0.0 {
            // The observer may stand at this object, and then no direction leads to it.
            return OrientationSet::ALL;
        }
        let (from, to) = self.angle_to(other);
        let reach = |cosine: f64| [other.near_m * cosine, other.far_m * cosine];
        let [low, high] = extremes(f64::cos, 0.0, from, to);
        let slack = ROUNDING * (self.far_m + other.far_m);
        let ahead_low = reach(low).into_iter().fold(f64::INFINITY, f64::min) - self.far_m - slack;
        let ahead_high =
            reach(high).into_iter().fold(f64::NEG_INFINITY, f64::max) - self.near_m + slack;
        let [mut left_low, mut left_high] = extremes(f64::sin, FRAC_PI_2, from, to);
        if other.near_m == 0.0 {
            left_low = left_low.min(0.0);
            left_high = left_high.max(0.0);
        }
        let mut set = OrientationSet::EMPTY;
        for ahead in signs(ahead_low, ahead_high) {
            for leftward in signs(left_low - ROUNDING, left_high + ROUNDING) {
                set |= Orientation::of_offset(ahead, leftward).into();
            }
        }
        if nearest_m > 0.0 {
            set.without(Orientation::None)
        } else {
            set
        }
    }

    /// The least and the greatest distance between a point of this box and one of `other`.
    fn distances_to(self, other: Self) -> (f64, f64) {
        let (from, to) = self.angle_to(other);
        // The law of cosines falls with the cosine of the turn, so the ends of the cosine are
        // the ends of the distance.
        let [widest, narrowest] = extremes(f64::cos, 0.0, from, to).map(|c| c.clamp(-1.0, 1.0));
        let ours = [self.near_m, self.far_m];
        let theirs = [other.near_m, other.far_m];
        let mut nearest = f64::INFINITY;
        let mut farthest: f64 = 0.0;
        for a in ours {
            for b in theirs {
                nearest = nearest.min(third_side(a, b, narrowest));
                farthest = farthest.max(third_side(a, b, widest));
            }
        }
        // The distance is convex in either radius, so it may dip between the corners.
        for a in ours {
            let b = (a * narrowest).clamp(other.near_m, other.far_m);
            nearest = nearest.min(third_side(a, b, narrowest));
        }
        for b in theirs {
            let a = (b * narrowest).clamp(self.near_m, self.far_m);
            nearest = nearest.min(third_side(a, b, narrowest));
        }
        // The cosine is known to 1e-12 of one, and enters the square of the distance times 2ab;
        // a square that small is a length of 1e-6 times the radii.
        let scale = self.far_m + other.far_m;
        let square_error = ROUNDING * scale * scale;
        (
            (nearest * nearest - square_error).max(0.0).sqrt(),
            (farthest * farthest + square_error).sqrt(),
        )
    }

    /// The arc of turns from a bearing of this box to a bearing of `other`.
    fn angle_to(self, other: Self) -> (f64, f64) {
        (other.from_rad - self.to_rad, other.to_rad - self.from_rad)
    }
}

/// The side of a triangle across the angle with this cosine, between sides `a` and `b`.
fn third_side(a: f64, b: f64, cosine: f64) -> f64 {
    // (a - b)^2 + 2ab (1 - cos) does not cancel where a and b are alike.
    ((a - b) * (a - b) + 2.0 * a * b * (1.0 - cosine)).sqrt()
}

/// The least and greatest value on an arc of a wave that peaks at `peak` and bottoms half a turn
/// later.
fn extremes(wave: fn(f64) -> f64, peak: f64, from: f64, to: f64) -> [f64; 2] {
    let holds = |angle: f64| angle + TAU * ((from - angle) / TAU).ceil() <= to;
    let ends = [wave(from), wave(to)];
    let low = if holds(peak + PI) {
        -1.0
    } else {
        ends[0].min(ends[1])
    };
    let high = if holds(peak) {
        1.0
    } else {
        ends[0].max(ends[1])
    };
    [low, high]
}

/// The signs a number between these ends may have, as -1, 0 and 1.
fn signs(low: f64, high: f64) -> impl Iterator<Item = i8> + Clone {
    [
        (-1, low < 0.0),
        (0, low <= 0.0 && high >= 0.0),
        (1, high > 0.0),
    ]
    .into_iter()
    .filter_map(|(sign, possible)| possible.then_some(sign))
}

fn run(reference: &DepthReference, (near_m, far_m): (f64, f64)) -> DepthSet {
    DepthSet::run(reference.class_of(near_m), reference.class_of(far_m))
}

/// The orientations of an arc that is finite and runs forward by construction.
fn directions(from_rad: f64, to_rad: f64) -> OrientationSet {
    OrientationSet::of_arc(from_rad, to_rad).unwrap_or(OrientationSet::ALL)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::BaseRelation;

    fn boxes() -> impl Strategy<Value = (PolarBox, f64, f64)> {
        let unit = || 0.0..=1.0f64;
        (
            0.0..3.0f64,
            0.0..0.8f64,
            -7.0..7.0f64,
            0.0..1.5f64,
            unit(),
            unit(),
        )
            .prop_map(|(near, deep, from, wide, along, around)| {
                (
                    PolarBox::new((near, near + deep), (from, from + wide)),
                    near + along * deep,
                    from + around * wide,
                )
            })
    }

    proptest! {
        /// Whatever points of the two boxes are true, the answer contains their relation.
        #[test]
        fn boxes_contain_the_truth((first, a, alpha) in boxes(), (second, b, beta) in boxes()) {
            prop_assume!(a > 1e-9);
            let reference = DepthReference::drs2();
            let turn = beta - alpha;
            let (ahead, leftward) = (b * turn.cos() - a, b * turn.sin());
            let places = first.places_of(second, &reference);
            prop_assert!(places.depth.contains(reference.class_of(ahead.hypot(leftward))));
            prop_assert!(places.orientation.contains(Orientation::of_offset(ahead, leftward)));
            let label = Orientation::of_bearing(FRAC_PI_2 + turn).unwrap();
            prop_assert!(b == 0.0 || first.turn_to(second).contains(label));
        }
    }

    /// A box that is a point apart from rounding admits few labels.
    #[test]
    fn points_are_told_apart() {
        let reference = DepthReference::drs1();
        let first = PolarBox::new((1.0, 1.0), (FRAC_PI_2, FRAC_PI_2));
        let second = PolarBox::new((1.25, 1.25), (FRAC_PI_2 - 0.3, FRAC_PI_2 - 0.3));
        let places = first.places_of(second, &reference);
        assert_eq!(places.depth.single().map(BaseRelation::index), Some(1));
        assert_eq!(places.orientation.single(), Some(Orientation::FrontRight));
    }
}
