//! The network of everything a memory was told and has measured.

use std::collections::BTreeSet;

use crate::ObjectId;
use crate::constraint_network::{Closure, ConstraintNetwork, DistanceFact, FactSource};
use crate::ground_extent::GroundExtent;
use crate::life::Life;
use crate::memory_object::MemoryObject;
use crate::refused::Refused;
use crate::scene_memory::SceneMemory;
use crate::squared_bounds::SquaredBounds;

impl SceneMemory {
    /// The network of these objects, of those that facts speak of, and of those that join two
    /// frames: every fact, and every pair that a frame has measured.
    pub(crate) fn network(&self, asked: &BTreeSet<ObjectId>) -> Result<ConstraintNetwork, Refused> {
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
}
