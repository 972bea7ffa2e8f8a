use std::collections::BTreeSet;

use allocentric_qsr::{ObjectId, Query};

use crate::roster::Roster;
use crate::shared_question::named;
use crate::{NoAnswer, RobotId};

/// Where several shards of one map meet: it knows which robots have seen which objects in which shard, and nothing of
/// where these are. A shard is a [`SharedMap`](crate::SharedMap) of some rooms, in a process of its own.
///
/// Each look goes to one shard, that of its room; a look without a pose, and a fact, goes to all, for they concern
/// all that a robot knows. A question goes where [`Concourse::route`] says.
///
/// ```
/// use common_ground::{Concourse, Route};
///
/// let mut concourse = Concourse::new(2);
/// for (shard, robot, object) in [(0, "a", "cup"), (0, "b", "cup"), (0, "a", "box"), (0, "b", "box"), (1, "b", "sofa")] {
///     concourse.saw(shard, &robot.into(), &object.into());
/// }
/// assert_eq!(concourse.route(&"a".into(), "where cup")?, Route::Shard(0));
/// // What b saw in the other shard is joined to a by what both have seen in this one.
/// let Route::Memories(robots) = concourse.route(&"a".into(), "where sofa")? else { panic!() };
/// assert_eq!(robots, ["a".into(), "b".into()].into());
/// # Ok::<(), common_ground::NoAnswer>(())
/// ```
#[derive(Clone, Debug)]
pub struct Concourse {
    shards: Vec<Roster>,
    /// All shards in one.
    all: Roster,
}

/// Who answers a question.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Route {
    /// The shard of this number, alone.
    Shard(usize),
    /// No shard alone: what all shards keep of these robots ([`SharedMap::part`](crate::SharedMap::part)), put
    /// together ([`SharedMap::together`](crate::SharedMap::together)).
    Memories(BTreeSet<RobotId>),
}

impl Concourse {
    /// The meeting of so many shards, none of which has anything.
    #[must_use]
    pub fn new(shards: usize) -> Self {
        Self {
            shards: vec![Roster::default(); shards],
            all: Roster::default(),
        }
    }

    /// Notes that the map of this shard has a robot's sighting of an object.
    ///
    /// # Panics
    /// If there is no shard of this number.
    pub fn saw(&mut self, shard: usize, robot: &RobotId, object: &ObjectId) {
        self.shards[shard].add(robot, object);
        self.all.add(robot, object);
    }

    /// Who answers a question of a robot.
    ///
    /// One that names its objects is for a shard alone if that shard knows the robot and the others know none of the
    /// objects. Its answer may lack what only robots of other shards could join, and then it says that it does not
    /// know: [`Concourse::across`] is what to ask next. A question that names no object goes across always.
    ///
    /// # Errors
    /// [`NoAnswer`] if the words are no question, or the robot is in no shard.
    pub fn route(&self, robot: &RobotId, words: &str) -> Result<Route, NoAnswer> {
        let query: Query = words.parse()?;
        let alone = named(&query).and_then(|names| {
            (0..self.shards.len()).find(|&shard| {
                let elsewhere = |(at, roster): (usize, &Roster)| {
                    at != shard
                        && names
                            .iter()
                            .any(|name| roster.seen_by(name).next().is_some())
                };
                self.shards[shard].knows(robot) && !self.shards.iter().enumerate().any(elsewhere)
            })
        });
        match alone {
            Some(shard) => Ok(Route::Shard(shard)),
            None => self.across(robot, words),
        }
    }

    /// The robots whose memories are needed to answer a question of this robot as one map of all shards would: all who
    /// saw what it names, all who join them to the robot, and the robot.
    ///
    /// # Errors
    /// As [`Concourse::route`].
    pub fn across(&self, robot: &RobotId, words: &str) -> Result<Route, NoAnswer> {
        let query: Query = words.parse()?;
        if !self.all.knows(robot) {
            return Err(NoAnswer::Robot(robot.clone()));
        }
        let mut needed: BTreeSet<&RobotId> = match named(&query) {
            Some(names) => {
                let seen = names.into_iter().flat_map(|name| self.all.seen_by(name));
                self.all.between(robot, &seen.collect())
            }
            None => self.all.ways(robot, None).into_keys().collect(),
        };
        needed.insert(robot);
        Ok(Route::Memories(needed.into_iter().cloned().collect()))
    }
}
