use serde::{Deserialize, Serialize};

use crate::depth_reference::DepthReference;
use crate::place::{PlaceRecord, owned_labels};
use crate::{Mode, ObjectId, OrientationSet, Place, Places};

/// Where one object is with respect to another: `to` at `from`, against the direction from the
/// observer to `from`.
///
/// `front_left` therefore means beyond `from` and to its left, as the observer sees it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Relation {
    /// The object the relation is told from.
    pub from: ObjectId,
    /// The object that is placed.
    pub to: ObjectId,
    /// What may hold.
    pub places: Places,
    /// What a person reads, where positions were measured; inference alone has no best guess.
    pub read: Option<Place>,
    /// The calculus that says so.
    pub mode: Mode,
    /// Why.
    pub reason: Reason,
}

/// Why a relation holds: what it was measured or composed from.
///
/// As data `{"by": "measured", "looks": [1, 1]}` or
/// `{"by": "composed", "look": 1, "through": ["cup"]}`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "by", rename_all = "snake_case")]
pub enum Reason {
    /// From the intervals around two measured positions.
    Measured {
        /// The looks in which `from` and `to` were last seen, counted from 1; a scene that is
        /// not in a map is look 1.
        looks: [u64; 2],
    },
    /// From the composition of relations.
    Composed {
        /// The look that shows both, whose two sightings CASE 3 composes; `None` if no look
        /// shows both.
        look: Option<u64>,
        /// The objects through which CASE 1 narrows the relation, in the order of the
        /// narrowing. The premises are the inferred relations of each with both ends.
        through: Vec<ObjectId>,
    },
}

/// A relation as data, with short labels: `{"from": "cup", "to": "box", "depth": ["vc"],
/// "orientation": ["fl", "sf"], "read": {"depth": "vc", "orientation": "fl"}, "mode": "sound",
/// "reason": {..}}`. Depths come nearest first, orientations in the paper's order; `read` is
/// `null` where nothing was measured.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct RelationRecord {
    /// The object the relation is told from.
    pub from: ObjectId,
    /// The object that is placed.
    pub to: ObjectId,
    /// The short labels of the distance classes that may hold.
    pub depth: Vec<String>,
    /// The orientations that may hold.
    pub orientation: OrientationSet,
    /// What a person reads.
    pub read: Option<PlaceRecord>,
    /// The calculus that says so.
    pub mode: Mode,
    /// Why.
    pub reason: Reason,
}

impl Relation {
    /// The relation in the labels of its reference system.
    ///
    /// # Panics
    /// If a class is of a larger system.
    #[must_use]
    pub fn record(&self, reference: &DepthReference) -> RelationRecord {
        RelationRecord {
            from: self.from.clone(),
            to: self.to.clone(),
            depth: owned_labels(reference, self.places.depth),
            orientation: self.places.orientation,
            read: self.read.map(|place| place.record(reference)),
            mode: self.mode,
            reason: self.reason.clone(),
        }
    }
}
