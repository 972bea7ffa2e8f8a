use std::fmt;

use serde::{Deserialize, Serialize};

/// Which calculus an answer comes from. Every result carries it.
///
/// As data `"published"` or `"sound"`.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
#[serde(rename_all = "snake_case")]
pub enum Mode {
    /// The paper's answers, cell by cell. They can leave out what is true: a distance of 119 cm
    /// and one of 121 cm in opposite directions are 2 cm apart, where Table 3 says `fd`.
    Published,
    /// Answers that contain every configuration the premises allow.
    #[default]
    Sound,
}

impl Mode {
    /// The word of files and the command line.
    #[must_use]
    pub const fn label(self) -> &'static str {
        match self {
            Self::Published => "published",
            Self::Sound => "sound",
        }
    }
}

impl fmt::Display for Mode {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.label())
    }
}
