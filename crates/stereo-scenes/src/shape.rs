use serde::Deserialize;

use crate::solid::Solid;

/// A solid body or a flat panel of the room, in the room frame (x right, y away, z up; metres).
///
/// In a room file: `shape.sphere = { centre_m = [1.2, 0.9, 0.8], radius_m = 0.05 }`, and so on.
/// Turns are in degrees about the vertical, positive to the right (clockwise seen from above), as
/// the heading of a head is.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
pub enum Shape {
    /// A box that stands upright.
    Box {
        /// Middle of the foot.
        base_m: [f64; 3],
        /// Width, depth and height, before the turn: along x, y and z.
        size_m: [f64; 3],
        /// Turn about the vertical through the middle.
        #[serde(default)]
        turn_deg: f64,
    },
    /// A ball.
    Sphere {
        /// Centre.
        centre_m: [f64; 3],
        /// Radius.
        radius_m: f64,
    },
    /// A cylinder that stands upright, with lids.
    Cylinder {
        /// Middle of the foot.
        base_m: [f64; 3],
        /// Radius.
        radius_m: f64,
        /// Height.
        height_m: f64,
    },
    /// A flat panel without thickness, the same from both sides.
    ///
    /// Unturned it stands upright and faces a head of heading 0.
    Rectangle {
        /// Centre.
        centre_m: [f64; 3],
        /// Width and height.
        size_m: [f64; 2],
        /// Turn about the vertical through the centre.
        #[serde(default)]
        turn_deg: f64,
        /// How far its top leans away from the head: 0 stands, 90 lies flat.
        #[serde(default)]
        lean_deg: f64,
    },
}

impl Shape {
    /// The middle of the body, in metres.
    #[must_use]
    pub fn centre_m(&self) -> [f64; 3] {
        Solid::new(self).centre.to_array()
    }

    /// How high its lowest point is, in metres: that of what it stands on.
    #[must_use]
    pub fn foot_m(&self) -> f64 {
        let solid = Solid::new(self);
        solid.centre.z - solid.half_extent().z
    }

    /// The same body elsewhere, `step_m` away.
    #[must_use]
    pub fn moved(self, step_m: [f64; 3]) -> Self {
        let at = |[x, y, z]: [f64; 3]| [x + step_m[0], y + step_m[1], z + step_m[2]];
        match self {
            Self::Box {
                base_m,
                size_m,
                turn_deg,
            } => Self::Box {
                base_m: at(base_m),
                size_m,
                turn_deg,
            },
            Self::Sphere { centre_m, radius_m } => Self::Sphere {
                centre_m: at(centre_m),
                radius_m,
            },
            Self::Cylinder {
                base_m,
                radius_m,
                height_m,
            } => Self::Cylinder {
                base_m: at(base_m),
                radius_m,
                height_m,
            },
            Self::Rectangle {
                centre_m,
                size_m,
                turn_deg,
                lean_deg,
            } => Self::Rectangle {
                centre_m: at(centre_m),
                size_m,
                turn_deg,
                lean_deg,
            },
        }
    }

    /// The lengths that must be positive.
    pub(crate) fn lengths_m(&self) -> Vec<f64> {
        match *self {
            Self::Box { size_m, .. } => size_m.to_vec(),
            Self::Sphere { radius_m, .. } => vec![radius_m],
            Self::Cylinder {
                radius_m, height_m, ..
            } => vec![radius_m, height_m],
            Self::Rectangle { size_m, .. } => size_m.to_vec(),
        }
    }

    /// The numbers of the place, which may have any sign.
    pub(crate) fn placing(&self) -> Vec<f64> {
        match *self {
            Self::Box {
                base_m, turn_deg, ..
            } => [&base_m[..], &[turn_deg]].concat(),
            Self::Sphere { centre_m, .. } => centre_m.to_vec(),
            Self::Cylinder { base_m, .. } => base_m.to_vec(),
            Self::Rectangle {
                centre_m,
                turn_deg,
                lean_deg,
                ..
            } => [&centre_m[..], &[turn_deg, lean_deg]].concat(),
        }
    }
}
