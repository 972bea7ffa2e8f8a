use std::collections::{BTreeMap, BTreeSet, VecDeque};

use serde::{Deserialize, Serialize};

use crate::constraint_network::{Closure, ConstraintNetwork, DistanceFact, FactSource};
use crate::depth_reference::DepthReference;
use crate::egocentric_place::{EgocentricPlace, read_between, read_offset};
use crate::explanation::Explanation;
use crate::fusion::{correlated, independent, mahalanobis_squared};
use crate::ground_estimate::GroundEstimate;
use crate::ground_extent::GroundExtent;
use crate::ground_pose::GroundPose;
use crate::life::Life;
use crate::look::{Look, Observation, PoseKnowledge};
use crate::look_evidence::{AskedPlace, Evidence, LookEvidence};
use crate::memory_change::{Change, Dated};
use crate::memory_params::{BadMemoryParams, MemoryParams, Policy};
use crate::robot_pose::RobotPose;
use crate::sighting::BadSighting;
use crate::squared_bounds::SquaredBounds;
use crate::{DepthSet, Mode, ObjectId, Places, Reason, Relation};

/// What the robot remembers of the things around it, look after look.
///
/// Every object keeps a position with its covariance in each map frame that has seen it, and a
/// [`Life`]. Relations are qualified from positions when asked for; told facts and pairs that no
/// frame has in common go through a [`ConstraintNetwork`]. Nothing contradictory is ever taken in:
/// what contradicts comes back as a value, and the memory stays as it was unless its [`Policy`]
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
    /// Squares of ground of the present frame seen free, by place.
    pub(crate) free: BTreeSet<(i32, i32)>,
}

/// What a memory keeps of an object.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemoryObject {
    /// Where in its life it is.
    pub life: Life,
    /// Where it is, by map frame.
    pub places: BTreeMap<u32, GroundEstimate>,
    /// The look that shows it last, counted from 1.
    pub last_look: u64,
    /// The time of that look.
    pub last_time_ms: u64,
    /// How many looks have shown it since it appeared or moved.
    pub sightings: u64,
    /// How many looks in a row have shown free space in its place.
    pub misses: u32,
    /// How often it has moved or come back from its tombstone.
    pub epoch: u32,
    /// The radius of the circle on the ground it stands in, in millimetres.
    pub radius_mm: u32,
    /// How high above the ground its middle is, in millimetres.
    pub height_mm: i32,
}

/// A told fact: which classes the distance between two objects may be in.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ToldFact {
    /// The two objects; a fact may speak of what has not been seen.
    pub between: [ObjectId; 2],
    /// The classes.
    pub depth: DepthSet,
}

/// What is refused; the memory stays as it was.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refused {
    /// A sighting shows nothing.
    #[error(transparent)]
    Sighting(#[from] BadSighting),
    /// The look is older than the last one.
    #[error("a look at {look_ms} ms comes after one at {last_ms} ms: time does not run backwards")]
    Time {
        /// The time of the look.
        look_ms: u64,
        /// The time of the last one.
        last_ms: u64,
    },
    /// Objects are not where they were.
    #[error("{} seen elsewhere than remembered ({} of {known} known objects in view)", names(.moved), .moved.len())]
    Moved {
        /// The objects, with their places.
        moved: Vec<Displaced>,
        /// How many objects of the look were known in this frame.
        known: usize,
    },
    /// What is seen, remembered and told cannot hold together.
    #[error("these cannot hold together:\n{0}")]
    Contradiction(Explanation),
    /// The fact is none.
    #[error("no fact: {0}")]
    Fact(#[from] crate::NotAFact),
    /// The fact was never told.
    #[error("nobody told that: {0}")]
    NeverTold(String),
}

/// An object that is not where it was.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Displaced {
    /// The object.
    pub object: ObjectId,
    /// Where it was, and since which look.
    pub remembered: GroundEstimate,
    /// The look that shows it there last.
    pub last_look: u64,
    /// Where the look has it.
    pub seen: GroundEstimate,
}

/// From where a relation is told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Observer {
    /// The robot, where it last was.
    Robot,
    /// Somebody at the place of this object.
    Object(ObjectId),
    /// Somebody at this pose of the present frame.
    At(GroundPose),
}

/// Where an object is for the robot: what an arm needs to reach it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotPlace {
    /// To the right of the robot, in metres.
    pub right_m: f64,
    /// Ahead of the robot, in metres.
    pub forward_m: f64,
    /// The covariance `[[rr, rf], [rf, ff]]` in square metres, the errors of the pose included.
    pub covariance_m2: [[f64; 2]; 2],
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
            free: BTreeSet::new(),
        })
    }

    /// Takes in a look, with what it shows of places where nothing was reported, and says what
    /// became different.
    ///
    /// # Errors
    /// [`Refused`] says why; the memory stays as it was.
    pub fn observe(
        &mut self,
        look: &Look,
        evidence: &impl LookEvidence,
    ) -> Result<Vec<Change>, Refused> {
        look.check()?;
        if look.time_ms < self.time_ms {
            return Err(Refused::Time {
                look_ms: look.time_ms,
                last_ms: self.time_ms,
            });
        }
        let lost = look.pose == PoseKnowledge::Lost;
        let (frame, robot) = match look.pose {
            PoseKnowledge::Known(robot) => (self.frame, robot),
            PoseKnowledge::Lost if self.looks == 0 => (self.frame, RobotPose::default()),
            PoseKnowledge::Lost => (self.frame + 1, RobotPose::default()),
        };
        let mut next = Self {
            looks: self.looks + 1,
            time_ms: look.time_ms,
            frame,
            robot,
            ..self.without_ground()
        };
        let mut changes = Vec::new();
        if frame != self.frame {
            changes.push(Change::NewFrame { frame });
        }
        next.see(look, &mut changes)?;
        next.miss(look, evidence, &mut changes);
        next.agree_with_facts(&mut changes)?;
        next.bury();
        next.note(&changes);
        let ground = std::mem::take(&mut self.free);
        *self = next;
        if !(lost && frame > 0) {
            self.free = ground;
        }
        self.walk(evidence);
        Ok(changes)
    }

    /// What the memory would be after the look, without taking it in.
    ///
    /// # Errors
    /// As [`SceneMemory::observe`].
    pub fn what_if(&self, look: &Look, evidence: &impl LookEvidence) -> Result<Self, Refused> {
        let mut next = self.clone();
        next.observe(look, evidence)?;
        Ok(next)
    }

    /// Takes in a told fact.
    ///
    /// # Errors
    /// [`Refused::Contradiction`] if it cannot hold with what is known, whatever the policy, for
    /// what is told does not outweigh what is seen; [`Refused::Fact`] if it is none.
    pub fn tell(&mut self, fact: ToldFact) -> Result<Vec<Change>, Refused> {
        let mut next = self.clone();
        let change = Change::Told {
            fact: next.words(&fact),
        };
        if !next.facts.contains(&fact) {
            next.facts.push(fact);
        }
        next.network(&BTreeSet::new())?;
        next.note(std::slice::from_ref(&change));
        *self = next;
        Ok(vec![change])
    }

    /// Takes a told fact back.
    ///
    /// # Errors
    /// [`Refused::NeverTold`] if it was not told.
    pub fn retract(&mut self, fact: &ToldFact) -> Result<Vec<Change>, Refused> {
        let words = self.words(fact);
        let Some(place) = self.facts.iter().position(|told| told == fact) else {
            return Err(Refused::NeverTold(words));
        };
        self.facts.remove(place);
        let change = Change::Retracted { fact: words };
        self.note(std::slice::from_ref(&change));
        Ok(vec![change])
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

    /// The changes from one time to another, both included; `None` if the memory no longer keeps
    /// the earlier of them.
    #[must_use]
    pub fn changes(&self, from_ms: u64, to_ms: u64) -> Option<Vec<&Dated>> {
        let full = self.changes.len() >= self.params.most_changes;
        if full
            && self
                .changes
                .front()
                .is_some_and(|oldest| oldest.time_ms >= from_ms)
        {
            return None;
        }
        let within = |dated: &&Dated| (from_ms..=to_ms).contains(&dated.time_ms);
        Some(self.changes.iter().filter(within).collect())
    }

    /// What is different in a later state of this memory: lives, moves and facts, by name.
    #[must_use]
    pub fn diff(&self, later: &Self) -> Vec<Change> {
        let mut changes = Vec::new();
        for (object, is) in &later.objects {
            match self.objects.get(object) {
                None => changes.push(Change::Appeared {
                    object: object.clone(),
                }),
                Some(was) => {
                    if was.epoch != is.epoch {
                        changes.push(Change::Moved {
                            object: object.clone(),
                            epoch: is.epoch,
                        });
                    }
                    if was.life != is.life {
                        changes.push(Change::Became {
                            object: object.clone(),
                            from: was.life,
                            to: is.life,
                        });
                    }
                }
            }
        }
        let only = |some: &Self, other: &Self| -> Vec<String> {
            let facts = some.facts.iter().filter(|fact| !other.facts.contains(fact));
            facts.map(|fact| some.words(fact)).collect()
        };
        let told = only(later, self)
            .into_iter()
            .map(|fact| Change::Told { fact });
        let gone = only(self, later)
            .into_iter()
            .map(|fact| Change::Retracted { fact });
        changes.extend(told);
        changes.extend(gone);
        changes
    }

    /// Where an object is in the robot's present frame, seen or unseen; `None` if the frame has
    /// not seen it, or it is gone.
    #[must_use]
    pub fn from_robot(&self, object: &ObjectId) -> Option<RobotPlace> {
        let estimate = self.estimate(object)?;
        let pose = self.robot.pose();
        let seen = estimate.widened(self.robot.spread_at(estimate.position_m()));
        let [ahead, leftward] = estimate.seen_from(pose);
        let (sin, cos) = pose.heading_rad().sin_cos();
        let [[xx, xz], [_, zz]] = seen.covariance_m2();
        // Right is (cos, sin) and forward (-sin, cos) of the frame's x and z.
        let along = |a: [f64; 2], b: [f64; 2]| {
            a[0] * (xx * b[0] + xz * b[1]) + a[1] * (xz * b[0] + zz * b[1])
        };
        let (right, forward) = ([cos, sin], [-sin, cos]);
        Some(RobotPlace {
            right_m: -leftward,
            forward_m: ahead,
            covariance_m2: [
                [along(right, right), along(right, forward)],
                [along(right, forward), along(forward, forward)],
            ],
        })
    }

    /// Where an object is for an observer at any pose of the present frame.
    #[must_use]
    pub fn place_from(&self, robot: RobotPose, object: &ObjectId) -> Option<EgocentricPlace> {
        let estimate = self.estimate(object)?;
        let (pose, qualify) = (robot.pose(), self.params.qualify);
        // The heading turns the bearing only, the position moves the place.
        let still = RobotPose::new(pose, robot.covariance_m2(), 0.0).unwrap_or(robot);
        let relative = estimate.widened(still.spread_at(estimate.position_m()));
        let bounds = relative.bounds(qualify.sigmas).seen_from(pose);
        let turned = bounds.turned_within(qualify.sigmas * robot.sigma_heading_rad());
        Some(EgocentricPlace {
            object: object.clone(),
            places: turned.egocentric(&self.reference),
            read: read_offset(
                estimate.seen_from(pose),
                &self.reference,
                qualify.axis_tolerance_rad,
            ),
            mode: Mode::Sound,
        })
    }

    /// Where `to` is at `from`, seen by an observer: measured where a frame has both, else what
    /// follows from facts and from the objects that two frames share. `None` if one of them is
    /// unknown or gone, or both are one.
    #[must_use]
    pub fn relation(
        &self,
        from: &ObjectId,
        to: &ObjectId,
        observer: &Observer,
    ) -> Option<Relation> {
        if from == to || !(self.is_known(from) && self.is_known(to)) {
            return None;
        }
        let measured = self.common_frame(from, to);
        let mut places = Places::all(&self.reference);
        let mut read = None;
        let mut reason = Reason::Composed {
            look: None,
            through: Vec::new(),
        };
        if let Some((frame, first, second)) = measured {
            let qualify = self.params.qualify;
            let [a, b] = [first, second].map(|place| GroundExtent::of(&place, qualify.sigmas));
            places.depth = a.depth_to(b, &SquaredBounds::of(&self.reference));
            if let Some((pose, extent)) = self.observer_extent(frame, observer) {
                places.orientation = a.orientation_of(b, extent);
                read = Some(read_between(
                    first.seen_from(pose),
                    second.seen_from(pose),
                    &self.reference,
                    qualify.axis_tolerance_rad,
                ));
            }
            reason = Reason::Measured {
                looks: [from, to].map(|object| self.objects[object].last_look),
            };
        }
        if measured.is_none() || !self.facts.is_empty() {
            let asked = BTreeSet::from([from.clone(), to.clone()]);
            // What the memory holds has been checked, so the network is not refuted.
            let network = self.network(&asked).ok()?;
            let narrowed = network.depth(from, to)?;
            if measured.is_none() || narrowed != places.depth {
                reason = Reason::Composed {
                    look: None,
                    through: through(&network.explain(from, to)?),
                };
            }
            places.depth &= narrowed;
        }
        Some(Relation {
            from: from.clone(),
            to: to.clone(),
            places,
            read,
            mode: Mode::Sound,
            reason,
        })
    }

    /// Why the distance between two objects may be in no other class, down to facts and looks.
    #[must_use]
    pub fn explain(&self, from: &ObjectId, to: &ObjectId) -> Option<Explanation> {
        if from == to || !(self.is_known(from) && self.is_known(to)) {
            return None;
        }
        let asked = BTreeSet::from([from.clone(), to.clone()]);
        self.network(&asked).ok()?.explain(from, to)
    }

    /// The distance classes of all pairs of the objects of the present frame, requalified from
    /// their places: for each pair of names in order, the first before the second.
    #[must_use]
    pub fn depths(&self) -> Vec<DepthSet> {
        let sigmas = self.params.qualify.sigmas;
        let extents: Vec<GroundExtent> = self
            .present()
            .map(|(_, _, estimate)| GroundExtent::of(estimate, sigmas))
            .collect();
        let pairs = extents.len() * extents.len().saturating_sub(1) / 2;
        let bounds = SquaredBounds::of(&self.reference);
        let mut depths = Vec::with_capacity(pairs);
        for (at, &first) in extents.iter().enumerate() {
            let others = extents[at + 1..].iter();
            depths.extend(others.map(|&second| first.depth_to(second, &bounds)));
        }
        depths
    }

    /// The objects of the present frame that are not gone, with their places.
    pub(crate) fn present(
        &self,
    ) -> impl Iterator<Item = (&ObjectId, &MemoryObject, &GroundEstimate)> {
        self.objects.iter().filter_map(|(name, object)| {
            let place = object.places.get(&self.frame)?;
            (object.life != Life::Removed).then_some((name, object, place))
        })
    }

    /// The objects that are not gone, by name, and those that only facts speak of.
    pub(crate) fn living(&self) -> impl Iterator<Item = &ObjectId> {
        let told = self.facts.iter().flat_map(|fact| &fact.between);
        let names: BTreeSet<&ObjectId> = self.objects.keys().chain(told).collect();
        names.into_iter().filter(|name| self.is_known(name))
    }

    /// The place of an object in the present frame, unless it is gone.
    pub(crate) fn estimate(&self, object: &ObjectId) -> Option<GroundEstimate> {
        let kept = self.objects.get(object)?;
        let place = kept.places.get(&self.frame).copied();
        place.filter(|_| kept.life != Life::Removed)
    }

    /// A fact in the words of the query language.
    #[must_use]
    pub fn words(&self, fact: &ToldFact) -> String {
        let [a, b] = &fact.between;
        format!(
            "{b} within {} of {a}",
            self.reference.labels(fact.depth).join(",")
        )
    }

    fn is_known(&self, object: &ObjectId) -> bool {
        let told = || self.facts.iter().any(|fact| fact.between.contains(object));
        self.objects
            .get(object)
            .map_or_else(told, |kept| kept.life != Life::Removed)
    }

    /// The latest frame that has seen both, with their places there.
    fn common_frame(
        &self,
        from: &ObjectId,
        to: &ObjectId,
    ) -> Option<(u32, GroundEstimate, GroundEstimate)> {
        let living = |object| {
            self.objects
                .get(object)
                .filter(|kept| kept.life != Life::Removed)
        };
        let (first, second) = (living(from)?, living(to)?);
        let mut frames = first.places.iter().rev();
        frames.find_map(|(&frame, &place)| Some((frame, place, *second.places.get(&frame)?)))
    }

    /// Where an observer may stand in a frame: best guess and extent. The robot stands in the
    /// present frame only.
    fn observer_extent(
        &self,
        frame: u32,
        observer: &Observer,
    ) -> Option<(GroundPose, GroundExtent)> {
        let sigmas = self.params.qualify.sigmas;
        let at = |pose: GroundPose| GroundExtent::point([pose.x_m(), pose.z_m()]);
        match observer {
            Observer::Robot if frame == self.frame => {
                let pose = self.robot.pose();
                if self.robot.is_exact() {
                    return Some((pose, at(pose)));
                }
                let place =
                    GroundEstimate::of([pose.x_m(), pose.z_m()], self.robot.covariance_m2());
                Some((pose, GroundExtent::of(&place, sigmas)))
            }
            Observer::At(pose) if frame == self.frame => Some((*pose, at(*pose))),
            Observer::Robot | Observer::At(_) => None,
            Observer::Object(object) => {
                let kept = self.objects.get(object)?;
                let place = kept
                    .places
                    .get(&frame)
                    .filter(|_| kept.life != Life::Removed)?;
                let [x, z] = place.position_m();
                let pose = GroundPose::new(x, z, 0.0).ok()?;
                Some((pose, GroundExtent::of(place, sigmas)))
            }
        }
    }

    /// The network of these objects, of those that facts speak of, and of those that join two
    /// frames: every fact, and every pair that a frame has measured.
    fn network(&self, asked: &BTreeSet<ObjectId>) -> Result<ConstraintNetwork, Refused> {
        let mut nodes = asked.clone();
        nodes.extend(
            self.facts
                .iter()
                .flat_map(|fact| fact.between.iter().cloned()),
        );
        let joins = self
            .objects
            .iter()
            .filter(|(_, kept)| kept.places.len() > 1);
        nodes.extend(joins.map(|(name, _)| name.clone()));
        let gone = |name: &ObjectId| {
            let kept = self.objects.get(name);
            kept.is_some_and(|kept| kept.life == Life::Removed)
        };
        nodes.retain(|name| !gone(name));
        let mut network = ConstraintNetwork::new(&self.reference, nodes.iter().cloned());
        let told = self
            .facts
            .iter()
            .filter(|fact| fact.between.iter().all(|end| !gone(end)));
        let mut facts: Vec<DistanceFact> = told
            .map(|fact| DistanceFact {
                between: fact.between.clone(),
                depth: fact.depth,
                source: FactSource::Told(self.words(fact)),
            })
            .collect();
        let sigmas = self.params.qualify.sigmas;
        let bounds = SquaredBounds::of(&self.reference);
        let places: Vec<(&ObjectId, &MemoryObject)> = nodes
            .iter()
            .filter_map(|name| self.objects.get_key_value(name))
            .collect();
        for (at, (first, one)) in places.iter().enumerate() {
            for (second, two) in &places[at + 1..] {
                for (frame, place) in &one.places {
                    let Some(other) = two.places.get(frame) else {
                        continue;
                    };
                    let [a, b] = [place, other].map(|place| GroundExtent::of(place, sigmas));
                    facts.push(DistanceFact {
                        between: [(*first).clone(), (*second).clone()],
                        depth: a.depth_to(b, &bounds),
                        source: FactSource::Measured([one.last_look, two.last_look]),
                    });
                }
            }
        }
        match network.constrain(facts)? {
            Closure::NotRefuted { .. } => Ok(network),
            Closure::Inconsistent(proof) => Err(Refused::Contradiction(proof)),
        }
    }

    /// Takes in the sightings of a look.
    fn see(&mut self, look: &Look, changes: &mut Vec<Change>) -> Result<(), Refused> {
        let gate = f64::from(self.params.gate_sigmas).powi(2);
        let mut displaced = Vec::new();
        let mut known = 0;
        let seen: Vec<(&Observation, GroundEstimate)> = look
            .observations
            .iter()
            .map(|observation| (observation, self.place_of(observation)))
            .collect();
        for (observation, place) in &seen {
            let object = &observation.sighting.object;
            let Some(remembered) = self.estimate(object) else {
                continue;
            };
            known += 1;
            if mahalanobis_squared(&remembered, place) > gate {
                displaced.push(Displaced {
                    object: object.clone(),
                    remembered,
                    last_look: self.objects[object].last_look,
                    seen: *place,
                });
            }
        }
        let all = known >= 2 && displaced.len() == known;
        if !displaced.is_empty() && (self.params.policy == Policy::Refuse || all) {
            return Err(Refused::Moved {
                moved: displaced,
                known,
            });
        }
        for (observation, place) in seen {
            let name = &observation.sighting.object;
            let moved = displaced.iter().any(|gone| gone.object == *name);
            self.remember(observation, place, moved, changes);
        }
        Ok(())
    }

    /// The place a sighting gives, with the creep and the errors of the pose.
    fn place_of(&self, observation: &Observation) -> GroundEstimate {
        let creep = (f64::from(self.params.creep_um) / 1e6).powi(2);
        let seen = GroundEstimate::of_sighting(&observation.sighting, self.robot.pose());
        let spread = self.robot.spread_at(seen.position_m());
        seen.widened([[creep, 0.0], [0.0, creep]]).widened(spread)
    }

    fn remember(
        &mut self,
        observation: &Observation,
        place: GroundEstimate,
        moved: bool,
        changes: &mut Vec<Change>,
    ) {
        let name = observation.sighting.object.clone();
        let appears = self
            .objects
            .get(&name)
            .is_none_or(|kept| kept.life == Life::Removed);
        let epoch = self.objects.get(&name).map_or(0, |kept| kept.epoch + 1);
        if appears {
            changes.push(Change::Appeared {
                object: name.clone(),
            });
            self.objects.insert(
                name.clone(),
                MemoryObject {
                    life: Life::Tentative,
                    places: BTreeMap::new(),
                    last_look: 0,
                    last_time_ms: 0,
                    sightings: 0,
                    misses: 0,
                    epoch,
                    radius_mm: 0,
                    height_mm: 0,
                },
            );
        }
        let (frame, looks, time_ms) = (self.frame, self.looks, self.time_ms);
        let exact = self.robot.is_exact();
        let confirm_after = u64::from(self.params.confirm_after);
        let creep = (f64::from(self.params.creep_um) / 1e6).powi(2);
        let Some(kept) = self.objects.get_mut(&name) else {
            return;
        };
        if moved {
            kept.places.clear();
            kept.epoch = epoch;
            changes.push(Change::Moved {
                object: name.clone(),
                epoch,
            });
        }
        let fused = kept.places.get(&frame).map_or(place, |before| {
            let before = before.widened([[creep, 0.0], [0.0, creep]]);
            if exact {
                independent(&before, &place)
            } else {
                correlated(&before, &place)
            }
        });
        kept.places.insert(frame, fused);
        kept.last_look = looks;
        kept.last_time_ms = time_ms;
        kept.sightings += 1;
        kept.misses = 0;
        kept.radius_mm = observation.radius_mm;
        kept.height_mm = observation.height_mm;
        let confirmed = kept.life != Life::Tentative || kept.sightings >= confirm_after;
        let life = if confirmed {
            Life::InView
        } else {
            Life::Tentative
        };
        become_(name, kept, life, changes);
    }

    /// Asks the look about every object it does not show.
    fn miss(&mut self, look: &Look, evidence: &impl LookEvidence, changes: &mut Vec<Change>) {
        let seen: BTreeSet<&ObjectId> = look
            .observations
            .iter()
            .map(|o| &o.sighting.object)
            .collect();
        let unseen: Vec<ObjectId> = self
            .objects
            .iter()
            .filter(|(name, kept)| kept.life != Life::Removed && !seen.contains(name))
            .map(|(name, _)| name.clone())
            .collect();
        for name in unseen {
            let answer = self
                .asked(&name)
                .map_or(Evidence::OutOfView, |place| evidence.at(place));
            let (missing_after, removed_after) =
                (self.params.missing_after, self.params.removed_after);
            let Some(kept) = self.objects.get_mut(&name) else {
                continue;
            };
            if answer == Evidence::FreeSpace {
                kept.misses = kept.misses.saturating_add(1);
            }
            let tentative = kept.life == Life::Tentative;
            let gone = if tentative {
                missing_after
            } else {
                removed_after
            };
            let life = match answer {
                _ if kept.misses >= gone => Life::Removed,
                _ if tentative => Life::Tentative,
                _ if kept.misses >= missing_after => Life::Missing,
                Evidence::FreeSpace | Evidence::NoEvidence => Life::Confirmed,
                Evidence::Occluded => Life::Occluded,
                Evidence::OutOfView => Life::OutOfView,
            };
            become_(name, kept, life, changes);
        }
    }

    /// The place of an object for the evidence of a look.
    fn asked(&self, object: &ObjectId) -> Option<AskedPlace> {
        let place = self.from_robot(object)?;
        let kept = &self.objects[object];
        let [[rr, _], [_, ff]] = place.covariance_m2;
        Some(AskedPlace {
            right_m: place.right_m,
            forward_m: place.forward_m,
            height_m: f64::from(kept.height_mm) / 1e3,
            within_m: f64::from(kept.radius_mm) / 1e3 + 3.0 * rr.max(ff).sqrt(),
        })
    }

    /// Facts and places must hold together; by policy the newest fact yields to what is seen.
    fn agree_with_facts(&mut self, changes: &mut Vec<Change>) -> Result<(), Refused> {
        while let Err(refused) = self.network(&BTreeSet::new()) {
            let newest = match self.params.policy {
                Policy::Refuse => None,
                Policy::Follow => self.facts.pop(),
            };
            let Some(fact) = newest else {
                return Err(refused);
            };
            changes.push(Change::Retracted {
                fact: self.words(&fact),
            });
        }
        Ok(())
    }

    /// Lets the oldest tombstones go where there are too many.
    fn bury(&mut self) {
        let mut tombs: Vec<(u64, ObjectId)> = self
            .objects
            .iter()
            .filter(|(_, kept)| kept.life == Life::Removed)
            .map(|(name, kept)| (kept.last_look, name.clone()))
            .collect();
        let spare = tombs.len().saturating_sub(self.params.most_tombstones);
        if spare > 0 {
            tombs.sort_unstable();
            for (_, name) in tombs.drain(..spare) {
                self.objects.remove(&name);
            }
        }
    }

    fn note(&mut self, changes: &[Change]) {
        let (time_ms, look) = (self.time_ms, self.looks);
        self.changes
            .extend(changes.iter().cloned().map(|change| Dated {
                time_ms,
                look,
                change,
            }));
        let spare = self.changes.len().saturating_sub(self.params.most_changes);
        self.changes.drain(..spare);
    }

    /// Keeps the squares around the robot that the look shows free.
    fn walk(&mut self, evidence: &impl LookEvidence) {
        let cell = i64::from(self.params.cell_mm);
        let reach = i64::from(self.params.ground_mm) / cell;
        let pose = self.robot.pose();
        let (sin, cos) = pose.heading_rad().sin_cos();
        let square = |metres: f64| (metres * 1e3 / cell as f64).floor() as i64;
        let (x, z) = (square(pose.x_m()), square(pose.z_m()));
        for (dx, dz) in (-reach..reach).flat_map(|dx| (-reach..reach).map(move |dz| (dx, dz))) {
            if self.free.len() >= self.params.most_cells {
                return;
            }
            let (Ok(column), Ok(row)) = (i32::try_from(x + dx), i32::try_from(z + dz)) else {
                continue;
            };
            let [right, forward] = [
                self.centre_m(column) - pose.x_m(),
                self.centre_m(row) - pose.z_m(),
            ];
            let place = AskedPlace {
                right_m: right * cos + forward * sin,
                forward_m: forward * cos - right * sin,
                height_m: 0.0,
                within_m: cell as f64 / 2e3,
            };
            if evidence.at(place) == Evidence::FreeSpace {
                self.free.insert((column, row));
            }
        }
    }

    /// The middle of a square along one axis, in metres.
    pub(crate) fn centre_m(&self, square: i32) -> f64 {
        (f64::from(square) + 0.5) * f64::from(self.params.cell_mm) / 1e3
    }

    /// Everything but the squares of free ground, which no look changes before it is taken in.
    fn without_ground(&self) -> Self {
        Self {
            reference: self.reference.clone(),
            objects: self.objects.clone(),
            facts: self.facts.clone(),
            changes: self.changes.clone(),
            free: BTreeSet::new(),
            ..*self
        }
    }
}

/// Gives an object another life, and says so if it differs.
fn become_(object: ObjectId, kept: &mut MemoryObject, to: Life, changes: &mut Vec<Change>) {
    let from = kept.life;
    kept.life = to;
    if from != to {
        changes.push(Change::Became { object, from, to });
    }
}

/// The objects an explanation goes through, by name.
fn through(explanation: &Explanation) -> Vec<ObjectId> {
    let ends = explanation.conclusion().map(|step| step.between.clone());
    let all: BTreeSet<ObjectId> = explanation
        .steps
        .iter()
        .flat_map(|step| step.between.iter().cloned())
        .collect();
    all.into_iter()
        .filter(|name| ends.as_ref().is_none_or(|ends| !ends.contains(name)))
        .collect()
}

/// The names of the objects, for a sentence.
fn names(moved: &[Displaced]) -> String {
    let names: Vec<String> = moved.iter().map(|m| format!("`{}`", m.object)).collect();
    names.join(", ")
}
