use std::fmt;

use allocentric_qsr::ObjectId;
use serde::{Deserialize, Serialize};

use crate::RobotId;

/// An object that two robots have in different places, or that is gone for the one from where the other has it.
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

/// Who saw it, where and when; or who found it gone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Witness {
    /// Who.
    pub robot: RobotId,
    /// Where, `[right, forward]` in the frame of the first witness, in metres; `None` if the frames cannot be joined.
    /// Of what is gone, where it was.
    pub place_m: Option<[f64; 2]>,
    /// When it saw it last, in milliseconds of its clock; of what is gone, when it first saw free space there.
    pub time_ms: u64,
    /// Whether it found it gone.
    #[serde(default)]
    pub is_gone: bool,
}

impl fmt::Display for Contradiction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            object, one, other, ..
        } = self;
        write!(
            f,
            "{object}: {} {one} and {} {other}",
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
        f.write_str(if self.is_gone {
            "found it gone "
        } else {
            "saw it "
        })?;
        if let Some([right, forward]) = self.place_m {
            let from = if self.is_gone { "from" } else { "at" };
            write!(f, "{from} ({right:.2}, {forward:.2}) m ")?;
        }
        write!(f, "at {} ms", self.time_ms)
    }
}
