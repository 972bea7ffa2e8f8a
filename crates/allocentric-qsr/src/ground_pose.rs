use crate::Sighting;

/// Whole micrometres of a length and whole nanoradians of an angle: a pose is stored in integers,
/// so that a map written and read again is the same map.
const UM: f64 = 1e6;
const NRAD: f64 = 1e9;

/// The farthest an observer may stand from the origin of the map, in metres.
const FARTHEST_M: f64 = 1e6;

/// Where an observer stands on the ground of the map, and which way it faces.
///
/// The map frame has x to the right and z forward of the first observer, in metres. The heading
/// is the turn to the left (counter-clockwise seen from above) from +z, in radians. The default
/// is the origin, facing +z: an observer that has not moved. A pose is exact, in whole
/// micrometres and nanoradians.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct GroundPose {
    x_um: i64,
    z_um: i64,
    heading_nrad: i64,
}

/// Three numbers that are no pose.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "no one stands at ({x_m}, {z_m}) m with heading {heading_rad} rad: \
     the numbers must be finite and within 1000 km and 1000 turns"
)]
pub struct NotAPose {
    /// Right of the origin, in metres.
    pub x_m: f64,
    /// Forward of the origin, in metres.
    pub z_m: f64,
    /// Turn to the left, in radians.
    pub heading_rad: f64,
}

impl GroundPose {
    /// A pose `x_m` to the right and `z_m` forward of the origin, turned left by `heading_rad`.
    ///
    /// # Errors
    /// [`NotAPose`] if a number is not finite or far out of range.
    pub fn new(x_m: f64, z_m: f64, heading_rad: f64) -> Result<Self, NotAPose> {
        let near = x_m.abs() <= FARTHEST_M && z_m.abs() <= FARTHEST_M;
        if near && heading_rad.abs() <= 1000.0 * std::f64::consts::TAU {
            Ok(Self {
                x_um: (x_m * UM).round() as i64,
                z_um: (z_m * UM).round() as i64,
                heading_nrad: (heading_rad * NRAD).round() as i64,
            })
        } else {
            Err(NotAPose {
                x_m,
                z_m,
                heading_rad,
            })
        }
    }

    /// Right of the origin, in metres.
    #[must_use]
    pub fn x_m(self) -> f64 {
        self.x_um as f64 / UM
    }

    /// Forward of the origin, in metres.
    #[must_use]
    pub fn z_m(self) -> f64 {
        self.z_um as f64 / UM
    }

    /// Turn to the left from +z, in radians.
    #[must_use]
    pub fn heading_rad(self) -> f64 {
        self.heading_nrad as f64 / NRAD
    }

    /// The bearing of a sighting in the map frame, in radians.
    pub(crate) fn map_bearing_rad(self, sighting: &Sighting) -> f64 {
        sighting.bearing_rad.rem_euclid(std::f64::consts::TAU) + self.heading_rad()
    }
}
