use allocentric_qsr::{Change, Look, PoseKnowledge, Refused, SceneMemory};

use crate::{DepthEvidence, Dorsal, Names, Percept, observations};

/// When and from where a percept was had: what a memory must know beside it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stand {
    /// When, in milliseconds of the caller's clock; never before the last look.
    pub time_ms: u64,
    /// Where the observer stands on the ground of the map.
    pub pose: PoseKnowledge,
    /// How far below the eyes the ground lies on which the objects stand, in metres: the floor, or
    /// the top of a table.
    pub eyes_above_ground_m: f64,
}

impl Dorsal {
    /// Takes a percept into a memory: its objects as sightings, its depth map as the evidence for
    /// everything it does not show. Says what became different.
    ///
    /// # Errors
    /// [`Refused`] says why; the memory stays as it was.
    pub fn remember(
        &self,
        memory: &mut SceneMemory,
        percept: &Percept,
        names: &Names,
        stand: Stand,
    ) -> Result<Vec<Change>, Refused> {
        let Stand {
            time_ms,
            pose,
            eyes_above_ground_m,
        } = stand;
        let seen = observations(&percept.egocentric, names, &self.rig, eyes_above_ground_m);
        let look = Look {
            time_ms,
            pose,
            observations: seen.collect(),
        };
        let evidence = DepthEvidence::new(
            &percept.depth,
            &self.rig,
            eyes_above_ground_m,
            self.locating.disparity_sigma_px,
        );
        memory.observe(&look, &evidence)
    }
}
