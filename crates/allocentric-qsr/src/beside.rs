//! The memories of several robots, read as one from the place of one of them.

use std::collections::{BTreeMap, BTreeSet};

use crate::ObjectId;
use crate::life::Life;
use crate::memory_object::MemoryObject;
use crate::scene_memory::SceneMemory;

impl SceneMemory {
    /// This memory with what other robots remember beside it: every frame of theirs becomes an earlier frame, so
    /// that landmarks which two robots have in common join their frames as they join those of one robot, and what
    /// nothing joins stays apart. The robot, its pose, its ground and its present frame are this memory's.
    ///
    /// An object takes its life, its size and its times from whoever saw it last. Where two robots contradict each
    /// other ([`SceneMemory::agreement`]), the older of the two places is left out: the newer one holds, and the
    /// contradiction is for [`SceneMemory::agreement`] to report. Where one has found gone what another saw before in
    /// the same place, it is gone; where the other saw it after, it is there. Facts of all are facts.
    ///
    /// The result is for questions: a look it takes in belongs to no robot. An object that both have seen is one
    /// object if it bears one name.
    #[must_use]
    pub fn beside<'a>(&self, others: impl IntoIterator<Item = &'a Self>) -> Self {
        let others: Vec<&Self> = others.into_iter().collect();
        let looks = others.iter().fold(self.looks, |most, m| most.max(m.looks));
        let mut own_old: BTreeSet<&ObjectId> = BTreeSet::new();
        let mut objects: BTreeMap<ObjectId, MemoryObject> = BTreeMap::new();
        let mut facts = self.facts.clone();
        let mut first_frame = 0;
        let mut own_gone: BTreeSet<&ObjectId> = BTreeSet::new();
        let agreements: Vec<_> = others.iter().map(|m| self.agreement(m)).collect();
        for (other, agreement) in others.iter().zip(&agreements) {
            let mut old: BTreeSet<&ObjectId> = BTreeSet::new();
            let mut gone: BTreeSet<&ObjectId> = BTreeSet::new();
            for found in &agreement.gone {
                if found.gone_ms > found.seen_ms {
                    let of = if found.is_here {
                        &mut gone
                    } else {
                        &mut own_gone
                    };
                    of.insert(&found.object);
                }
            }
            for dispute in &agreement.disputed {
                if dispute.there_time_ms > dispute.here_time_ms {
                    own_old.insert(&dispute.object);
                } else {
                    old.insert(&dispute.object);
                }
            }
            other.add_to(&mut objects, first_frame, looks, &old, &gone);
            first_frame += other.frame + 1;
            for fact in &other.facts {
                if !facts.contains(fact) {
                    facts.push(fact.clone());
                }
            }
        }
        self.add_to(&mut objects, first_frame, looks, &own_old, &own_gone);
        let others_ms = others.iter().map(|m| m.time_ms).max().unwrap_or(0);
        Self {
            reference: self.reference.clone(),
            params: self.params,
            looks,
            time_ms: self.time_ms.max(others_ms),
            frame: first_frame + self.frame,
            robot: self.robot,
            objects,
            facts,
            changes: self.changes.clone(),
            free: self.free.clone(),
        }
    }

    /// Adds the objects of this memory, its frames counted from `first_frame` on and its looks as the last ones of
    /// `looks`, but for the present places of what is `old`; what is `gone` is a tombstone, whatever this memory
    /// believes.
    fn add_to(
        &self,
        objects: &mut BTreeMap<ObjectId, MemoryObject>,
        first_frame: u32,
        looks: u64,
        old: &BTreeSet<&ObjectId>,
        gone: &BTreeSet<&ObjectId>,
    ) {
        for (name, kept) in &self.objects {
            let mut kept = kept.clone();
            kept.last_look += looks - self.looks;
            if gone.contains(name) {
                kept.life = Life::Removed;
            }
            let places = std::mem::take(&mut kept.places);
            let held = |frame: u32| frame != self.frame || !old.contains(name);
            let places: Vec<_> = places
                .into_iter()
                .filter(|(frame, _)| held(*frame) && kept.life != Life::Removed)
                .map(|(frame, place)| (first_frame + frame, place))
                .collect();
            let merged = match objects.entry(name.clone()) {
                std::collections::btree_map::Entry::Vacant(free) => free.insert(kept),
                std::collections::btree_map::Entry::Occupied(taken) => {
                    let before = taken.into_mut();
                    let known = std::mem::take(&mut before.places);
                    // Of two who saw it at one time, the one who still believes in it.
                    let newer = (kept.last_time_ms, kept.life != Life::Removed)
                        >= (before.last_time_ms, before.life != Life::Removed);
                    if newer {
                        *before = kept;
                    }
                    before.places = known;
                    before
                }
            };
            merged.places.extend(places);
        }
    }
}
