use crate::{DepthSet, Orientation, OrientationSet, Place, Places};

/// The places that may hold, orientation and distance class jointly.
///
/// The sound calculus knows that some orientations go only with some distances;
/// [`PlaceSet::places`] forgets which.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PlaceSet {
    depths: [DepthSet; 9],
}

impl PlaceSet {
    /// Whether this place may hold.
    #[must_use]
    pub fn contains(&self, place: Place) -> bool {
        self.depths[place.orientation as usize].contains(place.depth)
    }

    /// The classes that may hold where the orientation is this one.
    #[must_use]
    pub fn at(&self, orientation: Orientation) -> DepthSet {
        self.depths[orientation as usize]
    }

    /// Whether no place may hold.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.depths.iter().all(|depths| depths.is_empty())
    }

    /// The classes and the orientations, each on its own.
    #[must_use]
    pub fn places(&self) -> Places {
        let orientations = Orientation::ALL.into_iter();
        Places {
            depth: orientations
                .clone()
                .map(|o| self.at(o))
                .fold(DepthSet::EMPTY, |all, some| all | some),
            orientation: orientations
                .filter(|&o| !self.at(o).is_empty())
                .collect::<OrientationSet>(),
        }
    }

    /// Lets these classes hold with this orientation too.
    pub(crate) fn add(&mut self, orientation: Orientation, depths: DepthSet) {
        self.depths[orientation as usize] |= depths;
    }
}
