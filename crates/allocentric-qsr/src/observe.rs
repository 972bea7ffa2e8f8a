//! A look is taken in: what it shows is seen, what it does not show is missed.

use std::collections::BTreeMap;

use crate::ObjectId;
use crate::fusion::{correlated, independent, mahalanobis_squared};
use crate::ground_estimate::GroundEstimate;
use crate::life::Life;
use crate::look::{Look, Observation, PoseKnowledge};
use crate::look_evidence::LookEvidence;
use crate::memory_change::{Change, become_};
use crate::memory_object::MemoryObject;
use crate::memory_params::Policy;
use crate::refused::{Displaced, Refused};
use crate::robot_pose::RobotPose;
use crate::scene_memory::SceneMemory;

/// The most map frames an object keeps its place in; the oldest go first, so that a robot that is
/// lost again and again does not fill its memory.
const MOST_FRAMES: usize = 16;

/// From so many standard errors on, a sighting and the remembered place are no longer fused, though no move is
/// told of: the object may have been moved by no more than the two are unsure. The sighting alone is right
/// whether it was or not; what is fused of two places would claim to be surer than either, at neither.
const DOUBT_SIGMAS: f64 = 2.0;

impl SceneMemory {
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
        self.cover(&changes);
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
                    given_up_ms: None,
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
            if mahalanobis_squared(&before, &place) > DOUBT_SIGMAS * DOUBT_SIGMAS {
                place
            } else if exact {
                independent(&before, &place)
            } else {
                correlated(&before, &place)
            }
        });
        kept.places.insert(frame, fused);
        while kept.places.len() > MOST_FRAMES {
            kept.places.pop_first();
        }
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
        become_(name, kept, life, time_ms, changes);
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

    /// Everything but the squares of free ground, which no look changes before it is taken in.
    fn without_ground(&self) -> Self {
        Self {
            reference: self.reference.clone(),
            objects: self.objects.clone(),
            facts: self.facts.clone(),
            changes: self.changes.clone(),
            free: BTreeMap::new(),
            ..*self
        }
    }
}
