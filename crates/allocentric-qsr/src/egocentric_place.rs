use std::f64::consts::FRAC_PI_2;

use serde::{Deserialize, Serialize};

use crate::depth_reference::DepthReference;
use crate::place::{PlaceRecord, owned_labels};
use crate::{Mode, ObjectId, Orientation, OrientationSet, Place, Places};

/// Where an object is with respect to the observer, who faces front.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EgocentricPlace {
    /// The object.
    pub object: ObjectId,
    /// What may hold within the errors of the measurement.
    pub places: Places,
    /// What a person reads: the class of the estimated distance, and a ray where the estimated
    /// bearing is within the reading tolerance of it.
    pub read: Place,
    /// The calculus that says so.
    pub mode: Mode,
}

/// An egocentric place as data, with short labels: `{"object": "cup", "depth": ["c"],
/// "orientation": ["fl", "sf", "fr"], "read": {"depth": "c", "orientation": "sf"},
/// "mode": "sound"}`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EgocentricRecord {
    /// The object.
    pub object: ObjectId,
    /// The short labels of the distance classes that may hold, nearest first.
    pub depth: Vec<String>,
    /// The orientations that may hold, in the paper's order.
    pub orientation: OrientationSet,
    /// What a person reads.
    pub read: PlaceRecord,
    /// The calculus that says so.
    pub mode: Mode,
}

impl EgocentricPlace {
    /// The place in the labels of its reference system.
    ///
    /// # Panics
    /// If a class is of a larger system.
    #[must_use]
    pub fn record(&self, reference: &DepthReference) -> EgocentricRecord {
        EgocentricRecord {
            object: self.object.clone(),
            depth: owned_labels(reference, self.places.depth),
            orientation: self.places.orientation,
            read: self.read.record(reference),
            mode: self.mode,
        }
    }
}

/// What a person reads of an offset `[ahead, leftward]` in metres.
pub(crate) fn read_offset(
    [ahead, leftward]: [f64; 2],
    reference: &DepthReference,
    tolerance_rad: f64,
) -> Place {
    let distance = ahead.hypot(leftward);
    let orientation = if distance > 0.0 {
        Orientation::read(FRAC_PI_2 + leftward.atan2(ahead), tolerance_rad)
    } else {
        Ok(Orientation::None)
    };
    Place {
        depth: reference.class_of(distance),
        // Offsets of finite positions have finite angles.
        orientation: orientation.unwrap_or(Orientation::None),
    }
}

/// What a person reads of `to` at `from`, both `[ahead, leftward]` of the observer in metres; an
/// object at the observer itself gives no direction.
pub(crate) fn read_between(
    from: [f64; 2],
    to: [f64; 2],
    reference: &DepthReference,
    tolerance_rad: f64,
) -> Place {
    let between = [to[0] - from[0], to[1] - from[1]];
    let away = from[0].hypot(from[1]);
    let place = read_offset(between, reference, tolerance_rad);
    if away == 0.0 {
        return Place {
            orientation: Orientation::None,
            ..place
        };
    }
    let front = from.map(|part| part / away);
    let beyond = between[0] * front[0] + between[1] * front[1];
    let leftward = between[1] * front[0] - between[0] * front[1];
    Place {
        depth: place.depth,
        ..read_offset([beyond, leftward], reference, tolerance_rad)
    }
}
