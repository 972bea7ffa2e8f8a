//! What a look says of the objects it does not show.

use std::collections::BTreeSet;

use crate::ObjectId;
use crate::life::Life;
use crate::look::Look;
use crate::look_evidence::{AskedPlace, Evidence, LookEvidence};
use crate::memory_change::{Change, become_};
use crate::scene_memory::SceneMemory;

impl SceneMemory {
    /// Asks the look about every object it does not show.
    pub(crate) fn miss(
        &mut self,
        look: &Look,
        evidence: &impl LookEvidence,
        changes: &mut Vec<Change>,
    ) {
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
                .map_or(Evidence::OutOfView, |place| evidence.of(&name, place));
            let (missing_after, removed_after) =
                (self.params.missing_after, self.params.removed_after);
            let trusts = self
                .objects
                .get(&name)
                .is_some_and(|kept| self.trusts(kept.last_look));
            let time_ms = self.time_ms;
            let Some(kept) = self.objects.get_mut(&name) else {
                continue;
            };
            match answer {
                Evidence::FreeSpace => kept.misses = kept.misses.saturating_add(1),
                // Nothing is in two places.
                Evidence::Elsewhere => kept.misses = kept.misses.max(missing_after),
                _ => {}
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
                _ if !trusts => Life::Stale,
                Evidence::FreeSpace
                | Evidence::NoEvidence
                | Evidence::Taken
                | Evidence::Elsewhere => Life::Confirmed,
                Evidence::Occluded => Life::Occluded,
                Evidence::OutOfView => Life::OutOfView,
            };
            become_(name, kept, life, time_ms, changes);
        }
    }

    /// Whether the world is trusted to have kept still since that look.
    pub(crate) fn trusts(&self, look: u64) -> bool {
        let trusted = u64::from(self.params.trusted_looks);
        trusted == 0 || self.looks.saturating_sub(look) <= trusted
    }

    /// The place of an object for the evidence of a look.
    fn asked(&self, object: &ObjectId) -> Option<AskedPlace> {
        // What another frame has is no reason to give an object up.
        let place = self.robot_place(&self.estimate(object)?);
        let kept = &self.objects[object];
        let [[rr, _], [_, ff]] = place.covariance_m2;
        let radius_m = f64::from(kept.radius_mm) / 1e3;
        Some(AskedPlace {
            right_m: place.right_m,
            forward_m: place.forward_m,
            height_m: f64::from(kept.height_mm) / 1e3,
            within_m: radius_m + 3.0 * rr.max(ff).sqrt(),
            radius_m,
        })
    }
}
