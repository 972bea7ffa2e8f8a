use std::collections::BTreeMap;
use std::f64::consts::FRAC_PI_2;

use crate::double_cross::at_second;
use crate::egocentric_place::EgocentricPlace;
use crate::qualitative_scene::QualitativeScene;
use crate::sighting::Sighting;
use crate::triangle_table::TriangleTable;
use crate::{Case, DepthSet, Mode, ObjectId, Orientation, OrientationSet, Places, compose};

/// What one look says about two objects it shows, without any third: the step from the observer
/// to the objects (Figure 3).
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Premise {
    /// The classes of the distance between them.
    pub(crate) depth: DepthSet,
    /// The second at the first, against the direction from the observer to the first.
    pub(crate) second_at_first: OrientationSet,
    /// The first at the second, against the direction from the observer to the second.
    pub(crate) first_at_second: OrientationSet,
    /// The look that shows both, counted from 1.
    pub(crate) look: u64,
}

/// Premises by pair; the names of a pair ascend.
pub(crate) type Premises = BTreeMap<(ObjectId, ObjectId), Premise>;

/// The premises of every pair of a scene.
pub(crate) fn premises_of(scene: &QualitativeScene, mode: Mode, look: u64) -> Premises {
    // The published step needs no table; the sound one is planned once for all pairs.
    let table = (mode == Mode::Sound).then(|| TriangleTable::plan(scene.reference()));
    let step = |first: &EgocentricPlace, second: &EgocentricPlace| match &table {
        None => published_step(scene, first, second),
        Some(table) => sound_step(scene, table, first, second),
    };
    let mut premises = Premises::new();
    for first in scene.places() {
        for second in scene.places().filter(|place| place.object > first.object) {
            let there = step(first, second);
            let back = step(second, first);
            let premise = Premise {
                depth: there.depth & back.depth,
                second_at_first: there.orientation,
                first_at_second: back.orientation,
                look,
            };
            premises.insert((first.object.clone(), second.object.clone()), premise);
        }
    }
    premises
}

/// CASE 3 of the published calculus on the classes a person reads, as the paper reasons from
/// centroids; the labels that go with the turn are those of the double cross.
fn published_step(
    scene: &QualitativeScene,
    from: &EgocentricPlace,
    to: &EgocentricPlace,
) -> Places {
    let bearing = |place: &EgocentricPlace| {
        scene
            .sighting(&place.object)
            .map_or(0.0, |sighting| sighting.bearing_rad)
    };
    let turn = Orientation::of_bearing(FRAC_PI_2 + bearing(to) - bearing(from));
    let (first, second) = (from.read.depth.into(), to.read.depth.into());
    Places {
        depth: compose(
            scene.reference(),
            Case::Three,
            Mode::Published,
            first,
            second,
        )
        .depth,
        orientation: turn.map_or(OrientationSet::ALL, |turn| at_second(turn.into())),
    }
}

/// The triangle relation on every class and turn within the errors.
fn sound_step(
    scene: &QualitativeScene,
    table: &TriangleTable,
    from: &EgocentricPlace,
    to: &EgocentricPlace,
) -> Places {
    let sightings: Option<(&Sighting, &Sighting)> =
        scene.sighting(&from.object).zip(scene.sighting(&to.object));
    let turn = sightings.map_or(OrientationSet::ALL, |(first, second)| {
        scene.turn(first, second)
    });
    if from.places.orientation.contains(Orientation::None) {
        // The observer may stand at the first object, and the triangle needs two points.
        return Places {
            depth: compose(
                scene.reference(),
                Case::Three,
                Mode::Sound,
                from.places.depth,
                to.places.depth,
            )
            .depth,
            orientation: OrientationSet::ALL,
        };
    }
    table
        .between(from.places.depth, to.places.depth, turn)
        .places()
}
