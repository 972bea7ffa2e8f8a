//! Questions of one robot to what all have seen.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use allocentric_qsr::{Answer, BadQuery, ObjectId, Observer, Query, SceneMemory, Unanswerable};

use crate::contradiction::{Contradiction, Witness};
use crate::{RobotId, SharedMap};

/// Two landmarks join two frames.
const LANDMARKS: usize = 2;

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
        let ways = self.ways(robot, |_| false);
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
        let missing = std::cell::RefCell::new(wanted.clone());
        let ways = self.ways(robot, |reached| {
            missing.borrow_mut().remove(reached);
            missing.borrow().is_empty()
        });
        let mut read: BTreeSet<&RobotId> = BTreeSet::new();
        for witness in wanted {
            let mut at = witness;
            while at != robot
                && let Some(before) = ways.get(at)
            {
                read.insert(at);
                at = before;
            }
        }
        Some(own.beside(read.into_iter().map(|other| &self.robots[other].memory)))
    }

    /// What every two robots that share landmarks contradict each other about, by robot and object.
    #[must_use]
    pub fn contradictions(&self) -> Vec<Contradiction> {
        let mut found = Vec::new();
        for (one, kept) in &self.robots {
            for other in self
                .companions(one)
                .into_iter()
                .filter(|other| *other > one)
            {
                let agreement = kept.memory.agreement(&self.robots[other].memory);
                found.extend(
                    agreement
                        .disputed
                        .into_iter()
                        .map(|disputed| Contradiction {
                            object: disputed.object,
                            one: Witness {
                                robot: one.clone(),
                                place_m: Some(disputed.here_m),
                                time_ms: disputed.here_time_ms,
                            },
                            other: Witness {
                                robot: other.clone(),
                                place_m: disputed.there_m,
                                time_ms: disputed.there_time_ms,
                            },
                            sigmas: disputed.sigmas,
                        }),
                );
            }
        }
        found
    }

    /// The robots that saw an object last, newest first; the robot itself counts.
    fn witnesses(&self, robot: &RobotId, object: &ObjectId) -> Vec<&RobotId> {
        let Some(seen_by) = self.seen_by.get(object) else {
            return Vec::new();
        };
        let mut seen: Vec<(u64, bool, &RobotId)> = seen_by
            .iter()
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

    /// The robots that share landmarks with this one.
    fn companions(&self, robot: &RobotId) -> BTreeSet<&RobotId> {
        let mut shared: BTreeMap<&RobotId, usize> = BTreeMap::new();
        let objects = self.robots[robot].memory.objects();
        for by in objects.filter_map(|(name, _)| self.seen_by.get(name)) {
            for other in by {
                *shared.entry(other).or_default() += 1;
            }
        }
        let enough = shared.into_iter().filter(|(_, count)| *count >= LANDMARKS);
        enough
            .map(|(other, _)| other)
            .filter(|other| *other != robot)
            .collect()
    }

    /// From each robot that landmarks may join to this one, the next on the shortest way there; the search ends where
    /// `found` says that enough are reached.
    fn ways(
        &self,
        robot: &RobotId,
        found: impl Fn(&RobotId) -> bool,
    ) -> BTreeMap<&RobotId, &RobotId> {
        let Some((start, _)) = self.robots.get_key_value(robot) else {
            return BTreeMap::new();
        };
        let mut ways = BTreeMap::from([(start, start)]);
        let mut reached = VecDeque::from([start]);
        while let Some(at) = reached.pop_front() {
            for next in self.companions(at) {
                if !ways.contains_key(next) {
                    ways.insert(next, at);
                    if found(next) {
                        return ways;
                    }
                    reached.push_back(next);
                }
            }
        }
        ways
    }
}

/// The objects a question is about; `None` if it is about whatever is there.
fn named(query: &Query) -> Option<Vec<&ObjectId>> {
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
