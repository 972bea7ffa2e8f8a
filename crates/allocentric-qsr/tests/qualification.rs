//! From numbers to symbols: what may hold contains what is, and what cannot be is refused.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod systems;

use std::f64::consts::FRAC_PI_2;

use allocentric_qsr::{
    BadSighting, DepthReference, Inference, Mode, ObjectId, Orientation, Place, QualifyParams,
    QualitativeScene, Reason, Sighting,
};
use proptest::prelude::*;
use systems::systems;

fn sighting(object: &str, distance_m: f64, bearing_rad: f64) -> Sighting {
    Sighting {
        object: object.into(),
        distance_m,
        bearing_rad,
        sigma_distance_m: 0.01,
        sigma_bearing_rad: 0.005,
    }
}

fn scene(sightings: impl IntoIterator<Item = Sighting>) -> QualitativeScene {
    QualitativeScene::qualify(sightings, &DepthReference::robot_120()).unwrap()
}

#[test]
fn what_cannot_be_is_refused() {
    let reference = DepthReference::drs1();
    let refuse = |change: fn(&mut Sighting)| {
        let mut bad = sighting("cup", 1.0, 1.0);
        change(&mut bad);
        QualitativeScene::qualify([bad], &reference).unwrap_err()
    };
    for error in [
        refuse(|s| s.distance_m = -0.1),
        refuse(|s| s.distance_m = f64::NAN),
        refuse(|s| s.distance_m = f64::INFINITY),
        refuse(|s| s.distance_m = 2e6),
    ] {
        assert!(matches!(error, BadSighting::Distance { .. }), "{error}");
    }
    assert!(matches!(
        refuse(|s| s.bearing_rad = f64::NAN),
        BadSighting::Bearing { .. }
    ));
    let vague = refuse(|s| s.sigma_bearing_rad = 1e4);
    assert!(matches!(vague, BadSighting::Sigma { .. }));
    assert!(matches!(
        refuse(|s| s.sigma_distance_m = -1.0),
        BadSighting::Sigma { .. }
    ));
    assert!(matches!(
        refuse(|s| s.sigma_bearing_rad = f64::INFINITY),
        BadSighting::Sigma { .. }
    ));
    let twice = [
        sighting("cup", 1.0, 1.0),
        sighting("box", 1.0, 1.0),
        sighting("cup", 2.0, 1.0),
    ];
    assert_eq!(
        QualitativeScene::qualify(twice, &reference),
        Err(BadSighting::Twice("cup".into()))
    );
    for (sigmas, axis_tolerance_rad) in [
        (-1.0, 0.1),
        (f64::NAN, 0.1),
        (1e9, 0.1),
        (3.0, 1.0),
        (3.0, -0.1),
    ] {
        let params = QualifyParams {
            sigmas,
            axis_tolerance_rad,
        };
        assert!(QualitativeScene::qualify_with([], &reference, params).is_err());
    }
}

#[test]
fn an_empty_look_is_a_scene() {
    let scene = scene([]);
    assert_eq!(scene.places().count(), 0);
    assert_eq!(scene.relations(), []);
    assert_eq!(
        Inference::of_scene(&scene, Mode::Published)
            .relations()
            .count(),
        0
    );
}

#[test]
fn a_bearing_within_its_error_of_an_axis_is_read_as_the_axis() {
    let scene = scene([sighting("cup", 0.7, FRAC_PI_2 + 0.01)]);
    let place = scene.place(&"cup".into()).unwrap();
    assert_eq!(place.read.orientation, Orientation::StraightFront);
    assert_eq!(place.places.orientation.labels(), ["fl", "sf", "fr"]);
    assert_eq!(scene.reference().labels(place.places.depth), ["c"]);
    let record = serde_json::to_value(place.record(scene.reference())).unwrap();
    let expected = serde_json::json!({
        "object": "cup", "depth": ["c"], "orientation": ["fl", "sf", "fr"],
        "read": {"depth": "c", "orientation": "sf"}, "mode": "sound",
    });
    assert_eq!(record, expected);
}

/// Figure 2's directions on the ground: front is from the observer to the first object.
#[test]
fn relations_are_told_from_the_observer_through_the_first_object() {
    let at = |ahead: f64, leftward: f64| (ahead.hypot(leftward), leftward.atan2(ahead) + FRAC_PI_2);
    let seen = |name, (distance, bearing)| sighting(name, distance, bearing);
    let scene = scene([
        seen("a", at(1.0, 0.0)),
        seen("beyond", at(1.4, 0.0)),
        seen("left", at(1.0, 0.4)),
        seen("right", at(1.0, -0.4)),
        seen("near", at(0.6, 0.0)),
        seen("near_left", at(0.6, 0.4)),
    ]);
    let label = |to: &str| {
        let relation = scene.relation(&"a".into(), &to.into()).unwrap();
        let read = relation.read.unwrap();
        assert!(relation.places.contains(read));
        assert_eq!(relation.mode, Mode::Sound);
        assert_eq!(relation.reason, Reason::Measured { looks: [1, 1] });
        read.orientation.short()
    };
    assert_eq!(label("beyond"), "sf");
    assert_eq!(label("left"), "l");
    assert_eq!(label("right"), "r");
    assert_eq!(label("near"), "sb");
    assert_eq!(label("near_left"), "bl");
    assert_eq!(scene.relation(&"a".into(), &"a".into()), None);
    assert_eq!(scene.relation(&"a".into(), &"ghost".into()), None);
    assert_eq!(scene.relations().len(), 6 * 5);
    let record = scene.relation(&"a".into(), &"left".into()).unwrap();
    let record = serde_json::to_value(record.record(scene.reference())).unwrap();
    let expected = serde_json::json!({
        "from": "a", "to": "left", "depth": ["vc"], "orientation": ["fl", "l", "bl"],
        "read": {"depth": "vc", "orientation": "l"}, "mode": "sound",
        "reason": {"by": "measured", "looks": [1, 1]},
    });
    assert_eq!(record, expected);
}

/// The label of an object at another, and its distance, from offsets `[ahead, leftward]`.
fn truth(reference: &DepthReference, from: [f64; 2], to: [f64; 2]) -> Place {
    let between = [to[0] - from[0], to[1] - from[1]];
    Place {
        depth: reference.qualify(between[0].hypot(between[1])).unwrap(),
        orientation: Orientation::of_offset(
            from[0] * between[0] + from[1] * between[1],
            from[0] * between[1] - from[1] * between[0],
        ),
    }
}

proptest! {
    /// Wherever the objects truly are within three standard errors, the relations contain it,
    /// measured or inferred soundly.
    #[test]
    fn what_may_hold_contains_what_is(
        reference in systems(3000),
        objects in proptest::collection::vec(
            (0.05..3.0f64, -4.0..4.0f64, 0.0..0.05f64, 0.0..0.1f64, -2.99..2.99f64, -2.99..2.99f64),
            1..5,
        ),
    ) {
        let name = |k: usize| ObjectId::new(format!("o{k}"));
        let sightings = objects.iter().enumerate().map(|(k, &(distance, bearing, sd, sb, ..))| Sighting {
            object: name(k),
            distance_m: distance,
            bearing_rad: bearing,
            sigma_distance_m: sd,
            sigma_bearing_rad: sb,
        });
        let scene = QualitativeScene::qualify(sightings, &reference).unwrap();
        let inferred = Inference::of_scene(&scene, Mode::Sound);
        prop_assert!(inferred.disputes().is_empty());
        let positions: Vec<[f64; 2]> = objects.iter().map(|&(distance, bearing, sd, sb, u, v)| {
            let (sin, cos) = (bearing + v * sb).sin_cos();
            let distance = (distance + u * sd).max(0.0);
            [distance * sin, -distance * cos]
        }).collect();
        for (i, &from) in positions.iter().enumerate() {
            let place = scene.place(&name(i)).unwrap();
            let is = Place {
                depth: reference.qualify(from[0].hypot(from[1])).unwrap(),
                orientation: Orientation::of_offset(from[0], from[1]),
            };
            prop_assert!(place.places.contains(is));
            for (j, &to) in positions.iter().enumerate().filter(|&(j, _)| j != i) {
                let is = truth(&reference, from, to);
                let measured = scene.relation(&name(i), &name(j)).unwrap();
                prop_assert!(measured.places.contains(is));
                let composed = inferred.relation(&name(i), &name(j)).unwrap();
                prop_assert!(composed.places.contains(is));
                prop_assert_eq!(composed.mode, Mode::Sound);
            }
        }
    }
}
