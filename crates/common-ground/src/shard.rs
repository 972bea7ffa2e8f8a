//! Parts of a map, and a map of parts.

use std::collections::BTreeSet;

use crate::{RobotId, SharedMap};

/// Maps that are no parts of one.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the shards of a map have one distance system and one set of parameters; these differ")]
pub struct NotOneMap;

impl SharedMap {
    /// What this map keeps of these robots, for questions across shards.
    #[must_use]
    pub fn part(&self, robots: &BTreeSet<RobotId>) -> Self {
        let kept = self.robots.iter();
        let kept = kept.filter(|(robot, _)| robots.contains(*robot));
        self.of_robots(kept.map(|(robot, kept)| (robot.clone(), kept.clone())))
    }

    /// This map and another shard's, as one: each robot's memories put together
    /// ([`SceneMemory::together`](allocentric_qsr::SceneMemory::together)), what it lost and what was refused added up.
    ///
    /// It answers as one map would that had taken the reports of both, if each object belongs to one shard and each
    /// look without a pose went to both. It is for questions: a report it takes in belongs to no shard.
    ///
    /// # Errors
    /// [`NotOneMap`] if the two were not made alike.
    pub fn together(&self, other: &Self) -> Result<Self, NotOneMap> {
        if self.reference != other.reference || self.params != other.params {
            return Err(NotOneMap);
        }
        let mut robots = self.robots.clone();
        for (robot, there) in &other.robots {
            match robots.get_mut(robot) {
                None => {
                    robots.insert(robot.clone(), there.clone());
                }
                Some(here) => {
                    here.last = here.last.max(there.last);
                    here.lost += there.lost;
                    here.refused += there.refused;
                    here.memory = here.memory.together(&there.memory);
                }
            }
        }
        Ok(self.of_robots(robots))
    }
}
