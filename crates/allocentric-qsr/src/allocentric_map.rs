use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::depth_reference::DepthReference;
use crate::egocentric_place::{EgocentricPlace, read_between, read_offset};
use crate::ground_estimate::GroundEstimate;
use crate::ground_pose::GroundPose;
use crate::map_record::{BadMap, MapRecord};
use crate::premise::{Premises, premises_of};
use crate::qualitative_scene::{QualifyParams, QualitativeScene};
use crate::sighting::BadSighting;
use crate::{Inference, Mode, ObjectId, Places, Reason, Relation};

/// Where things are, independent of where the observer looks: relations outlive the view.
///
/// Every object keeps the position, in the frame of the first observer, where it was last seen,
/// and the look in which that was. Relations are qualified from those positions when asked for,
/// seen from the present observer or any other. Beside them stands what follows by the published
/// composition alone, to its fixpoint over all looks ([`AllocentricMap::inference`]).
///
/// A map is a value: [`AllocentricMap::with`] gives a new one, and the old one stands if the
/// look contradicts it. As data it is an object with `"schema": "dorsal-map/1"`; what is written
/// and read again is equal and writes the same bytes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "MapRecord", into = "MapRecord")]
pub struct AllocentricMap {
    pub(crate) reference: DepthReference,
    pub(crate) params: QualifyParams,
    pub(crate) looks: u64,
    pub(crate) pose: GroundPose,
    pub(crate) remembered: BTreeMap<ObjectId, Remembered>,
    pub(crate) premises: Premises,
    pub(crate) inference: Inference,
}

/// What a map keeps of an object.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Remembered {
    /// The look that shows it last, counted from 1.
    pub last_seen: u64,
    /// Where it was then, in the map frame.
    pub estimate: GroundEstimate,
}

/// An object that is not where the map remembers it: the premises of a contradiction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Moved {
    /// The object.
    pub object: ObjectId,
    /// Where and when the map has it.
    pub remembered: Remembered,
    /// Where the look has it.
    pub seen: GroundEstimate,
}

/// Why a look cannot be true together with the map.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Inconsistent {
    /// The look is qualified by another reference system.
    #[error("the look speaks `{look}`, the map `{map}`: qualify both by one reference system")]
    Reference {
        /// The reference system of the map.
        map: String,
        /// The reference system of the look.
        look: String,
    },
    /// Objects are seen where the map does not have them, beyond the errors of both.
    #[error(
        "{} not where the map has them ({} of {known} known objects in view): \
         forget those that moved; if all did, the pose is wrong",
        names(.moved), .moved.len()
    )]
    Moved {
        /// The objects, by name.
        moved: Vec<Moved>,
        /// How many objects of the look the map knows.
        known: usize,
    },
}

impl AllocentricMap {
    /// An empty map: nothing seen, the observer at the origin.
    ///
    /// # Errors
    /// [`BadSighting::Sigmas`] or [`BadSighting::Tolerance`] if a parameter cannot be.
    pub fn new(reference: &DepthReference, params: QualifyParams) -> Result<Self, BadSighting> {
        params.check()?;
        let premises = Premises::new();
        Ok(Self {
            reference: reference.clone(),
            params,
            looks: 0,
            pose: GroundPose::default(),
            remembered: BTreeMap::new(),
            inference: Inference::close(reference, Mode::Published, &premises),
            premises,
        })
    }

    /// The map after one more look, taken from `pose`; the default pose is one that has not
    /// moved since the first look.
    ///
    /// What the look shows takes its new position; everything else stays where it was last
    /// seen. An empty look counts and changes nothing else.
    ///
    /// # Errors
    /// [`Inconsistent`] if a known object is seen beyond the errors of where it was; this map
    /// stands as it was.
    pub fn with(&self, scene: &QualitativeScene, pose: GroundPose) -> Result<Self, Inconsistent> {
        if *scene.reference() != self.reference {
            return Err(Inconsistent::Reference {
                map: self.reference.name().to_owned(),
                look: scene.reference().name().to_owned(),
            });
        }
        let look = self.looks + 1;
        let seen: BTreeMap<ObjectId, GroundEstimate> = scene
            .sightings()
            .map(|s| (s.object.clone(), GroundEstimate::of_sighting(s, pose)))
            .collect();
        self.agrees(&seen)?;
        let mut next = self.clone();
        next.looks = look;
        next.pose = pose;
        next.remembered
            .extend(seen.into_iter().map(|(object, estimate)| {
                let last_seen = look;
                (
                    object,
                    Remembered {
                        last_seen,
                        estimate,
                    },
                )
            }));
        next.premises
            .extend(premises_of(scene, Mode::Published, look));
        next.infer();
        Ok(next)
    }

    /// The map without one object: for what is known to have moved or gone.
    #[must_use]
    pub fn forget(&self, object: &ObjectId) -> Self {
        let mut next = self.clone();
        next.remembered.remove(object);
        next.premises
            .retain(|(first, second), _| first != object && second != object);
        next.infer();
        next
    }

    /// The reference system of the distance classes.
    #[must_use]
    pub const fn reference(&self) -> &DepthReference {
        &self.reference
    }

    /// How many looks the map has taken.
    #[must_use]
    pub const fn looks(&self) -> u64 {
        self.looks
    }

    /// Where the last look was taken from.
    #[must_use]
    pub const fn pose(&self) -> GroundPose {
        self.pose
    }

    /// Every object of the map, in view or not, by name.
    pub fn objects(&self) -> impl Iterator<Item = (&ObjectId, &Remembered)> {
        self.remembered.iter()
    }

    /// The look that showed this object last, counted from 1.
    #[must_use]
    pub fn last_seen(&self, object: &ObjectId) -> Option<u64> {
        self.remembered.get(object).map(|kept| kept.last_seen)
    }

    /// Where this object is for an observer at `pose`, seen or unseen.
    #[must_use]
    pub fn place_from(&self, pose: GroundPose, object: &ObjectId) -> Option<EgocentricPlace> {
        let estimate = self.remembered.get(object)?.estimate;
        let bounds = estimate.bounds(self.params.sigmas).seen_from(pose);
        Some(EgocentricPlace {
            object: object.clone(),
            places: bounds.egocentric(&self.reference),
            read: read_offset(
                estimate.seen_from(pose),
                &self.reference,
                self.params.axis_tolerance_rad,
            ),
            mode: Mode::Sound,
        })
    }

    /// What may hold of `to` at `from`, seen from the present observer; `None` if the map does
    /// not know one of them.
    #[must_use]
    pub fn places(&self, from: &ObjectId, to: &ObjectId) -> Option<Places> {
        self.relation(from, to).map(|relation| relation.places)
    }

    /// Where `to` is at `from`, seen from the present observer, from the intervals around both
    /// positions.
    #[must_use]
    pub fn relation(&self, from: &ObjectId, to: &ObjectId) -> Option<Relation> {
        self.relation_from(self.pose, from, to)
    }

    /// Where `to` is at `from`, seen by an observer at `pose`; `None` if the map does not know
    /// one of them, or both are one.
    #[must_use]
    pub fn relation_from(
        &self,
        pose: GroundPose,
        from: &ObjectId,
        to: &ObjectId,
    ) -> Option<Relation> {
        if from == to {
            return None;
        }
        let (first, second) = (self.remembered.get(from)?, self.remembered.get(to)?);
        let seen = |kept: &Remembered| kept.estimate.bounds(self.params.sigmas).seen_from(pose);
        Some(Relation {
            from: from.clone(),
            to: to.clone(),
            places: seen(first).places_of(seen(second), &self.reference),
            read: Some(read_between(
                first.estimate.seen_from(pose),
                second.estimate.seen_from(pose),
                &self.reference,
                self.params.axis_tolerance_rad,
            )),
            mode: Mode::Sound,
            reason: Reason::Measured {
                looks: [first.last_seen, second.last_seen],
            },
        })
    }

    /// The relations of all ordered pairs of different objects, seen from the present observer,
    /// by name.
    #[must_use]
    pub fn relations(&self) -> Vec<Relation> {
        let names = || self.remembered.keys();
        names()
            .flat_map(|from| names().map(move |to| (from, to)))
            .filter_map(|(from, to)| self.relation(from, to))
            .collect()
    }

    /// What follows by the published composition from all looks together. The labels of a pair
    /// hold for the observer of the last look that showed both.
    #[must_use]
    pub const fn inference(&self) -> &Inference {
        &self.inference
    }

    /// Whether every known object is seen where it was, within the errors of both.
    fn agrees(&self, seen: &BTreeMap<ObjectId, GroundEstimate>) -> Result<(), Inconsistent> {
        let known: Vec<Moved> = seen
            .iter()
            .filter_map(|(object, &seen)| {
                self.remembered.get(object).map(|&remembered| Moved {
                    object: object.clone(),
                    remembered,
                    seen,
                })
            })
            .collect();
        let count = known.len();
        let sigmas = self.params.sigmas;
        let apart = |m: &Moved| {
            let remembered = m.remembered.estimate.bounds(sigmas);
            !remembered.overlaps(&m.seen.bounds(sigmas))
        };
        let moved: Vec<Moved> = known.into_iter().filter(apart).collect();
        if moved.is_empty() {
            Ok(())
        } else {
            Err(Inconsistent::Moved {
                moved,
                known: count,
            })
        }
    }

    fn infer(&mut self) {
        self.inference = Inference::close(&self.reference, Mode::Published, &self.premises);
    }
}

/// The names of the objects, for a sentence.
fn names(moved: &[Moved]) -> String {
    let names: Vec<String> = moved.iter().map(|m| format!("`{}`", m.object)).collect();
    names.join(", ")
}

impl From<AllocentricMap> for MapRecord {
    fn from(map: AllocentricMap) -> Self {
        Self::of(&map)
    }
}

impl TryFrom<MapRecord> for AllocentricMap {
    type Error = BadMap;
    fn try_from(record: MapRecord) -> Result<Self, BadMap> {
        record.into_map()
    }
}
