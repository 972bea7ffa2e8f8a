//! Questions of one robot to what all have seen.

use std::collections::BTreeSet;

use allocentric_qsr::{Answer, BadQuery, ObjectId, Observer, Query, SceneMemory, Unanswerable};

use crate::contradiction::{Contradiction, Witness};
use crate::{RobotId, SharedMap};

/// The most robots whose memory of one object is read for a question about it, those that saw it last.
const MOST_WITNESSES: usize = 4;

/// A question the map cannot answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoAnswer {
    /// The robot has reported nothing.
    #[error("robot `{0}` has reported nothing; it has no frame to answer in")]
    Robot(RobotId),
    /// The words are no question.
    #[error(transparent)]
    Words(#[from] BadQuery),
    /// Neither this robot nor one whose landmarks it shares knows.
    #[error(transparent)]
    Unknown(#[from] Unanswerable),
}

impl SharedMap {
    /// Answers a question of a robot, in its frame: from what it has seen itself, and beside it from what those have
    /// seen whom shared landmarks join to it, directly or through others.
    ///
    /// A question that names its objects reads the memories of the robots that saw them last; one that names
    /// none (`within`, `right of`, `between`, `free_path`) reads all.
    ///
    /// # Errors
    /// [`NoAnswer`] says what is unknown.
    pub fn ask(&self, robot: &RobotId, words: &str) -> Result<Answer, NoAnswer> {
        let query: Query = words.parse()?;
        let view = match named(&query) {
            Some(names) => self.view_of(robot, &names),
            None => self.view(robot),
        };
        let view = view.ok_or_else(|| NoAnswer::Robot(robot.clone()))?;
        Ok(view.ask(&query)?)
    }

    /// What a robot knows with the sightings of all whom landmarks join to it beside its own
    /// ([`SceneMemory::beside`]); `None` if it has reported nothing.
    #[must_use]
    pub fn view(&self, robot: &RobotId) -> Option<SceneMemory> {
        let own = &self.robots.get(robot)?.memory;
        let ways = self.roster.ways(robot, None);
        let others = ways.keys().filter(|other| **other != robot);
        Some(own.beside(others.map(|other| &self.robots[other].memory)))
    }

    /// As [`SharedMap::view`], but only with the robots that are needed to place these objects.
    #[must_use]
    pub fn view_of(&self, robot: &RobotId, objects: &[&ObjectId]) -> Option<SceneMemory> {
        let own = &self.robots.get(robot)?.memory;
        let mut wanted: BTreeSet<&RobotId> = BTreeSet::new();
        for object in objects {
            wanted.extend(self.witnesses(robot, object));
        }
        wanted.remove(robot);
        if wanted.is_empty() {
            return Some(own.clone());
        }
        let read = self.roster.between(robot, &wanted);
        Some(own.beside(read.into_iter().map(|other| &self.robots[other].memory)))
    }

    /// What every two robots that share landmarks contradict each other about, by robot and object.
    #[must_use]
    pub fn contradictions(&self) -> Vec<Contradiction> {
        let mut found = Vec::new();
        for (one, kept) in &self.robots {
            for other in self
                .roster
                .companions(one)
                .into_iter()
                .filter(|other| *other > one)
            {
                let agreement = kept.memory.agreement(&self.robots[other].memory);
                let witness = |robot: &RobotId, place_m, time_ms, is_gone| Witness {
                    robot: robot.clone(),
                    place_m,
                    time_ms,
                    is_gone,
                };
                let disputed = agreement.disputed.into_iter();
                found.extend(disputed.map(|dispute| Contradiction {
                    object: dispute.object,
                    one: witness(one, Some(dispute.here_m), dispute.here_time_ms, false),
                    other: witness(other, dispute.there_m, dispute.there_time_ms, false),
                    sigmas: dispute.sigmas,
                }));
                found.extend(agreement.gone.into_iter().map(|gone| {
                    let (here_ms, there_ms) = if gone.is_here {
                        (gone.gone_ms, gone.seen_ms)
                    } else {
                        (gone.seen_ms, gone.gone_ms)
                    };
                    Contradiction {
                        object: gone.object,
                        one: witness(one, Some(gone.here_m), here_ms, gone.is_here),
                        other: witness(other, Some(gone.there_m), there_ms, !gone.is_here),
                        sigmas: Some(gone.sigmas),
                    }
                }));
            }
        }
        found
    }

    /// The robots that saw an object last, newest first; the robot itself counts.
    fn witnesses(&self, robot: &RobotId, object: &ObjectId) -> Vec<&RobotId> {
        let mut seen: Vec<(u64, bool, &RobotId)> = self
            .roster
            .seen_by(object)
            .filter_map(|by| {
                let kept = self.robots[by].memory.object(object)?;
                Some((kept.last_time_ms, by == robot, by))
            })
            .collect();
        seen.sort_unstable_by(|a, b| b.cmp(a));
        seen.into_iter()
            .take(MOST_WITNESSES)
            .map(|(_, _, by)| by)
            .collect()
    }
}

/// The objects a question is about; `None` if it is about whatever is there.
pub(crate) fn named(query: &Query) -> Option<Vec<&ObjectId>> {
    match query {
        Query::Relation {
            of,
            from,
            seen_from: observer,
        } => {
            let mut names = vec![of, from];
            if let Observer::Object(name) = observer {
                names.push(name);
            }
            Some(names)
        }
        Query::LastSeen(object) | Query::Where(object) => Some(vec![object]),
        Query::Explain(of, from) => Some(vec![of, from]),
        Query::Which(_) | Query::Between(..) | Query::Reachable { .. } | Query::FreePath { .. } => {
            None
        }
    }
}
