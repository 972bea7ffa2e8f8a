//! Several robots in one map: each as it would be alone, what joins them, what they contradict.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use std::f64::consts::{FRAC_PI_2, TAU};

use allocentric_qsr::{
    Answer, DepthReference, LookLine, MemoryLine, PoseLine, SceneMemory, SeenLine, ViewLine,
};
use common_ground::{Report, SharedMap, Verdict, shared_params};
use proptest::prelude::*;

/// Where a robot's frame lies in the room: its origin and its turn.
type Frame = ([f64; 2], f64);

const A: Frame = ([0.0, 0.0], 0.0);
const B: Frame = ([2.5, 1.0], 1.1);
const C: Frame = ([-2.0, 3.0], -1.9);

const ROOM: [(&str, [f64; 2]); 5] = [
    ("box", [0.0, 2.0]),
    ("cup", [1.0, 2.5]),
    ("lamp", [-1.0, 1.5]),
    ("door", [0.5, 3.5]),
    ("plant", [-0.5, 3.0]),
];

fn empty() -> SharedMap {
    SharedMap::new(&DepthReference::robot_120(), shared_params()).unwrap()
}

fn look_line(time_ms: u64, seen: Vec<SeenLine>, view: Option<ViewLine>) -> MemoryLine {
    let pose = PoseLine {
        x_m: 0.0,
        z_m: 0.0,
        heading_rad: 0.0,
        sigma_m: 0.0,
        sigma_heading_rad: 0.0,
    };
    MemoryLine::Look(LookLine {
        time_ms,
        pose: Some(pose),
        seen,
        view,
    })
}

/// A look from the origin of a frame at things of the room.
fn look(frame: Frame, time_ms: u64, things: &[(&str, [f64; 2])]) -> MemoryLine {
    let ([x, z], turn) = frame;
    let seen = things.iter().map(|(name, at)| {
        let (right, forward) = (at[0] - x, at[1] - z);
        SeenLine {
            object: (*name).into(),
            distance_m: right.hypot(forward),
            bearing_rad: (forward.atan2(right) - turn).rem_euclid(TAU),
            sigma_distance_m: 0.01,
            sigma_bearing_rad: 0.005,
            radius_mm: 0,
            height_mm: 0,
        }
    });
    look_line(time_ms, seen.collect(), None)
}

fn report(robot: &str, seq: u64, line: MemoryLine) -> Report {
    Report {
        robot: robot.into(),
        run: 1,
        seq,
        kept_from: None,
        line,
    }
}

fn alone<'a>(map: &'a SharedMap, robot: &str) -> &'a SceneMemory {
    &map.robot(&robot.into()).unwrap().memory
}

/// Where a robot is told that a thing is, and the trace of the covariance.
fn place(map: &SharedMap, robot: &str, thing: &str) -> ([f64; 2], f64) {
    match map.ask(&robot.into(), &format!("where {thing}")).unwrap() {
        Answer::Where {
            right_m,
            forward_m,
            covariance_m2: [[xx, _], [_, zz]],
        } => ([right_m, forward_m], xx + zz),
        other => panic!("a place was asked for, not {other}"),
    }
}

#[test]
fn what_another_robot_saw_is_placed_through_shared_landmarks() {
    let mut map = empty();
    map.take(&report("a", 1, look(A, 10, &ROOM[..3])));
    map.take(&report("b", 1, look(B, 20, &ROOM[1..])));
    let ([right, forward], spread) = place(&map, "a", "door");
    assert!((right - 0.5).hypot(forward - 3.5) < 1e-3);
    // Not surer than the one who saw it.
    let seen = alone(&map, "b").object(&"door".into()).unwrap().places[&0].covariance_m2();
    assert!(spread > seen[0][0] + seen[1][1]);
    // Neither memory changed by being asked.
    assert!(alone(&map, "a").object(&"door".into()).is_none());
    let answer = map.ask(&"a".into(), "relation door from box").unwrap();
    let Answer::Relation(relation) = &answer else {
        panic!("a relation was asked for, not {answer}")
    };
    // 1.58 m apart, far from the bounds at 1.2 and 2.5 m.
    let depth = &serde_json::to_value(relation).unwrap()["depth"];
    assert_eq!(*depth, serde_json::json!(["f"]), "{answer}");
}

#[test]
fn a_chain_of_robots_joins_those_that_share_nothing() {
    let mut map = empty();
    map.take(&report("a", 1, look(A, 10, &ROOM[..2])));
    map.take(&report("b", 1, look(B, 20, &ROOM[..4])));
    map.take(&report("c", 1, look(C, 30, &ROOM[2..])));
    let ([right, forward], _) = place(&map, "a", "plant");
    assert!((right + 0.5).hypot(forward - 3.0) < 1e-3);
    // A robot that nothing joins knows nothing of it, and says so.
    map.take(&report("d", 1, look(A, 40, &[("sofa", [0.0, 1.0])])));
    assert!(map.ask(&"d".into(), "where plant").is_err());
    assert!(map.ask(&"a".into(), "where sofa").is_err());
    assert!(map.ask(&"e".into(), "where plant").is_err());
}

#[test]
fn a_contradiction_says_who_saw_what_and_when() {
    let mut map = empty();
    map.take(&report("a", 1, look(A, 10, &ROOM)));
    assert!(map.contradictions().is_empty());
    let mut moved = ROOM;
    moved[1].1 = [1.6, 2.5];
    map.take(&report("b", 1, look(B, 500, &moved)));
    let found = map.contradictions();
    assert_eq!(found.len(), 1, "{found:?}");
    let (one, other) = (&found[0].one, &found[0].other);
    assert_eq!(found[0].object.as_str(), "cup");
    assert_eq!((one.robot.as_str(), one.time_ms), ("a", 10));
    assert_eq!((other.robot.as_str(), other.time_ms), ("b", 500));
    let [right, forward] = other.place_m.unwrap();
    assert!((right - 1.6).hypot(forward - 2.5) < 0.02);
    assert!(found[0].sigmas.unwrap() > 4.0);
    // The newer one is what both are told.
    assert!((place(&map, "a", "cup").0[0] - 1.6).abs() < 0.02);
    // Once a has seen it there too, nothing is contradicted.
    map.take(&report("a", 2, look(A, 600, &moved)));
    assert!(map.contradictions().is_empty());
}

/// What one robot sees standing and another has found gone from there is told with both, and the newer one holds.
#[test]
fn gone_for_one_and_there_for_another_is_a_contradiction() {
    let view = Some(ViewLine {
        half_rad: FRAC_PI_2,
        reach_m: 5.0,
    });
    let bare: Vec<(&str, [f64; 2])> = ROOM
        .into_iter()
        .filter(|(name, _)| *name != "cup")
        .collect();
    let without_cup = |time_ms| {
        let MemoryLine::Look(mut line) = look(A, time_ms, &bare) else {
            unreachable!("a look is a look")
        };
        line.view = view;
        MemoryLine::Look(line)
    };
    let mut map = empty();
    map.take(&report("b", 1, look(B, 5, &ROOM)));
    // Seen often enough to be believed in, then looked for in vain.
    for seq in 1..=10 {
        map.take(&report("a", seq, look(A, 10 * seq, &ROOM)));
    }
    assert!(map.contradictions().is_empty());
    let mut first_missed = None;
    for seq in 11..=30 {
        map.take(&report("a", seq, without_cup(10 * seq)));
        let given_up = alone(&map, "a").object(&"cup".into()).unwrap().given_up_ms;
        first_missed = first_missed.or(given_up);
    }
    let [found] = &map.contradictions()[..] else {
        panic!("one contradiction, not {:?}", map.contradictions())
    };
    assert_eq!(found.object.as_str(), "cup");
    assert_eq!((found.one.robot.as_str(), found.one.is_gone), ("a", true));
    assert_eq!(
        (found.other.robot.as_str(), found.other.is_gone),
        ("b", false)
    );
    assert_eq!(
        (Some(found.one.time_ms), found.other.time_ms),
        (first_missed, 5)
    );
    for witness in [&found.one, &found.other] {
        let [right, forward] = witness.place_m.unwrap();
        assert!((right - 1.0).hypot(forward - 2.5) < 0.02, "{found}");
    }
    let said = found.to_string();
    assert!(
        said.contains("a found it gone from (1.0") && said.contains("b saw it at (1.0"),
        "{said}"
    );
    // It was gone after b saw it: so it is for both.
    for robot in ["a", "b"] {
        assert!(map.ask(&robot.into(), "where cup").is_err());
    }
    // b sees it again, later than a missed it: it is there, and a's word stands against that still.
    map.take(&report("b", 2, look(B, 900, &ROOM)));
    assert!((place(&map, "a", "cup").0[0] - 1.0).abs() < 0.02);
    assert_eq!(map.contradictions().len(), 1);
    // Elsewhere it may have gone to: that contradicts nothing.
    let mut moved = ROOM;
    moved[1].1 = [2.2, 1.5];
    map.take(&report("b", 3, look(B, 1000, &moved)));
    assert!(
        map.contradictions().is_empty(),
        "{:?}",
        map.contradictions()
    );
    // And once a sees it there, it is gone for nobody.
    map.take(&report("a", 31, look(A, 1100, &moved)));
    assert!(map.contradictions().is_empty());
    assert_eq!(
        alone(&map, "a").object(&"cup".into()).unwrap().given_up_ms,
        None
    );
}

#[test]
fn of_two_that_disagree_nobody_can_say_which_moved() {
    let mut map = empty();
    map.take(&report("a", 1, look(A, 10, &ROOM[..2])));
    let moved = [ROOM[0], ("cup", [2.0, 2.5])];
    map.take(&report("b", 1, look(B, 20, &moved)));
    let found = map.contradictions();
    let names: Vec<&str> = found.iter().map(|one| one.object.as_str()).collect();
    assert_eq!(names, ["box", "cup"]);
    assert!(found.iter().all(|one| one.other.place_m.is_none()));
}

#[test]
fn what_never_came_is_counted_and_what_came_twice_is_taken_once() {
    let mut map = empty();
    assert_eq!(map.take(&report("a", 3, look(A, 10, &ROOM))).lost, 2);
    let once = map.clone();
    let again = map.take(&report("a", 3, look(A, 10, &ROOM)));
    assert_eq!((again.verdict, again.lost), (Verdict::Again, 2));
    assert_eq!(map, once);
    assert_eq!(map.take(&report("a", 5, look(A, 20, &ROOM))).lost, 3);
    // A new run of the robot's program numbers from 1 again.
    let mut anew = report("a", 1, look(A, 30, &ROOM));
    anew.run = 2;
    let receipt = map.take(&anew);
    assert!(matches!(receipt.verdict, Verdict::Taken { .. }));
    assert_eq!(receipt.lost, 3);
    let late = map.take(&report("a", 6, look(A, 40, &ROOM)));
    assert_eq!(late.verdict, Verdict::Again);
    // A look that its memory refuses is counted, and changes nothing there.
    let mut back = report("a", 2, look(A, 5, &ROOM));
    back.run = 2;
    let before = alone(&map, "a").clone();
    assert!(matches!(map.take(&back).verdict, Verdict::Refused { .. }));
    assert_eq!(*alone(&map, "a"), before);
    assert_eq!(map.robot(&"a".into()).unwrap().refused, 1);
}

/// A robot that keeps what is not acknowledged loses nothing to a queue that drops, and is not told that the map has
/// what it has not.
#[test]
fn what_a_robot_keeps_is_waited_for() {
    let mut map = empty();
    let kept = |seq, from| Report {
        kept_from: Some(from),
        ..report("a", seq, look(A, seq, &ROOM))
    };
    assert!(map.take(&kept(1, 1)).is_taken());
    // The second was dropped; the third must wait for it.
    let early = map.take(&kept(3, 2));
    assert_eq!(early.verdict, Verdict::Early { expected: 2 });
    assert!(!early.is_taken());
    assert!(map.take(&kept(2, 2)).is_taken());
    assert!(map.take(&kept(3, 2)).is_taken());
    assert_eq!(map.robot(&"a".into()).unwrap().lost, 0);
    // What the robot does not keep any more will never come.
    let after = map.take(&kept(6, 6));
    assert!(after.is_taken());
    assert_eq!(after.lost, 2);
    // A robot that nobody has heard of and that keeps its first is waited for too.
    let mut late = kept(2, 1);
    late.robot = "b".into();
    assert_eq!(map.take(&late).verdict, Verdict::Early { expected: 1 });
    assert!(map.robot(&"b".into()).is_none());
}

/// Some things, each at a distance and a bearing.
fn any_seen() -> impl Strategy<Value = Vec<SeenLine>> {
    let things = proptest::collection::btree_map(0..6usize, (0.3..3.0f64, 0.0..TAU), 0..5);
    things.prop_map(|seen| {
        let seen = seen
            .into_iter()
            .map(|(k, (distance_m, bearing_rad))| SeenLine {
                object: format!("thing {k}").into(),
                distance_m,
                bearing_rad,
                sigma_distance_m: 0.02,
                sigma_bearing_rad: 0.01,
                radius_mm: 20,
                height_mm: 0,
            });
        seen.collect()
    })
}

proptest! {
    /// Each robot's memory in the shared map is the memory it would have alone, however the reports mingle; and the
    /// map read back from its text is the map.
    #[test]
    fn each_robot_is_as_it_would_be_alone(
        looks in proptest::collection::vec((0..3usize, any_seen()), 1..30),
    ) {
        let names = ["a", "b", "c"];
        let mut map = empty();
        let mut memories: [Option<SceneMemory>; 3] = [None, None, None];
        let mut sent: [Vec<Report>; 3] = Default::default();
        for (time, (robot, seen)) in looks.iter().enumerate() {
            let view = ViewLine { half_rad: FRAC_PI_2, reach_m: 3.0 };
            let line = look_line(time as u64, seen.clone(), Some(view));
            let one = report(names[*robot], sent[*robot].len() as u64 + 1, line.clone());
            map.take(&one);
            sent[*robot].push(one);
            memories[*robot].get_or_insert_with(|| {
                SceneMemory::new(&DepthReference::robot_120(), shared_params()).unwrap()
            }).take(line);
        }
        for (robot, memory) in names.into_iter().zip(&memories) {
            let shared = map.robot(&robot.into()).map(|kept| kept.memory.to_json());
            prop_assert_eq!(shared, memory.as_ref().map(SceneMemory::to_json));
        }
        let mut apart = empty();
        for one in sent.iter().rev().flatten() {
            apart.take(one);
        }
        prop_assert_eq!(&apart, &map);
        let read = SharedMap::from_json(&map.to_json()).unwrap();
        prop_assert_eq!(read.to_json(), map.to_json());
        let _ = map.contradictions();
        for (robot, _) in map.robots() {
            let view = map.view(robot).unwrap();
            prop_assert!(SceneMemory::from_json(&view.to_json()).is_ok());
        }
    }

    /// Wherever frames lie, what one robot has seen is carried to within its errors into another's.
    #[test]
    fn frames_may_lie_anywhere(x in -3.0..3.0f64, z in -3.0..3.0f64, turn in -3.0..3.0f64) {
        prop_assume!(ROOM.iter().all(|(_, at)| (at[0] - x).hypot(at[1] - z) > 0.2));
        let mut map = empty();
        map.take(&report("a", 1, look(A, 10, &ROOM[..4])));
        map.take(&report("b", 1, look(([x, z], turn), 20, &ROOM)));
        prop_assert!(map.contradictions().is_empty());
        let ([right, forward], spread) = place(&map, "a", "plant");
        prop_assert!((right + 0.5).hypot(forward - 3.0) < 3.0 * spread.sqrt());
    }
}
