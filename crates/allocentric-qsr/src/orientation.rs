use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::fmt;

use serde::de::Error as _;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use self::Orientation::{
    BackLeft, BackRight, FrontLeft, FrontRight, Left, None as Nowhere, Right, StraightBack,
    StraightFront,
};
use crate::{BaseRelation, RelationSet};

/// The nine orientations of Freksa and Zimmermann, in the paper's order.
///
/// Front is the direction from the first reference point to the second, at 90 degrees; right is
/// at 0. The intervals are those of Figure 5, the only ones the paper prints that cover every
/// direction once: four exact rays, four open quadrants, and the reference point itself.
///
/// As data an orientation is its short label, a relation set an array of them: `["fl", "sf"]`.
/// `n` here is *none*; the `n` of a depth reference system is *nearby*, another type.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum Orientation {
    /// `fl`, the open quadrant from 90 to 180 degrees.
    #[serde(rename = "fl")]
    FrontLeft,
    /// `sf`, the ray at 90 degrees.
    #[serde(rename = "sf")]
    StraightFront,
    /// `fr`, the open quadrant from 0 to 90 degrees.
    #[serde(rename = "fr")]
    FrontRight,
    /// `l`, the ray at 180 degrees.
    #[serde(rename = "l")]
    Left,
    /// `n`, no direction: at the reference point.
    #[serde(rename = "n")]
    None,
    /// `r`, the ray at 0 degrees.
    #[serde(rename = "r")]
    Right,
    /// `bl`, the open quadrant from 180 to 270 degrees.
    #[serde(rename = "bl")]
    BackLeft,
    /// `sb`, the ray at 270 degrees.
    #[serde(rename = "sb")]
    StraightBack,
    /// `br`, the open quadrant from 270 to 360 degrees.
    #[serde(rename = "br")]
    BackRight,
}

/// The orientations that may hold; as data an array of short labels in the paper's order.
pub type OrientationSet = RelationSet<Orientation>;

/// An angle that points nowhere.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("a bearing of {0} rad points nowhere; it must be finite")]
pub struct NotABearing(pub f64);

/// The eight directions counter-clockwise from straight front: rays at even places, quadrants
/// at odd ones.
const COMPASS: [Orientation; 8] = [
    StraightFront,
    FrontLeft,
    Left,
    BackLeft,
    StraightBack,
    BackRight,
    Right,
    FrontRight,
];

impl Orientation {
    /// All nine, in the paper's order.
    pub const ALL: [Self; 9] = [
        FrontLeft,
        StraightFront,
        FrontRight,
        Left,
        Nowhere,
        Right,
        BackLeft,
        StraightBack,
        BackRight,
    ];

    /// The short label of tables and files.
    #[must_use]
    pub const fn short(self) -> &'static str {
        ["fl", "sf", "fr", "l", "n", "r", "bl", "sb", "br"][self as usize]
    }

    /// The name a person reads.
    #[must_use]
    pub const fn name(self) -> &'static str {
        [
            "front_left",
            "straight_front",
            "front_right",
            "left",
            "none",
            "right",
            "back_left",
            "straight_back",
            "back_right",
        ][self as usize]
    }

    /// The orientation with this short label or name.
    #[must_use]
    pub fn named(label: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|o| o.short() == label || o.name() == label)
    }

    /// The orientation of an exact bearing in radians: front at pi/2, right at 0.
    ///
    /// A ray is met only by the number nearest to its angle, up to whole turns; a measured
    /// bearing never meets one, so use [`OrientationSet::of_arc`] for what may hold and
    /// [`Orientation::read`] for what to call it.
    ///
    /// # Errors
    /// [`NotABearing`] if the angle is not finite.
    pub fn of_bearing(bearing_rad: f64) -> Result<Self, NotABearing> {
        if !bearing_rad.is_finite() {
            return Err(NotABearing(bearing_rad));
        }
        let arc = OrientationSet::of_arc(bearing_rad, bearing_rad)?;
        Ok(arc.single().unwrap_or(Nowhere))
    }

    /// The orientation of an exact offset from the reference point: how far ahead and how far
    /// to the left, in any unit. Only the signs matter, so integers qualify exactly.
    #[must_use]
    pub fn of_offset<N: PartialOrd + Default>(ahead: N, leftward: N) -> Self {
        let zero = N::default();
        let sign = |n: N| {
            if n > zero {
                0
            } else if n < zero {
                2
            } else {
                1
            }
        };
        Self::ALL[3 * sign(ahead) + sign(leftward)]
    }

    /// The label a person reads: a ray if the bearing is within `tolerance_rad` of it, else the
    /// quadrant.
    ///
    /// Exact rays have measure zero, so nobody would ever be told *straight front* without a
    /// tolerance. The label serves people; reasoning uses the set.
    ///
    /// # Errors
    /// [`NotABearing`] if the angle is not finite.
    pub fn read(bearing_rad: f64, tolerance_rad: f64) -> Result<Self, NotABearing> {
        let quarter = (bearing_rad / FRAC_PI_2).round();
        if (bearing_rad - quarter * FRAC_PI_2).abs() <= tolerance_rad {
            Self::of_bearing(quarter.rem_euclid(4.0) * FRAC_PI_2)
        } else {
            Self::of_bearing(bearing_rad)
        }
    }

    /// The orientation turned by half a circle; `none` stays.
    ///
    /// This is the converse where both ends share one reference direction: if b lies front left
    /// of a, then a lies back right of b.
    #[must_use]
    pub fn converse(self) -> Self {
        self.compass().map_or(Nowhere, |at| COMPASS[(at + 4) % 8])
    }

    /// The orientation with left and right exchanged.
    #[must_use]
    pub fn mirrored(self) -> Self {
        self.compass().map_or(Nowhere, |at| COMPASS[(8 - at) % 8])
    }

    /// The sum of two turns: a direction that bears `self` to one that bears `other` to the
    /// reference. A ray turns exactly; two open quadrants sum to a half circle, three labels.
    /// What is at the point itself stays there.
    #[must_use]
    pub fn turned(self, other: Self) -> OrientationSet {
        let (Some(a), Some(b)) = (self.compass(), other.compass()) else {
            return Nowhere.into();
        };
        let sum = a + b;
        if a % 2 == 1 && b % 2 == 1 {
            [sum + 7, sum, sum + 1]
                .map(|at| COMPASS[at % 8])
                .into_iter()
                .collect()
        } else {
            COMPASS[sum % 8].into()
        }
    }

    /// The place among [`COMPASS`], or `None` for no direction.
    fn compass(self) -> Option<usize> {
        COMPASS.into_iter().position(|direction| direction == self)
    }
}

impl OrientationSet {
    /// All nine orientations: nothing is known.
    pub const ALL: Self = Self::first(9);

    /// The orientations of the bearings from `from_rad` counter-clockwise to `to_rad`, both
    /// included. A full turn or more gives all eight directions.
    ///
    /// A bearing whose error straddles an axis becomes the ray and both of its quadrants.
    ///
    /// # Errors
    /// [`NotABearing`] if an end is not finite, or the arc ends before it begins.
    pub fn of_arc(from_rad: f64, to_rad: f64) -> Result<Self, NotABearing> {
        if !from_rad.is_finite() {
            return Err(NotABearing(from_rad));
        }
        if !(to_rad.is_finite() && to_rad >= from_rad) {
            return Err(NotABearing(to_rad));
        }
        let from = from_rad.rem_euclid(TAU);
        let to = from + (to_rad - from_rad);
        if to - from >= TAU {
            return Ok(COMPASS.into_iter().collect());
        }
        // Multiples of one number, so that the angle written as that multiple meets the ray.
        let quarters = [0.0, FRAC_PI_2, PI, PI + FRAC_PI_2];
        let axis = |k: usize| quarters[k % 4] + TAU * (k / 4) as f64;
        let rays = [Right, StraightFront, Left, StraightBack];
        let quadrants = [FrontRight, FrontLeft, BackLeft, BackRight];
        let mut set = Self::EMPTY;
        for k in 0..8 {
            let (here, next) = (axis(k), axis(k + 1));
            if from <= here && here <= to {
                set |= rays[k % 4].into();
            }
            if from < next && here < to {
                set |= quadrants[k % 4].into();
            }
        }
        Ok(set)
    }

    /// The set with every member turned by every member of `other`; see
    /// [`Orientation::turned`].
    #[must_use]
    pub fn turned(self, other: Self) -> Self {
        self.iter()
            .flat_map(|a| other.iter().map(move |b| a.turned(b)))
            .fold(Self::EMPTY, |all, some| all | some)
    }

    /// The converse of every member.
    #[must_use]
    pub fn converse(self) -> Self {
        self.iter().map(Orientation::converse).collect()
    }

    /// Every member with left and right exchanged.
    #[must_use]
    pub fn mirrored(self) -> Self {
        self.iter().map(Orientation::mirrored).collect()
    }

    /// The short labels in the paper's order: the form of every file.
    #[must_use]
    pub fn labels(self) -> Vec<&'static str> {
        self.iter().map(Orientation::short).collect()
    }
}

impl BaseRelation for Orientation {
    fn index(self) -> usize {
        self as usize
    }

    fn of_index(index: usize) -> Self {
        Self::ALL[index]
    }
}

impl fmt::Display for Orientation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl Serialize for OrientationSet {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.iter())
    }
}

impl<'de> Deserialize<'de> for OrientationSet {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let labels = Vec::<Orientation>::deserialize(deserializer)?;
        let set: Self = labels.iter().copied().collect();
        if set.len() == labels.len() {
            Ok(set)
        } else {
            Err(D::Error::custom("an orientation stands twice in a set"))
        }
    }
}
