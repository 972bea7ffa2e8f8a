use std::fmt;

use dorsal::allocentric_qsr::ObjectId;

/// A point to look at, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Fixation {
    /// The point, in the observer frame: right, down, forward, in metres.
    pub point_m: [f64; 3],
    /// Why there.
    pub why: Why,
}

/// Why the head looks somewhere.
#[derive(Clone, Debug, PartialEq)]
pub enum Why {
    /// It shows most of the ground that no look has measured.
    LeastKnown {
        /// The part of the field that is open and that it shows.
        share: f64,
    },
    /// Nothing in the memory is less sure than the place of this object.
    LeastSure {
        /// The object.
        object: ObjectId,
        /// One standard error of its place, in metres.
        sigma_m: f64,
    },
    /// It is seen, and no look has told how far away it is: eyes that fixate it can.
    Unplaced {
        /// The object.
        object: ObjectId,
    },
    /// The scan ends, and from here most is seen again that was not seen for long: something may have been
    /// moved meanwhile.
    LongUnseen {
        /// The object that is fixated.
        object: ObjectId,
        /// How many looks have not shown it.
        looks: u64,
    },
    /// Somebody asks for the hand's way to an object, and this piece of it is not known to be free.
    OnTheWay {
        /// The object.
        to: ObjectId,
    },
    /// It shows one object and not the other: the paper's Figure 12.
    Without {
        /// In view.
        shown: ObjectId,
        /// Out of view.
        hidden: ObjectId,
    },
}

impl Why {
    /// The object that the look is to place, if it is for one.
    pub(crate) const fn aimed_at(&self) -> Option<&ObjectId> {
        match self {
            Self::LeastSure { object, .. }
            | Self::Unplaced { object }
            | Self::LongUnseen { object, .. } => Some(object),
            Self::LeastKnown { .. } | Self::OnTheWay { .. } | Self::Without { .. } => None,
        }
    }
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::LeastKnown { share } => {
                write!(
                    f,
                    "least known: {:.0} % of the field to find out",
                    100.0 * share
                )
            }
            Self::LeastSure { object, sigma_m } => {
                write!(f, "least sure: {object}, within {:.1} cm", 100.0 * sigma_m)
            }
            Self::Unplaced { object } => write!(f, "seen, but how far: {object}"),
            Self::LongUnseen { object, looks } => {
                write!(
                    f,
                    "is it still there: {object}, not placed by {looks} looks"
                )
            }
            Self::OnTheWay { to } => write!(f, "asked for: the hand's way to {to}"),
            Self::Without { shown, hidden } => write!(f, "at {shown}, with {hidden} out of view"),
        }
    }
}
