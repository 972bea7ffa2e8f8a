use serde::{Deserialize, Serialize};

use crate::depth_reference::DepthReference;
use crate::{Depth, DepthSet, Orientation, OrientationSet};

/// One distance class and one orientation: what a person reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Place {
    /// The distance class.
    pub depth: Depth,
    /// The orientation.
    pub orientation: Orientation,
}

/// The distance classes and the orientations that may hold, each on its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Places {
    /// The distance classes that may hold.
    pub depth: DepthSet,
    /// The orientations that may hold.
    pub orientation: OrientationSet,
}

/// A place as data: `{"depth": "vc", "orientation": "fl"}`, short labels.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct PlaceRecord {
    /// The short label of the distance class.
    pub depth: String,
    /// The short label of the orientation.
    pub orientation: Orientation,
}

impl Place {
    /// The place in the labels of its reference system.
    ///
    /// # Panics
    /// If the class is of a larger system.
    #[must_use]
    pub fn record(self, reference: &DepthReference) -> PlaceRecord {
        PlaceRecord {
            depth: reference.short(self.depth).to_owned(),
            orientation: self.orientation,
        }
    }
}

impl Places {
    /// Every place: nothing is known.
    #[must_use]
    pub fn all(reference: &DepthReference) -> Self {
        Self {
            depth: reference.all(),
            orientation: OrientationSet::ALL,
        }
    }

    /// Whether this place may hold.
    #[must_use]
    pub fn contains(self, place: Place) -> bool {
        self.depth.contains(place.depth) && self.orientation.contains(place.orientation)
    }
}

/// The short labels of a set, owned by a record.
pub(crate) fn owned_labels(reference: &DepthReference, depths: DepthSet) -> Vec<String> {
    let labels = reference.labels(depths).into_iter();
    labels.map(str::to_owned).collect()
}
