//! Where two robots' memories agree about what both have seen, and where they contradict each other.

use serde::{Deserialize, Serialize};

use crate::ObjectId;
use crate::frame_join::FrameJoin;
use crate::fusion::mahalanobis_squared;
use crate::ground_estimate::GroundEstimate;
use crate::life::Life;
use crate::scene_memory::SceneMemory;

/// So many landmarks must agree before the others are said to be elsewhere; of two against one, either may be right.
const LEAST_WITNESSES: usize = 3;

/// The most landmarks whose pairs are tried when not all agree, those seen last by both: the trials grow as
/// the square.
const MOST_TRIED: usize = 24;

/// A landmark: its name, its place in the one frame and in the other, and the older of its two times.
type Landmark = (ObjectId, GroundEstimate, GroundEstimate, u64);

/// What two memories say of the objects both believe in and both have in their present frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Agreement {
    /// The objects whose places agree under one motion of the frames, by name.
    pub landmarks: Vec<ObjectId>,
    /// The objects whose places no such motion brings together, by name.
    pub disputed: Vec<Disputed>,
    /// The objects that stand where the one robot has them and are gone from there for the other, by name.
    pub gone: Vec<Gone>,
}

/// An object that one robot has found gone from the place where another has it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gone {
    /// The object.
    pub object: ObjectId,
    /// Whether it is gone for this robot and there for the other; else it is there for this one.
    pub is_here: bool,
    /// Where this robot has it, or had it, `[right, forward]` in its frame, in metres.
    pub here_m: [f64; 2],
    /// Where the other has it, or had it, carried into this robot's frame, in metres.
    pub there_m: [f64; 2],
    /// When the one that believes in it saw it last, in milliseconds.
    pub seen_ms: u64,
    /// When the other found that it was gone, in milliseconds.
    pub gone_ms: u64,
    /// How many standard errors the two places lie apart: within the gate, for else it may have gone from the one
    /// place to the other.
    pub sigmas: f64,
}

/// An object that one robot has here and another there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Disputed {
    /// The object.
    pub object: ObjectId,
    /// Where this robot has it, `[right, forward]` in its frame, in metres.
    pub here_m: [f64; 2],
    /// When this robot saw it last, in milliseconds.
    pub here_time_ms: u64,
    /// Where the other robot has it, carried into this robot's frame, in metres; `None` if too few objects agree
    /// for anyone to say which of them moved.
    pub there_m: Option<[f64; 2]>,
    /// When the other robot saw it last, in milliseconds.
    pub there_time_ms: u64,
    /// How many standard errors the two places lie apart.
    pub sigmas: Option<f64>,
}

impl SceneMemory {
    /// Compares what this robot and another have seen: the largest set of shared objects that one motion of the plane
    /// takes from the other's frame into this one, and the objects that it does not.
    ///
    /// With fewer than two shared objects nothing can be compared and the lists are empty. If all agree, nothing is
    /// disputed. If not, the motions through each two are tried on all (the 24 seen last, where there are more),
    /// and the one that most agree with is taken, if that is three or more; else all are disputed.
    /// The gate is [`MemoryParams::gate_sigmas`](crate::MemoryParams::gate_sigmas).
    ///
    /// What one robot believes in and the other has found gone is compared through the same motion, if there is one:
    /// it contradicts if both mean the same place.
    #[must_use]
    pub fn agreement(&self, other: &Self) -> Agreement {
        let shared = other.objects.iter().filter_map(|(name, there)| {
            let here = self.objects.get(name)?;
            if !(believes(here.life) && believes(there.life)) {
                return None;
            }
            let places = there
                .places
                .get(&other.frame)
                .zip(here.places.get(&self.frame));
            let (from, to) = places?;
            Some((
                name.clone(),
                *from,
                *to,
                here.last_time_ms.min(there.last_time_ms),
            ))
        });
        let shared: Vec<Landmark> = shared.collect();
        if shared.len() < 2 {
            return Agreement::default();
        }
        let gate = f64::from(self.params.gate_sigmas);
        let held = if fit(shared.iter(), gate).is_some() {
            vec![true; shared.len()]
        } else {
            most_agreeing(&shared, gate)
        };
        let agreeing = || shared.iter().zip(&held).filter(|(_, held)| **held);
        let join = fit(agreeing().map(|(mark, _)| mark), gate);
        let landmarks = agreeing().map(|(mark, _)| mark.0.clone()).collect();
        let apart = shared.iter().zip(&held).filter(|(_, held)| !**held);
        let disputed = apart.map(|((name, from, to, _), _)| {
            let carried = join.as_ref().map(|join| join.moved(from));
            Disputed {
                object: name.clone(),
                here_m: to.position_m(),
                here_time_ms: self.objects[name].last_time_ms,
                there_m: carried.map(|place| place.position_m()),
                there_time_ms: other.objects[name].last_time_ms,
                sigmas: carried.map(|place| mahalanobis_squared(&place, to).sqrt()),
            }
        });
        let gone = join.as_ref().map(|join| self.gone(other, join, gate));
        Agreement {
            landmarks,
            disputed: disputed.collect(),
            gone: gone.unwrap_or_default(),
        }
    }

    /// The objects that one of two robots believes in and the other has found gone from the same place.
    fn gone(&self, other: &Self, join: &FrameJoin, gate: f64) -> Vec<Gone> {
        let gone = other.objects.iter().filter_map(|(name, there)| {
            let here = self.objects.get(name)?;
            let (is_here, gone_ms, believer) = match (here.given_up_ms, there.given_up_ms) {
                (Some(gone_ms), None) => (true, gone_ms, there),
                (None, Some(gone_ms)) => (false, gone_ms, here),
                _ => return None,
            };
            if !believes(believer.life) {
                return None;
            }
            let to = here.places.get(&self.frame)?;
            let carried = join.moved(there.places.get(&other.frame)?);
            let sigmas = mahalanobis_squared(&carried, to).sqrt();
            (sigmas <= gate).then(|| Gone {
                object: name.clone(),
                is_here,
                here_m: to.position_m(),
                there_m: carried.position_m(),
                seen_ms: believer.last_time_ms,
                gone_ms,
                sigmas,
            })
        });
        gone.collect()
    }
}

/// Whether a memory holds that an object of this life is where it was seen.
const fn believes(life: Life) -> bool {
    !matches!(life, Life::Stale | Life::Missing | Life::Removed)
}

fn fit<'a>(landmarks: impl Iterator<Item = &'a Landmark>, gate: f64) -> Option<FrameJoin> {
    let landmarks: Vec<_> = landmarks
        .map(|(name, from, to, _)| (name.clone(), *from, *to))
        .collect();
    FrameJoin::fit(&landmarks, gate)
}

/// Which landmarks agree with the motion through two of them that most agree with; none, if too few do.
fn most_agreeing(shared: &[Landmark], gate: f64) -> Vec<bool> {
    let mut tried: Vec<&Landmark> = shared.iter().collect();
    tried.sort_by_key(|mark| std::cmp::Reverse(mark.3));
    tried.truncate(MOST_TRIED);
    let mut best = vec![false; shared.len()];
    let (mut most, mut least_off) = (LEAST_WITNESSES - 1, f64::INFINITY);
    for (at, one) in tried.iter().enumerate() {
        for two in &tried[at + 1..] {
            let Some(join) = fit([*one, *two].into_iter(), gate) else {
                continue;
            };
            let off: Vec<f64> = shared
                .iter()
                .map(|mark| mahalanobis_squared(&join.moved(&mark.1), &mark.2))
                .collect();
            let held: Vec<bool> = off.iter().map(|off| *off <= gate * gate).collect();
            let count = held.iter().filter(|held| **held).count();
            let sum: f64 = off.iter().filter(|off| **off <= gate * gate).sum();
            if count < LEAST_WITNESSES || (count, -sum) <= (most, -least_off) {
                continue;
            }
            let agreeing = shared.iter().zip(&held).filter(|(_, held)| **held);
            if fit(agreeing.map(|(mark, _)| mark), gate).is_some() {
                (best, most, least_off) = (held, count, sum);
            }
        }
    }
    best
}
