use std::collections::BTreeMap;

use dorsal::allocentric_qsr::{Life, MemoryObject, ObjectId, SceneMemory};
use dorsal::egocentric_depth::{Observer, Position, StereoRig};
use dorsal::v1_gabor::Size;

use crate::fixation::Why;

/// Where to look next: at what is least known, and when all is known, at what is least sure.
///
/// *Least known* is ground that no look has measured: the fixation that shows most of it is taken. A
/// place that two looks have shown in vain, a hole or a shadow, is left alone. Where no fixation shows a
/// tenth of the field anew, things go first that looks have shown and not placed, for they are too far
/// from the fixation: those that are believed elsewhere before the others, the nearest first, each
/// at most twice. When less than a
/// fiftieth of the ground is left it is the turn of what is *least sure*: the remembered object with the largest standard error of its place, which counts
/// [`STALE_M`] more for every look since it was seen, and [`DOUBTED_M`] more while it is not believed
/// or believed gone; one that two looks at it have not found waits until the others have had theirs.
#[derive(Clone, Debug)]
pub(crate) struct Attention {
    places: Vec<Ground>,
    /// Things that the last look which showed them has not placed: where they seem to stand.
    unplaced: BTreeMap<ObjectId, [f64; 2]>,
    /// How many looks at a thing have not placed it since one has.
    in_vain: BTreeMap<ObjectId, u32>,
}

/// A thing that a look shows.
#[derive(Clone, Debug)]
pub(crate) struct SeenThing {
    pub(crate) object: ObjectId,
    /// Whether the look tells where it is.
    pub(crate) placed: bool,
    /// Where on the ground the foot of its picture lies, `[right, forward]` of the head; nothing where that is no ground.
    pub(crate) foot: Option<[f64; 2]>,
}

/// A piece of ground, whether a look has measured it, and how often one has shown it.
#[derive(Clone, Copy, Debug)]
struct Ground {
    at: [f64; 2],
    measured: bool,
    shown: u32,
}

impl Ground {
    /// Whether it is worth a look.
    const fn is_open(self) -> bool {
        !self.measured && self.shown < 2
    }
}

/// How much less sure a place is held for every look that did not show it, in metres: a hand may move
/// a thing by as much between two looks.
const STALE_M: f64 = 0.02;

/// How much less sure the place of a tentative or missing object is held, in metres.
const DOUBTED_M: f64 = 0.5;

/// The outer part of an image, at each side, in which things are cut and matches are lost.
const MARGIN: f64 = 0.12;

impl Attention {
    pub(crate) fn new(places: Vec<[f64; 2]>) -> Self {
        let ground = |at| Ground {
            at,
            measured: false,
            shown: 0,
        };
        Self {
            places: places.into_iter().map(ground).collect(),
            unplaced: BTreeMap::new(),
            in_vain: BTreeMap::new(),
        }
    }

    /// The ground, as `[right, forward]` of the head.
    pub(crate) fn places(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        self.places.iter().map(|ground| ground.at)
    }

    /// The part of the ground that some look has measured.
    pub(crate) fn known(&self) -> f64 {
        self.part(|ground| ground.measured)
    }

    fn part(&self, of: impl Fn(&Ground) -> bool) -> f64 {
        let found = self.places.iter().filter(|ground| of(ground)).count();
        found as f64 / self.places.len().max(1) as f64
    }

    /// Keeps what a look through this rig shows, and where it has `measured` something.
    pub(crate) fn looked(
        &mut self,
        rig: &StereoRig,
        size: Size,
        down_m: f64,
        measured: impl Fn([f64; 2]) -> bool,
    ) {
        for ground in &mut self.places {
            if shows(rig, size, ground.at, down_m) {
                ground.shown += 1;
                ground.measured |= measured(ground.at);
            }
        }
    }

    /// Keeps what a look shows of things. `aimed` is the one it was aimed at, if any.
    pub(crate) fn saw(&mut self, things: &[SeenThing], aimed: Option<&ObjectId>) {
        if let Some(object) = aimed {
            *self.in_vain.entry(object.clone()).or_default() += 1;
        }
        for thing in things {
            self.unplaced.remove(&thing.object);
            if thing.placed {
                self.in_vain.remove(&thing.object);
            } else if let Some(foot) = thing.foot {
                self.unplaced.insert(thing.object.clone(), foot);
            }
        }
    }

    /// Whether two looks at this thing have not placed it.
    fn is_vain(&self, object: &ObjectId) -> bool {
        self.in_vain.get(object).is_some_and(|&looks| looks >= 2)
    }

    /// The thing that is seen and not placed whose turn it is.
    fn unplaced(&self, memory: &SceneMemory) -> Option<(ObjectId, [f64; 2])> {
        let open = self.unplaced.iter().filter(|(name, _)| !self.is_vain(name));
        let (name, at) = open.min_by(|a, b| {
            let unknown = |name: &ObjectId| memory.from_robot(name).is_none();
            let away = |at: &[f64; 2]| at[0].hypot(at[1]);
            let first = unknown(a.0).cmp(&unknown(b.0));
            first.then(away(a.1).total_cmp(&away(b.1)))
        })?;
        Some((name.clone(), *at))
    }

    /// The next fixation over the ground, `[right, forward]`, and the height above it in metres.
    /// `aim` gives the eyes that fixate a place on the ground.
    pub(crate) fn next(
        &self,
        memory: &SceneMemory,
        size: Size,
        down_m: f64,
        aim: impl Fn([f64; 2]) -> Option<StereoRig>,
    ) -> Option<([f64; 2], f64, Why)> {
        let mut least_known = None;
        if self.part(|ground| ground.is_open()) > 0.02 {
            let new = |rig: &StereoRig| {
                self.places
                    .iter()
                    .filter(|ground| ground.is_open() && shows(rig, size, ground.at, down_m))
                    .count()
            };
            let gains = self.places.iter().filter_map(|ground| {
                let gain = new(&aim(ground.at)?);
                (gain > 0).then_some((gain, ground.at))
            });
            // Of equal gains the last one is taken, so the walk is reversed for the first.
            let gains: Vec<(usize, [f64; 2])> = gains.collect();
            if let Some(&(gain, at)) = gains.iter().rev().max_by_key(|(gain, _)| *gain) {
                let share = gain as f64 / self.places.len() as f64;
                least_known = Some((at, 0.0, Why::LeastKnown { share }));
                if share >= 0.1 {
                    return least_known;
                }
            }
        }
        if let Some((object, at)) = self.unplaced(memory) {
            return Some((at, 0.0, Why::Unplaced { object }));
        }
        if least_known.is_some() {
            return least_known;
        }
        let (object, at, height_m, sigma_m) = self.least_sure(memory)?;
        Some((at, height_m, Why::LeastSure { object, sigma_m }))
    }

    /// The object from which most is seen again that was not seen for long: its name, place, height, and how many
    /// looks have not shown it. What counts is the number of looks since each object was placed, over all
    /// that the fixation shows. Nothing if the last look has placed everything.
    pub(crate) fn long_unseen(
        &self,
        memory: &SceneMemory,
        size: Size,
        down_m: f64,
        aim: impl Fn([f64; 2]) -> Option<StereoRig>,
    ) -> Option<(ObjectId, [f64; 2], f64, u64)> {
        let things = memory.objects().filter_map(|(name, kept)| {
            let place = memory.from_robot(name)?;
            let looks = memory.looks().saturating_sub(kept.last_look);
            let at = [place.right_m, place.forward_m];
            (kept.life != Life::Missing).then_some((name, kept, at, looks))
        });
        let things: Vec<(&ObjectId, &MemoryObject, [f64; 2], u64)> = things.collect();
        let fixations = things.iter().filter_map(|&(name, kept, at, looks)| {
            let rig = aim(at)?;
            let shown = things
                .iter()
                .filter(|(.., at, _)| shows(&rig, size, *at, down_m));
            let gain: u64 = shown.map(|(.., looks)| looks).sum();
            let height_m = f64::from(kept.height_mm) / 1e3;
            (looks > 0).then_some((
                self.is_vain(name),
                gain,
                (name.clone(), at, height_m, looks),
            ))
        });
        // What two looks have not found comes last; of equal gains the first is taken.
        let best = fixations.min_by_key(|(vain, gain, _)| (*vain, std::cmp::Reverse(*gain)))?;
        Some(best.2)
    }

    /// The object whose place is least sure: its name, place, height and standard error.
    fn least_sure(&self, memory: &SceneMemory) -> Option<(ObjectId, [f64; 2], f64, f64)> {
        let doubts = memory.objects().filter_map(|(name, kept)| {
            let place = memory.from_robot(name)?;
            let [[rr, _], [_, ff]] = place.covariance_m2;
            let sigma_m = (rr + ff).sqrt();
            let stale = memory.looks().saturating_sub(kept.last_look) as f64 * STALE_M;
            let doubted = match kept.life {
                Life::Tentative | Life::Missing => DOUBTED_M,
                _ => 0.0,
            };
            let at = [place.right_m, place.forward_m];
            let height_m = f64::from(kept.height_mm) / 1e3;
            Some((sigma_m + stale + doubted, name, at, height_m, sigma_m))
        });
        let (_, name, at, height_m, sigma_m) = doubts.max_by(|a, b| {
            let found = |name| !self.is_vain(name);
            found(a.1).cmp(&found(b.1)).then(a.0.total_cmp(&b.0))
        })?;
        Some((name.clone(), at, height_m, sigma_m))
    }
}

/// Whether both eyes have a place of the ground well inside their images.
pub(crate) fn shows(rig: &StereoRig, size: Size, [right, forward]: [f64; 2], down_m: f64) -> bool {
    let point = rig.to_head(Position::<Observer>::new(right, down_m, forward));
    let inside = |at: f64, length: usize| {
        let length = length as f64;
        (MARGIN * length..(1.0 - MARGIN) * length).contains(&at)
    };
    rig.project(point).is_some_and(|eyes| {
        [eyes.left, eyes.right]
            .into_iter()
            .all(|(x, y)| inside(x, size.width) && inside(y, size.height))
    })
}
