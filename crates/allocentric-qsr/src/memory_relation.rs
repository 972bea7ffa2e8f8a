//! The relations between remembered objects.

use std::collections::BTreeSet;

use crate::constraint_network::{Closure, ConstraintNetwork, DistanceFact, FactSource};
use crate::egocentric_place::read_between;
use crate::explanation::Explanation;
use crate::ground_estimate::GroundEstimate;
use crate::ground_extent::GroundExtent;
use crate::life::Life;
use crate::observer::Observer;
use crate::scene_memory::SceneMemory;
use crate::squared_bounds::SquaredBounds;
use crate::{DepthSet, Mode, ObjectId, Places, Reason, Relation};

/// A map frame and the places of two objects there, if one has both.
type Known = Option<(u32, GroundEstimate, GroundEstimate)>;

impl SceneMemory {
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
        let mut network = None;
        let mut known = measured;
        if measured.is_none() || !self.facts.is_empty() {
            let (closed, carried) = self.asked_network(from, to)?;
            network = Some(closed);
            known = measured.or(carried);
        }
        if let Some((frame, first, second)) = known {
            let qualify = self.params.qualify;
            let [a, b] = [first, second].map(|place| GroundExtent::of(&place, qualify.sigmas));
            places.depth = a.depth_to(b, &SquaredBounds::of(&self.reference));
            // The observer may stand in the present frame only, where landmarks carry both objects.
            let carried = || Some((self.frame, self.here(from)?, self.here(to)?));
            let seen = self
                .observer_extent(frame, observer)
                .map(|eye| (eye, first, second))
                .or_else(|| {
                    let (frame, first, second) = carried()?;
                    Some((self.observer_extent(frame, observer)?, first, second))
                });
            if let Some(((pose, eye), first, second)) = seen {
                let [a, b] = [first, second].map(|place| GroundExtent::of(&place, qualify.sigmas));
                places.orientation = a.orientation_of(b, eye);
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
        if let Some(network) = network {
            let narrowed = network.depth(from, to)?;
            if known.is_none() || narrowed != places.depth {
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
        self.asked_network(from, to)?.0.explain(from, to)
    }

    /// The network around two objects. Where no frame has both, but landmarks carry both into the
    /// present frame, that counts as measured unless it contradicts the rest; then the places there
    /// come with it.
    fn asked_network(&self, from: &ObjectId, to: &ObjectId) -> Option<(ConstraintNetwork, Known)> {
        let asked = BTreeSet::from([from.clone(), to.clone()]);
        // What the memory holds has been checked, so the network is not refuted.
        let mut network = self.network(&asked).ok()?;
        if self.common_frame(from, to).is_some() {
            return Some((network, None));
        }
        let joins = self.joins();
        let place = |object: &ObjectId| {
            let seen = self.estimate(object).map(|place| (place, Vec::new()));
            seen.or_else(|| self.carried(object, &joins))
        };
        let (Some((first, marks)), Some((second, more))) = (place(from), place(to)) else {
            return Some((network, None));
        };
        let sigmas = self.params.qualify.sigmas;
        let [a, b] = [first, second].map(|place| GroundExtent::of(&place, sigmas));
        let landmarks: BTreeSet<ObjectId> = marks.into_iter().chain(more).collect();
        let fact = DistanceFact {
            between: [from.clone(), to.clone()],
            depth: a.depth_to(b, &SquaredBounds::of(&self.reference)),
            source: FactSource::Joined {
                looks: [from, to].map(|object| self.objects[object].last_look),
                landmarks: landmarks.into_iter().collect(),
            },
        };
        let taken = matches!(network.constrain([fact]), Ok(Closure::NotRefuted { .. }));
        Some((network, taken.then_some((self.frame, first, second))))
    }

    /// The distance classes of all pairs of the objects of the present frame, requalified from
    /// their places: for each pair of names in order, the first before the second.
    #[must_use]
    pub fn depths(&self) -> Vec<DepthSet> {
        let sigmas = self.params.qualify.sigmas;
        let extents: Vec<GroundExtent> = self
            .present()
            .map(|(_, _, estimate)| GroundExtent::of(&estimate, sigmas))
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

    /// The latest frame that has seen both, with their places there.
    fn common_frame(&self, from: &ObjectId, to: &ObjectId) -> Known {
        let living = |object| {
            self.objects
                .get(object)
                .filter(|kept| kept.life != Life::Removed)
        };
        let (first, second) = (living(from)?, living(to)?);
        let mut frames = first.places.iter().rev();
        frames.find_map(|(&frame, &place)| Some((frame, place, *second.places.get(&frame)?)))
    }
}

/// The objects an explanation goes through, by name.
fn through(explanation: &Explanation) -> Vec<ObjectId> {
    let ends: Vec<&ObjectId> = explanation
        .conclusion()
        .map_or_else(Vec::new, |step| step.statement.objects().collect());
    let all: BTreeSet<ObjectId> = explanation
        .steps
        .iter()
        .flat_map(|step| step.statement.objects().cloned())
        .collect();
    all.into_iter()
        .filter(|name| !ends.contains(&name))
        .collect()
}
