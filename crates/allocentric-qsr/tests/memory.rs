//! What the map keeps, refuses and tells.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use std::f64::consts::FRAC_PI_2;

use allocentric_qsr::{
    AllocentricMap, DepthReference, GroundPose, Inconsistent, Mode, ObjectId, Orientation,
    OrientationSet, Place, QualifyParams, QualitativeScene, Reason, Sighting,
};
use proptest::prelude::*;

fn id(name: &str) -> ObjectId {
    name.into()
}

/// What an observer at `pose` sees of an object at `[x, z]` in the map frame.
fn sighting(object: &str, [x, z]: [f64; 2], pose: GroundPose) -> Sighting {
    let (right, forward) = (x - pose.x_m(), z - pose.z_m());
    Sighting {
        object: object.into(),
        distance_m: right.hypot(forward),
        bearing_rad: forward.atan2(right) - pose.heading_rad(),
        sigma_distance_m: 0.01,
        sigma_bearing_rad: 0.005,
    }
}

fn look<'o>(
    objects: impl IntoIterator<Item = (&'o str, [f64; 2])>,
    pose: GroundPose,
) -> QualitativeScene {
    let seen = objects
        .into_iter()
        .map(|(name, at)| sighting(name, at, pose));
    QualitativeScene::qualify(seen, &DepthReference::robot_120()).unwrap()
}

fn empty() -> AllocentricMap {
    AllocentricMap::new(&DepthReference::robot_120(), QualifyParams::default()).unwrap()
}

const CD_BOX: (&str, [f64; 2]) = ("cd_box", [-0.10, 0.80]);
const PC_SCREEN: (&str, [f64; 2]) = ("pc_screen", [0.32, 0.80]);
const CUP: (&str, [f64; 2]) = ("cup", [-0.45, 0.70]);

/// Figure 12: after a scrutiny of the room the screen is out of view, and the robot still knows
/// that it is very close to the box and on its right.
#[test]
fn the_screen_is_kept_out_of_view() {
    let start = GroundPose::default();
    let map = empty()
        .with(&look([CD_BOX, PC_SCREEN], start), start)
        .unwrap();
    // The robot steps aside and turns left until the screen leaves its view.
    let moved = GroundPose::new(-0.15, 0.05, 0.5).unwrap();
    let map = map.with(&look([CD_BOX, CUP], moved), moved).unwrap();

    assert_eq!(map.last_seen(&id("pc_screen")), Some(1));
    assert_eq!(map.last_seen(&id("cd_box")), Some(2));
    let relation = map.relation(&id("cd_box"), &id("pc_screen")).unwrap();
    assert_eq!(map.reference().labels(relation.places.depth), ["vc"]);
    let rightward = OrientationSet::from_iter([
        Orientation::FrontRight,
        Orientation::Right,
        Orientation::BackRight,
    ]);
    assert!(relation.places.orientation.is_subset(rightward));
    assert_eq!(relation.read.unwrap().orientation, Orientation::Right);
    assert_eq!(relation.reason, Reason::Measured { looks: [2, 1] });
    assert_eq!(
        map.places(&id("cd_box"), &id("pc_screen")),
        Some(relation.places)
    );

    // The arm finds the screen, unseen, ahead and to the right.
    let place = map.place_from(moved, &id("pc_screen")).unwrap();
    assert_eq!(place.read.orientation, Orientation::FrontRight);

    // The published inference keeps the pair it saw together, and reaches the cup through the box.
    let kept = map
        .inference()
        .relation(&id("cd_box"), &id("pc_screen"))
        .unwrap();
    assert_eq!(kept.mode, Mode::Published);
    assert_eq!(map.reference().labels(kept.places.depth), ["vc"]);
    assert!(kept.places.orientation.is_subset(rightward));
    let derived = map
        .inference()
        .relation(&id("cup"), &id("pc_screen"))
        .unwrap();
    let reason = Reason::Composed {
        look: None,
        through: vec![id("cd_box")],
    };
    assert_eq!(derived.reason, reason);
    // Two steps within very close (60 cm) end within 120 cm, the class at the upper end included.
    assert_eq!(
        map.reference().labels(derived.places.depth),
        ["vc", "c", "n", "f"]
    );
}

/// The published calculus refutes itself where two looks disagree: seen from afar, CASE 3 calls
/// any two objects very far from each other. The composition is set aside, and told.
#[test]
fn published_compositions_that_leave_nothing_are_disputes() {
    let (near, afar) = (
        GroundPose::default(),
        GroundPose::new(0.0, 3.6, std::f64::consts::PI).unwrap(),
    );
    let (i, j, k) = (("i", [0.0, 0.5]), ("j", [0.3, 0.5]), ("k", [0.2, 0.4]));
    let map = empty().with(&look([i, j], near), near).unwrap();
    let map = map.with(&look([i, k], afar), afar).unwrap();
    let map = map.with(&look([j, k], near), near).unwrap();
    let labels = |a, b| {
        let relation = map.inference().relation(&id(a), &id(b)).unwrap();
        map.reference().labels(relation.places.depth)
    };
    assert_eq!(labels("i", "j"), ["vc"]);
    assert_eq!(labels("i", "k"), ["vf"]);
    assert_eq!(labels("j", "k"), ["vc"]);
    let disputes = map.inference().disputes();
    let about = disputes.iter().find(|d| d.through == id("k")).unwrap();
    assert_eq!(about.between, [id("i"), id("j")]);
    assert_eq!(map.reference().labels(about.kept), ["vc"]);
    assert_eq!(map.reference().labels(about.refused), ["vf"]);
    // What is measured does not care.
    let measured = map.places(&id("i"), &id("k")).unwrap();
    assert_eq!(map.reference().labels(measured.depth), ["vc"]);
}

#[test]
fn an_object_that_moved_is_a_contradiction_with_its_premises() {
    let pose = GroundPose::default();
    let map = empty()
        .with(&look([CD_BOX, PC_SCREEN], pose), pose)
        .unwrap();
    let before = map.clone();
    let moved = look([("cd_box", [-0.10, 1.00]), PC_SCREEN], pose);
    let Err(Inconsistent::Moved {
        moved: found,
        known,
    }) = map.with(&moved, pose)
    else {
        panic!("the box is 20 cm from where it was, with an error of 1 cm");
    };
    assert_eq!(known, 2);
    assert_eq!(found.len(), 1);
    assert_eq!(found[0].object, id("cd_box"));
    assert_eq!(found[0].remembered.last_seen, 1);
    assert_eq!(map, before);
    // Forgetting what moved lets the look in.
    let after = map.forget(&id("cd_box")).with(&moved, pose).unwrap();
    assert_eq!(after.last_seen(&id("cd_box")), Some(2));
    // A pose that is wrong contradicts everything at once, and says so.
    let lost = GroundPose::new(0.3, 0.0, 0.0).unwrap();
    let error = map
        .with(&look([CD_BOX, PC_SCREEN], pose), lost)
        .unwrap_err();
    let sentence = error.to_string();
    assert!(
        sentence.contains("`cd_box`, `pc_screen` not where"),
        "{sentence}"
    );
    assert!(sentence.contains("(2 of 2 known"), "{sentence}");
}

#[test]
fn another_reference_system_is_refused() {
    let pose = GroundPose::default();
    let scene = QualitativeScene::qualify([], &DepthReference::drs1()).unwrap();
    let error = empty().with(&scene, pose).unwrap_err();
    assert!(matches!(error, Inconsistent::Reference { .. }), "{error}");
}

#[test]
fn an_empty_look_counts_and_changes_nothing_else() {
    let pose = GroundPose::default();
    let map = empty()
        .with(&look([CD_BOX, PC_SCREEN], pose), pose)
        .unwrap();
    let next = map.with(&look([], pose), pose).unwrap();
    assert_eq!(next.looks(), 2);
    assert_eq!(next.relations(), map.relations());
    assert_eq!(next.inference(), map.inference());
    assert_eq!(next.last_seen(&id("cup")), None);
    assert_eq!(next.relation(&id("cup"), &id("cd_box")), None);
}

#[test]
fn poses_that_are_nowhere_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, 1e9] {
        assert!(GroundPose::new(bad, 0.0, 0.0).is_err());
        assert!(GroundPose::new(0.0, bad, 0.0).is_err());
        assert!(GroundPose::new(0.0, 0.0, bad).is_err());
    }
}

#[test]
fn data_that_are_no_map_are_refused() {
    let pose = GroundPose::default();
    let map = empty()
        .with(&look([CD_BOX, PC_SCREEN], pose), pose)
        .unwrap();
    let good = serde_json::to_value(&map).unwrap();
    assert_eq!(good["schema"], "dorsal-map/1");
    let refuse = |pointer: &str, value: serde_json::Value| {
        let mut bad = good.clone();
        *bad.pointer_mut(pointer).unwrap() = value;
        serde_json::from_value::<AllocentricMap>(bad)
            .unwrap_err()
            .to_string()
    };
    assert!(refuse("/schema", "dorsal-map/2".into()).contains("dorsal-map/2"));
    assert!(refuse("/looks", 0.into()).contains("`cd_box`"));
    assert!(refuse("/objects/cd_box/estimate/xx_um2", (-5).into()).contains("`cd_box`"));
    assert!(refuse("/published/0/depth/0", "near".into()).contains("`pc_screen`"));
    assert!(refuse("/published/0/first", "ghost".into()).contains("`ghost`"));
    assert!(refuse("/params/sigmas", (-1).into()).contains("standard errors"));
    assert!(refuse("/reference/class/0/from_mm", 7.into()).contains("7 mm"));
}

fn rooms() -> impl Strategy<Value = Vec<[f64; 2]>> {
    proptest::collection::vec((-1.5..1.5f64, 0.3..2.5f64).prop_map(|(x, z)| [x, z]), 2..6)
}

fn poses() -> impl Strategy<Value = GroundPose> {
    (-1.0..1.0f64, -1.0..0.2f64, -0.8..0.8f64)
        .prop_map(|(x, z, heading)| GroundPose::new(x, z, heading).unwrap())
}

proptest! {
    /// Exact sightings from any poses agree, and the relations seen from any third pose contain
    /// the true ones, whether the objects are in view or not.
    #[test]
    fn the_map_contains_the_room(room in rooms(), first in poses(), second in poses(), third in poses()) {
        let names: Vec<String> = (0..room.len()).map(|k| format!("o{k}")).collect();
        let objects: Vec<(&str, [f64; 2])> =
            names.iter().map(String::as_str).zip(room.iter().copied()).collect();
        let half = objects.len() / 2;
        let map = empty().with(&look(objects.clone(), first), first).unwrap();
        let map = map.with(&look(objects[..half].to_vec(), second), second).unwrap();
        let reference = map.reference();
        let seen = |at: [f64; 2]| {
            let s = sighting("", at, third);
            let (sin, cos) = s.bearing_rad.sin_cos();
            [s.distance_m * sin, -s.distance_m * cos]
        };
        for (k, &(from, from_at)) in objects.iter().enumerate() {
            prop_assert_eq!(map.last_seen(&id(from)), Some(if k < half { 2 } else { 1 }));
            let a = seen(from_at);
            let place = map.place_from(third, &id(from)).unwrap();
            prop_assert!(place.places.orientation.contains(Orientation::of_offset(a[0], a[1])));
            for &(to, to_at) in objects.iter().filter(|(to, _)| *to != from) {
                let b = seen(to_at);
                let between = [b[0] - a[0], b[1] - a[1]];
                let is = Place {
                    depth: reference.qualify(between[0].hypot(between[1])).unwrap(),
                    orientation: Orientation::of_offset(
                        a[0] * between[0] + a[1] * between[1],
                        a[0] * between[1] - a[1] * between[0],
                    ),
                };
                let relation = map.relation_from(third, &id(from), &id(to)).unwrap();
                prop_assert!(relation.places.contains(is));
            }
        }
    }

    /// A map written and read again is the same map and writes the same bytes.
    #[test]
    fn a_map_outlives_its_text(room in rooms(), first in poses(), second in poses()) {
        let names: Vec<String> = (0..room.len()).map(|k| format!("o{k}")).collect();
        let objects: Vec<(&str, [f64; 2])> =
            names.iter().map(String::as_str).zip(room.iter().copied()).collect();
        let map = empty().with(&look(objects.clone(), first), first).unwrap();
        let map = map.with(&look(objects[..1].to_vec(), second), second).unwrap();
        let text = serde_json::to_string(&map).unwrap();
        let read: AllocentricMap = serde_json::from_str(&text).unwrap();
        prop_assert_eq!(&read, &map);
        prop_assert_eq!(serde_json::to_string(&read).unwrap(), text);
    }
}

/// Straight ahead of an observer that has turned is where it faces.
#[test]
fn headings_turn_to_the_left() {
    let turned = GroundPose::new(1.0, 2.0, FRAC_PI_2).unwrap();
    // Facing -x: what is at smaller x is ahead, what is at smaller z to the left.
    let map = empty()
        .with(
            &look([("ahead", [0.2, 2.0]), ("aside", [1.0, 1.2])], turned),
            turned,
        )
        .unwrap();
    let read = |name| map.place_from(turned, &id(name)).unwrap().read.orientation;
    assert_eq!(read("ahead"), Orientation::StraightFront);
    assert_eq!(read("aside"), Orientation::Left);
    for (name, at) in [("ahead", [0.2, 2.0]), ("aside", [1.0, 1.2])] {
        let (_, kept) = map
            .objects()
            .find(|(object, _)| object.as_str() == name)
            .unwrap();
        let [x, z] = kept.estimate.position_m();
        // Positions are kept in whole micrometres.
        assert!((x - at[0]).abs() < 2e-6 && (z - at[1]).abs() < 2e-6);
    }
}
