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
