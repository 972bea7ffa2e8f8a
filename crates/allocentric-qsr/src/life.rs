use std::fmt;

use serde::{Deserialize, Serialize};

/// Where in its life a remembered object is.
///
/// `Tentative -> Confirmed -> InView | OutOfView | Occluded -> Stale -> Missing -> Removed`. A sighting leads
/// back from anywhere; free space seen where the object should be leads on, and so does the object seen
/// elsewhere. Nothing else makes an object missing: one that is merely out of view stays as long as the
/// memory, stale where the memory trusts the world for so many looks only
/// ([`MemoryParams::trusted_looks`](crate::MemoryParams::trusted_looks)).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Life {
    /// Seen too few times to be believed.
    Tentative,
    /// Believed, in the view of the last look and not seen there, and nothing speaks against it:
    /// a hole in the measurement, or free space fewer times than it takes.
    Confirmed,
    /// Seen in the last look.
    InView,
    /// Outside the view of the last look, or in another map frame.
    OutOfView,
    /// Behind something in the last look.
    Occluded,
    /// Not seen for longer than the world is trusted to keep still: it was there, and may have been moved.
    Stale,
    /// Free space is where it should be, or it was seen elsewhere, too dimly to say where.
    Missing,
    /// Gone: a tombstone, which keeps the name, the last place and when it was given up.
    Removed,
}

impl Life {
    /// The word of files and the command line.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Tentative => "tentative",
            Self::Confirmed => "confirmed",
            Self::InView => "in_view",
            Self::OutOfView => "out_of_view",
            Self::Occluded => "occluded",
            Self::Stale => "stale",
            Self::Missing => "missing",
            Self::Removed => "removed",
        }
    }

    /// The words of sentences.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Tentative => "tentative",
            Self::Confirmed => "confirmed",
            Self::InView => "in view",
            Self::OutOfView => "out of view",
            Self::Occluded => "hidden",
            Self::Stale => "not seen for long",
            Self::Missing => "missing",
            Self::Removed => "removed",
        }
    }
}

impl fmt::Display for Life {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.label())
    }
}
