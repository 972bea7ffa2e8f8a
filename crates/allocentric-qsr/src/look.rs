use std::collections::BTreeSet;

use crate::ObjectId;
use crate::robot_pose::RobotPose;
use crate::sighting::{BadSighting, Sighting};

/// One look of the robot: when, from where, and what it shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// When it was taken, in milliseconds of the caller's clock; never before the last look.
    pub time_ms: u64,
    /// Where from.
    pub pose: PoseKnowledge,
    /// What it shows. None is a look too: it may show that places are free.
    pub observations: Vec<Observation>,
}

/// What a robot knows of its own place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PoseKnowledge {
    /// It stands there in the present map frame.
    Known(RobotPose),
    /// It lost its pose. A new map frame opens with the robot at its origin, facing +z; what is
    /// known in earlier frames stays there.
    Lost,
}

/// A sighting, with what is known of the size of the thing.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// What is seen, and where.
    pub sighting: Sighting,
    /// The radius of the circle on the ground it stands in, in millimetres; 0 is a point.
    pub radius_mm: u32,
    /// How high above the ground its middle is, in millimetres, for the evidence of later looks.
    pub height_mm: i32,
}

impl From<Sighting> for Observation {
    /// A thing without extent.
    fn from(sighting: Sighting) -> Self {
        Self {
            sighting,
            radius_mm: 0,
            height_mm: 0,
        }
    }
}

impl Look {
    /// Whether every sighting shows something, and each object once.
    pub(crate) fn check(&self) -> Result<(), BadSighting> {
        let mut names: BTreeSet<&ObjectId> = BTreeSet::new();
        for observation in &self.observations {
            observation.sighting.check()?;
            if !names.insert(&observation.sighting.object) {
                return Err(BadSighting::Twice(observation.sighting.object.clone()));
            }
        }
        Ok(())
    }
}
