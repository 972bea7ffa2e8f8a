use std::fmt;

use allocentric_qsr::ObjectId;
use serde::{Deserialize, Serialize};

use crate::RobotId;

/// An object that two robots have in different places.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Contradiction {
    /// The object.
    pub object: ObjectId,
    /// The one robot, in whose frame both places are told.
    pub one: Witness,
    /// The other.
    pub other: Witness,
    /// How many standard errors the two places lie apart; `None` if too few objects agree to say.
    pub sigmas: Option<f64>,
}

/// Who saw it, where and when.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Witness {
    /// Who.
    pub robot: RobotId,
    /// Where, `[right, forward]` in the frame of the first witness, in metres; `None` if the frames cannot be joined.
    pub place_m: Option<[f64; 2]>,
    /// When it saw it last, in milliseconds of its clock.
    pub time_ms: u64,
}

impl fmt::Display for Contradiction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            object, one, other, ..
        } = self;
        write!(
            f,
            "{object}: {} saw it {one} and {} saw it {other}",
            one.robot, other.robot
        )?;
        match self.sigmas {
            Some(sigmas) => write!(f, ", {sigmas:.1} standard errors apart"),
            None => write!(f, ", and too little agrees to say where that is"),
        }
    }
}

impl fmt::Display for Witness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some([right, forward]) = self.place_m {
            write!(f, "at ({right:.2}, {forward:.2}) m ")?;
        }
        write!(f, "at {} ms", self.time_ms)
    }
}
