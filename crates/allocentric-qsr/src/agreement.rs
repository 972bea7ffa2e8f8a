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
    /// With fewer than two shared objects nothing can be compared and both lists are empty. If all agree, nothing is
    /// disputed. If not, the motions through each two are tried on all (the 24 seen last, where there are more),
    /// and the one that most agree with is taken, if that is three or more; else all are disputed.
    /// The gate is [`MemoryParams::gate_sigmas`](crate::MemoryParams::gate_sigmas).
    #[must_use]
    pub fn agreement(&self, other: &Self) -> Agreement {
        let believed = |life: Life| !matches!(life, Life::Stale | Life::Missing | Life::Removed);
        let shared = other.objects.iter().filter_map(|(name, there)| {
            let here = self.objects.get(name)?;
            if !(believed(here.life) && believed(there.life)) {
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
        Agreement {
            landmarks,
            disputed: disputed.collect(),
        }
    }
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
