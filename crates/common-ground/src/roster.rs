use std::collections::{BTreeMap, BTreeSet, VecDeque};

use allocentric_qsr::ObjectId;

use crate::RobotId;

/// Two landmarks join two frames.
const LANDMARKS: usize = 2;

/// Which robots have seen which objects, gone things included: by what robots may be joined, and who is asked about
/// an object. It holds names and nothing else.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Roster {
    by_object: BTreeMap<ObjectId, BTreeSet<RobotId>>,
    by_robot: BTreeMap<RobotId, BTreeSet<ObjectId>>,
}

impl Roster {
    /// Notes that a robot has seen an object.
    pub(crate) fn add(&mut self, robot: &RobotId, object: &ObjectId) {
        if self.has(robot, object) {
            return;
        }
        let seen = self.by_robot.entry(robot.clone()).or_default();
        seen.insert(object.clone());
        let by = self.by_object.entry(object.clone()).or_default();
        by.insert(robot.clone());
    }

    pub(crate) fn has(&self, robot: &RobotId, object: &ObjectId) -> bool {
        let seen = self.by_robot.get(robot);
        seen.is_some_and(|seen| seen.contains(object))
    }

    /// Whether this robot has seen anything.
    pub(crate) fn knows(&self, robot: &RobotId) -> bool {
        self.by_robot.contains_key(robot)
    }

    /// The robots that have seen an object, by name.
    pub(crate) fn seen_by(&self, object: &ObjectId) -> impl Iterator<Item = &RobotId> {
        self.by_object.get(object).into_iter().flatten()
    }

    /// The other robots that share landmarks with this one.
    pub(crate) fn companions(&self, robot: &RobotId) -> BTreeSet<&RobotId> {
        let mut shared: BTreeMap<&RobotId, usize> = BTreeMap::new();
        for object in self.by_robot.get(robot).into_iter().flatten() {
            for other in self.seen_by(object) {
                *shared.entry(other).or_default() += 1;
            }
        }
        let enough = shared.into_iter().filter(|(_, count)| *count >= LANDMARKS);
        enough
            .map(|(other, _)| other)
            .filter(|other| *other != robot)
            .collect()
    }

    /// From each robot that landmarks may join to this one, the next on the shortest way there, the robot itself for
    /// itself; the search ends where all that are wanted are reached. None, if the robot has seen nothing.
    pub(crate) fn ways(
        &self,
        robot: &RobotId,
        wanted: Option<&BTreeSet<&RobotId>>,
    ) -> BTreeMap<&RobotId, &RobotId> {
        let Some((start, _)) = self.by_robot.get_key_value(robot) else {
            return BTreeMap::new();
        };
        let mut missing = wanted.cloned();
        let mut is_last = |met: &RobotId| {
            missing.as_mut().is_some_and(|missing| {
                missing.remove(met);
                missing.is_empty()
            })
        };
        let mut ways = BTreeMap::from([(start, start)]);
        let mut reached = VecDeque::from([start]);
        if is_last(start) {
            return ways;
        }
        while let Some(at) = reached.pop_front() {
            for next in self.companions(at) {
                if ways.contains_key(next) {
                    continue;
                }
                ways.insert(next, at);
                if is_last(next) {
                    return ways;
                }
                reached.push_back(next);
            }
        }
        ways
    }

    /// All robots on the shortest ways from this robot to those wanted, as far as they are reached; the robot itself is
    /// not among them.
    pub(crate) fn between<'a>(
        &'a self,
        robot: &RobotId,
        wanted: &BTreeSet<&RobotId>,
    ) -> BTreeSet<&'a RobotId> {
        let ways = self.ways(robot, Some(wanted));
        let mut met = BTreeSet::new();
        for witness in wanted {
            let mut at = ways.get_key_value(*witness);
            while let Some((&here, &before)) = at
                && here != robot
            {
                met.insert(here);
                at = ways.get_key_value(before);
            }
        }
        met
    }
}
