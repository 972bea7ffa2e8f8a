use crate::ObjectId;

/// A place in the robot's frame at which a look is asked for evidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AskedPlace {
    /// To the right of the robot, in metres.
    pub right_m: f64,
    /// Ahead of the robot, in metres.
    pub forward_m: f64,
    /// Above the ground the sightings are told on, in metres; 0 where nobody said.
    pub height_m: f64,
    /// How far around this point the object may reach, in metres: its radius and three standard
    /// errors of its place. Free space counts only where no such object can be anywhere in that.
    pub within_m: f64,
    /// The part of `within_m` that is the radius of the object itself, in metres; 0 where it is not
    /// known, or where ground is asked about and not an object.
    pub radius_m: f64,
}

/// What a look says of a place where nothing was reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Evidence {
    /// A measured surface lies clearly behind the place: the place is free.
    FreeSpace,
    /// A measured surface lies clearly in front of it.
    Occluded,
    /// No valid depth there: a hole, no texture, seen by one eye only. It says nothing.
    NoEvidence,
    /// On the lines of sight that meet the place stands a thing that is seen and whose distance is not
    /// known: it may stand there, so that ground seen free before is so no longer. Of a remembered object
    /// it says nothing.
    Taken,
    /// The object itself is seen, and not there: one look is enough to give its place up. Only
    /// [`LookEvidence::of`] says so.
    Elsewhere,
    /// The look does not reach there.
    OutOfView,
}

/// A look that can be asked what it shows at a place.
///
/// A depth map answers by projecting the place and comparing depths; closures `Fn(AskedPlace) ->
/// Evidence` are looks too, for tests and for robots with other sensors.
pub trait LookEvidence {
    /// What the look shows at this place.
    fn at(&self, place: AskedPlace) -> Evidence;

    /// What the look shows at the remembered place of an object that it has not reported. A look that
    /// knows objects again where it cannot tell how far they are answers [`Evidence::Elsewhere`]; for
    /// all others it is what they show at the place.
    fn of(&self, object: &ObjectId, place: AskedPlace) -> Evidence {
        let _ = object;
        self.at(place)
    }
}

impl<F: Fn(AskedPlace) -> Evidence> LookEvidence for F {
    fn at(&self, place: AskedPlace) -> Evidence {
        self(place)
    }
}

/// A look that shows its sightings and says nothing of any other place.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoDepth;

impl LookEvidence for NoDepth {
    fn at(&self, _: AskedPlace) -> Evidence {
        Evidence::NoEvidence
    }
}
