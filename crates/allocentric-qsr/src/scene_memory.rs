use std::collections::{BTreeMap, BTreeSet, VecDeque};

use crate::ObjectId;
use crate::depth_reference::DepthReference;
use crate::ground_estimate::GroundEstimate;
use crate::life::Life;
use crate::memory_change::Dated;
use crate::memory_object::MemoryObject;
use crate::memory_params::{BadMemoryParams, MemoryParams};
use crate::robot_pose::RobotPose;
use crate::told_fact::ToldFact;

/// What the robot remembers of the things around it, look after look.
///
/// Every object keeps a position with its covariance in each map frame that has seen it, and a
/// [`Life`]. Relations are qualified from positions when asked for. Two landmarks that two frames
/// have in common join them: what the one has seen is then known in the other, with the errors of
/// that. Told facts, and pairs that nothing joins, go through a
/// [`ConstraintNetwork`](crate::ConstraintNetwork). Nothing contradictory is ever taken in:
/// what contradicts comes back as a value, and the memory stays as it was unless its [`Policy`](crate::Policy)
/// says otherwise.
///
/// It opens no file and reads no clock: [`SceneMemory::to_json`] gives the text of a snapshot, and
/// every look brings its time.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneMemory {
    pub(crate) reference: DepthReference,
    pub(crate) params: MemoryParams,
    pub(crate) looks: u64,
    pub(crate) time_ms: u64,
    pub(crate) frame: u32,
    pub(crate) robot: RobotPose,
    pub(crate) objects: BTreeMap<ObjectId, MemoryObject>,
    pub(crate) facts: Vec<ToldFact>,
    pub(crate) changes: VecDeque<Dated>,
    /// Squares of ground of the present frame seen free, and in which look last, by place.
    pub(crate) free: BTreeMap<(i32, i32), u64>,
}

impl SceneMemory {
    /// A memory of nothing, the robot at the origin of map frame 0.
    ///
    /// # Errors
    /// [`BadMemoryParams`] says which parameter cannot be.
    pub fn new(reference: &DepthReference, params: MemoryParams) -> Result<Self, BadMemoryParams> {
        Ok(Self {
            reference: reference.clone(),
            params: params.check()?,
            looks: 0,
            time_ms: 0,
            frame: 0,
            robot: RobotPose::default(),
            objects: BTreeMap::new(),
            facts: Vec::new(),
            changes: VecDeque::new(),
            free: BTreeMap::new(),
        })
    }

    /// The reference system of the distance classes.
    #[must_use]
    pub const fn reference(&self) -> &DepthReference {
        &self.reference
    }

    /// How it believes, doubts and forgets.
    #[must_use]
    pub const fn params(&self) -> MemoryParams {
        self.params
    }

    /// How many looks it has taken in.
    #[must_use]
    pub const fn looks(&self) -> u64 {
        self.looks
    }

    /// The time of the last look.
    #[must_use]
    pub const fn time_ms(&self) -> u64 {
        self.time_ms
    }

    /// The map frame the robot is in.
    #[must_use]
    pub const fn frame(&self) -> u32 {
        self.frame
    }

    /// Where the robot was in the last look.
    #[must_use]
    pub const fn robot(&self) -> RobotPose {
        self.robot
    }

    /// Every object, tombstones included, by name.
    pub fn objects(&self) -> impl Iterator<Item = (&ObjectId, &MemoryObject)> {
        self.objects.iter()
    }

    /// What is kept of this object.
    #[must_use]
    pub fn object(&self, object: &ObjectId) -> Option<&MemoryObject> {
        self.objects.get(object)
    }

    /// The told facts that stand.
    #[must_use]
    pub fn facts(&self) -> &[ToldFact] {
        &self.facts
    }

    /// The objects that are not gone and whose place in the present frame is known, seen there or
    /// carried there, by name.
    pub(crate) fn present(
        &self,
    ) -> impl Iterator<Item = (&ObjectId, &MemoryObject, GroundEstimate)> {
        let joins = self.joins();
        self.objects.iter().filter_map(move |(name, object)| {
            let place = self.estimate(name);
            let place = place.or_else(|| Some(self.carried(name, &joins)?.0))?;
            Some((name, object, place))
        })
    }

    /// The objects that are not gone, by name, and those that only facts speak of.
    pub(crate) fn living(&self) -> impl Iterator<Item = &ObjectId> {
        let told = self.facts.iter().flat_map(|fact| &fact.between);
        let names: BTreeSet<&ObjectId> = self.objects.keys().chain(told).collect();
        names.into_iter().filter(|name| self.is_known(name))
    }

    /// The place of an object that the present frame has seen, unless it is gone.
    pub(crate) fn estimate(&self, object: &ObjectId) -> Option<GroundEstimate> {
        let kept = self.objects.get(object)?;
        let place = kept.places.get(&self.frame).copied();
        place.filter(|_| kept.life != Life::Removed)
    }

    pub(crate) fn is_known(&self, object: &ObjectId) -> bool {
        let told = || self.facts.iter().any(|fact| fact.between.contains(object));
        self.objects
            .get(object)
            .map_or_else(told, |kept| kept.life != Life::Removed)
    }
}
