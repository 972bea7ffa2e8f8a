use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::f64::consts::FRAC_PI_4;

use serde::{Deserialize, Serialize};

use crate::depth_reference::DepthReference;
use crate::egocentric_place::{EgocentricPlace, read_between, read_offset};
use crate::polar_box::PolarBox;
use crate::sighting::{BadSighting, Sighting};
use crate::{Mode, ObjectId, OrientationSet, Places, Reason, Relation};

/// How numbers become symbols.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct QualifyParams {
    /// Half the width of the intervals that may contain the truth, in standard errors; at most
    /// 1000.
    pub sigmas: f64,
    /// How far from a ray a bearing may be, in radians below pi/4, for a person to read the
    /// ray's label.
    pub axis_tolerance_rad: f64,
}

impl Default for QualifyParams {
    /// Three standard errors; a ray is read within 0.1 rad, 5.7 degrees.
    fn default() -> Self {
        Self {
            sigmas: 3.0,
            axis_tolerance_rad: 0.1,
        }
    }
}

/// One look in symbols: where each object is for the observer, with the sightings behind it.
///
/// Objects are ordered by name; an empty look is a scene too.
#[derive(Clone, Debug, PartialEq)]
pub struct QualitativeScene {
    reference: DepthReference,
    params: QualifyParams,
    seen: BTreeMap<ObjectId, Seen>,
}

#[derive(Clone, Debug, PartialEq)]
struct Seen {
    sighting: Sighting,
    place: EgocentricPlace,
}

impl Default for QualitativeScene {
    /// A look at nothing, in the classes of [`DepthReference::robot_120`].
    fn default() -> Self {
        Self {
            reference: DepthReference::robot_120(),
            params: QualifyParams::default(),
            seen: BTreeMap::new(),
        }
    }
}

impl QualitativeScene {
    /// Qualifies the sightings of one look with the default [`QualifyParams`].
    ///
    /// # Errors
    /// [`BadSighting`] names the object and the number that cannot be.
    pub fn qualify(
        sightings: impl IntoIterator<Item = Sighting>,
        reference: &DepthReference,
    ) -> Result<Self, BadSighting> {
        Self::qualify_with(sightings, reference, QualifyParams::default())
    }

    /// Qualifies the sightings of one look.
    ///
    /// # Errors
    /// [`BadSighting`] names the object and the number that cannot be, or the parameter.
    pub fn qualify_with(
        sightings: impl IntoIterator<Item = Sighting>,
        reference: &DepthReference,
        params: QualifyParams,
    ) -> Result<Self, BadSighting> {
        params.check()?;
        let mut seen = BTreeMap::new();
        for sighting in sightings {
            sighting.check()?;
            let place = EgocentricPlace {
                object: sighting.object.clone(),
                places: PolarBox::of_sighting(&sighting, params.sigmas).egocentric(reference),
                read: read_offset(offset(&sighting), reference, params.axis_tolerance_rad),
                mode: Mode::Sound,
            };
            match seen.entry(sighting.object.clone()) {
                Entry::Occupied(earlier) => return Err(BadSighting::Twice(earlier.key().clone())),
                Entry::Vacant(free) => free.insert(Seen { sighting, place }),
            };
        }
        Ok(Self {
            reference: reference.clone(),
            params,
            seen,
        })
    }

    /// The reference system of the distance classes.
    #[must_use]
    pub const fn reference(&self) -> &DepthReference {
        &self.reference
    }

    /// How the numbers became symbols.
    #[must_use]
    pub const fn params(&self) -> QualifyParams {
        self.params
    }

    /// The sightings, by name.
    pub fn sightings(&self) -> impl Iterator<Item = &Sighting> {
        self.seen.values().map(|seen| &seen.sighting)
    }

    /// Where each object is for the observer, by name.
    pub fn places(&self) -> impl Iterator<Item = &EgocentricPlace> {
        self.seen.values().map(|seen| &seen.place)
    }

    /// Where this object is for the observer.
    #[must_use]
    pub fn place(&self, object: &ObjectId) -> Option<&EgocentricPlace> {
        self.seen.get(object).map(|seen| &seen.place)
    }

    /// Where `to` is at `from`, from the intervals around both positions; `None` if one of them
    /// is not seen, or both are one.
    #[must_use]
    pub fn relation(&self, from: &ObjectId, to: &ObjectId) -> Option<Relation> {
        if from == to {
            return None;
        }
        let (first, second) = (self.sighting(from)?, self.sighting(to)?);
        Some(Relation {
            from: from.clone(),
            to: to.clone(),
            places: self.measured(first, second),
            read: Some(read_between(
                offset(first),
                offset(second),
                &self.reference,
                self.params.axis_tolerance_rad,
            )),
            mode: Mode::Sound,
            reason: Reason::Measured { looks: [1, 1] },
        })
    }

    /// The measured relations of all ordered pairs of different objects, by name.
    #[must_use]
    pub fn relations(&self) -> Vec<Relation> {
        let names = || self.seen.keys();
        names()
            .flat_map(|from| names().map(move |to| (from, to)))
            .filter_map(|(from, to)| self.relation(from, to))
            .collect()
    }

    pub(crate) fn sighting(&self, object: &ObjectId) -> Option<&Sighting> {
        self.seen.get(object).map(|seen| &seen.sighting)
    }

    /// The label of `to` at the observer against the direction to `from`, within the errors.
    pub(crate) fn turn(&self, from: &Sighting, to: &Sighting) -> OrientationSet {
        let seen = |sighting| PolarBox::of_sighting(sighting, self.params.sigmas);
        seen(from).turn_to(seen(to))
    }

    fn measured(&self, from: &Sighting, to: &Sighting) -> Places {
        let seen = |sighting| PolarBox::of_sighting(sighting, self.params.sigmas);
        seen(from).places_of(seen(to), &self.reference)
    }
}

impl QualifyParams {
    pub(crate) fn check(self) -> Result<(), BadSighting> {
        if !(0.0..=1000.0).contains(&self.sigmas) {
            return Err(BadSighting::Sigmas(self.sigmas));
        }
        if !(0.0..FRAC_PI_4).contains(&self.axis_tolerance_rad) {
            return Err(BadSighting::Tolerance(self.axis_tolerance_rad));
        }
        Ok(())
    }
}

/// The position of a sighting, `[ahead, leftward]` of the observer in metres.
fn offset(sighting: &Sighting) -> [f64; 2] {
    let (sin, cos) = sighting.bearing_rad.sin_cos();
    [sighting.distance_m * sin, -sighting.distance_m * cos]
}
