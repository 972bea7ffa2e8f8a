use serde::{Deserialize, Serialize};

use crate::qualitative_scene::QualifyParams;
use crate::sighting::BadSighting;

/// How a memory believes, doubts and forgets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemoryParams {
    /// How numbers become symbols.
    pub qualify: QualifyParams,
    /// Sightings that make a tentative object a confirmed one.
    pub confirm_after: u32,
    /// Looks in a row without a sighting in between that show free space where an object should
    /// be, until it is missing; a tentative one is removed then.
    pub missing_after: u32,
    /// Such looks until a missing object is removed.
    pub removed_after: u32,
    /// How many standard errors from its place an object may be seen and still be where it was.
    pub gate_sigmas: u32,
    /// How much an object may creep between two sightings, in micrometres: what keeps a place
    /// from becoming surer than any sensor.
    pub creep_um: u32,
    /// What to do with a look or a fact that contradicts the memory.
    pub policy: Policy,
    /// The side of the squares in which seen free ground is kept, in millimetres.
    pub cell_mm: u32,
    /// How far around the robot free ground is looked for, in millimetres; 0 keeps none.
    pub ground_mm: u32,
    /// How high above the ground a square is asked whether it is free, in millimetres. The ball
    /// asked about holds the square, with nine tenths of its side for a radius, so this must be more,
    /// for a camera that looks down to see the ground behind it; what is lower than the ball is noticed
    /// as an object or not at all.
    #[serde(default = "above_ground_mm")]
    pub above_ground_mm: u32,
    /// For how many looks the world is trusted to keep still; 0 for ever. An object that was not seen for
    /// longer is [`Life::Stale`](crate::Life::Stale), and ground that was not is no longer called free: a memory
    /// cannot know what was moved where nobody looked.
    #[serde(default)]
    pub trusted_looks: u32,
    /// The most squares kept.
    pub most_cells: usize,
    /// The most tombstones kept; the oldest go first.
    pub most_tombstones: usize,
    /// The most changes kept for [`SceneMemory::changes`](crate::SceneMemory::changes).
    pub most_changes: usize,
}

/// What a memory does with what contradicts it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Policy {
    /// It comes back as a value with its premises, and the memory stays as it was.
    #[default]
    Refuse,
    /// Seeing is believing: an object seen elsewhere has moved, and a told fact that what is seen
    /// refutes is retracted. A look in which two or more known objects are seen and none is where
    /// it was is refused all the same: the pose is wrong, not the world.
    Follow,
}

impl Default for MemoryParams {
    fn default() -> Self {
        Self {
            qualify: QualifyParams::default(),
            confirm_after: 2,
            missing_after: 3,
            removed_after: 6,
            gate_sigmas: 4,
            creep_um: 1000,
            policy: Policy::Refuse,
            cell_mm: 100,
            ground_mm: 2500,
            above_ground_mm: above_ground_mm(),
            trusted_looks: 0,
            most_cells: 100_000,
            most_tombstones: 1000,
            most_changes: 1000,
        }
    }
}

/// A ball around a square of the default size does not touch the ground.
const fn above_ground_mm() -> u32 {
    100
}

/// Parameters by which nothing can be believed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BadMemoryParams {
    /// The parameters of qualification cannot be.
    #[error(transparent)]
    Qualify(#[from] BadSighting),
    /// A count that must be positive is zero, or they are out of order.
    #[error(
        "objects must be confirmed after 1 sighting at least, and removed no earlier than missing"
    )]
    Life,
    /// A gate, a creep or a square of no size.
    #[error("the gate, the creep and the side of a square must be positive")]
    Size,
    /// A square kilometre of squares is more than a robot walks.
    #[error(
        "free ground {ground_mm} mm around in squares of {cell_mm} mm: at most 200 squares to each side"
    )]
    Ground {
        /// How far.
        ground_mm: u32,
        /// How fine.
        cell_mm: u32,
    },
}

impl MemoryParams {
    pub(crate) fn check(self) -> Result<Self, BadMemoryParams> {
        self.qualify.check()?;
        let counts = [self.confirm_after, self.missing_after];
        if counts.contains(&0) || self.removed_after < self.missing_after {
            return Err(BadMemoryParams::Life);
        }
        if [self.gate_sigmas, self.creep_um, self.cell_mm].contains(&0) {
            return Err(BadMemoryParams::Size);
        }
        if self.ground_mm / self.cell_mm > 200 {
            return Err(BadMemoryParams::Ground {
                ground_mm: self.ground_mm,
                cell_mm: self.cell_mm,
            });
        }
        Ok(self)
    }
}
