//! What the memory keeps, doubts, gives up, refuses and tells.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod room;

use allocentric_qsr::{
    AllocentricMap, Answer, AskedPlace, BadMemory, BadMemoryParams, BadQuery, BadSighting,
    Certainty, Change, DepthReference, Evidence, FreePath, GroundPose, Life, Look, LookEvidence,
    MemoryParams, NoDepth, ObjectId, Observation, Observer, Orientation, OrientationSet, Policy,
    PoseKnowledge, QualifyParams, QualitativeScene, Query, Refused, RobotPose, SceneMemory,
    Sighting, Unanswerable,
};
use proptest::prelude::*;
use room::{Eye, Room, memory, room};

const STILL: fn(usize) -> [f64; 2] = |_| [0.0, 0.0];

fn follow() -> MemoryParams {
    MemoryParams {
        policy: Policy::Follow,
        ..MemoryParams::default()
    }
}

fn see(memory: &mut SceneMemory, eye: Eye<'_>) -> Vec<Change> {
    let time_ms = memory.time_ms() + 100;
    memory.observe(&eye.look(time_ms, STILL), &eye).unwrap()
}

fn life(memory: &SceneMemory, name: &str) -> Life {
    memory.object(&name.into()).unwrap().life
}

fn ask(memory: &SceneMemory, words: &str) -> Answer {
    let query: Query = words.parse().unwrap();
    assert_eq!(query.to_string().parse::<Query>().unwrap(), query);
    memory.ask(&query).unwrap()
}

fn figure_12() -> (Room, SceneMemory) {
    let room = room([
        ("cd_box", [-0.10, 0.80]),
        ("pc_screen", [0.32, 0.80]),
        ("cup", [-0.60, 0.90]),
    ]);
    let mut memory = memory(MemoryParams::default());
    for _ in 0..2 {
        see(
            &mut memory,
            Eye {
                half_rad: 0.9,
                ..Eye::new(&room, GroundPose::default())
            },
        );
    }
    // A scrutiny of the room takes the screen out of view.
    see(
        &mut memory,
        Eye::new(&room, GroundPose::new(-0.15, 0.05, 0.45).unwrap()),
    );
    (room, memory)
}

/// Figure 12: the screen has left the view; the robot knows that it is very close to the box and
/// at its right, and plans round it.
#[test]
fn the_screen_is_remembered_and_avoided() {
    let (room, mut memory) = figure_12();
    assert_eq!(life(&memory, "pc_screen"), Life::OutOfView);
    assert_eq!(life(&memory, "cd_box"), Life::InView);
    let Answer::Relation(relation) = ask(&memory, "relation pc_screen from cd_box seen from robot")
    else {
        panic!("a relation was asked for");
    };
    assert_eq!(relation.depth, ["vc"]);
    let right = OrientationSet::from_iter([
        Orientation::FrontRight,
        Orientation::Right,
        Orientation::BackRight,
    ]);
    assert!(relation.orientation.is_subset(right));
    let Answer::Objects { certain, .. } = ask(&memory, "within vc of cd_box and right of cd_box")
    else {
        panic!("objects were asked for");
    };
    assert_eq!(certain, ["pc_screen".into()]);
    // The arm knows where it is: at (0.32, 0.80) of the room, seen from where the robot is now.
    let place = memory.from_robot(&"pc_screen".into()).unwrap();
    let (sin, cos) = 0.45f64.sin_cos();
    let (dx, dz) = (0.47, 0.75);
    assert!((place.right_m - (dx * cos + dz * sin)).abs() < 1e-3);
    assert!((place.forward_m - (dz * cos - dx * sin)).abs() < 1e-3);
    assert!(place.covariance_m2[0][0] > 0.0 && place.covariance_m2[0][0] < 0.01f64.powi(2));

    // From the right of the screen the straight way to the box goes through it; from in front of
    // the box the way is free, and so is one that keeps 12 cm from the screen.
    let way = |x: f64, z: f64| {
        let from = Observer::At(GroundPose::new(x, z, 0.0).unwrap());
        memory
            .free_path(&from, &Observer::Object("cd_box".into()), 0.05)
            .unwrap()
    };
    assert_eq!(
        way(0.75, 0.80),
        FreePath::Blocked {
            by: vec!["pc_screen".into()]
        }
    );
    assert_eq!(way(0.0, 0.35), FreePath::Clear);
    let waypoint = |x: f64, z: f64| Observer::At(GroundPose::new(x, z, 0.0).unwrap());
    let round = memory
        .free_path(&waypoint(0.28, 0.52), &waypoint(0.0, 0.52), 0.05)
        .unwrap();
    assert_eq!(round, FreePath::Clear);
    assert_eq!(
        ask(&memory, "free_path from robot to cd_box"),
        Answer::FreePath(FreePath::Clear)
    );
    // Behind the robot nobody has looked.
    assert!(matches!(way(0.0, -1.5), FreePath::Unknown { at_m: [_, z] } if z < 0.0));
    // Someone takes the screen away unseen: the memory keeps it, until it looks there again.
    let mut without = room.clone();
    without.remove("pc_screen");
    see(
        &mut memory,
        Eye::new(&without, GroundPose::new(-0.15, 0.05, 0.45).unwrap()),
    );
    assert_eq!(life(&memory, "pc_screen"), Life::OutOfView);
    for _ in 0..3 {
        see(&mut memory, Eye::new(&without, GroundPose::default()));
    }
    assert_eq!(life(&memory, "pc_screen"), Life::Missing);
    let way = memory.free_path(
        &waypoint(0.6, 0.80),
        &Observer::Object("cd_box".into()),
        0.05,
    );
    assert!(!matches!(way, Some(FreePath::Blocked { .. })), "{way:?}");
}

/// A look at a room that says this of the one object, and of one square, and else what the room says.
struct Knowing<'a> {
    eye: Eye<'a>,
    of: Evidence,
    taken: Option<[f64; 2]>,
}

impl LookEvidence for Knowing<'_> {
    fn at(&self, place: AskedPlace) -> Evidence {
        let at = [place.right_m, place.forward_m];
        let near = |[x, z]: [f64; 2]| (x - at[0]).hypot(z - at[1]) < 0.1;
        if self.taken.is_some_and(near) {
            Evidence::Taken
        } else {
            self.eye.at(place)
        }
    }

    fn of(&self, _: &ObjectId, _: AskedPlace) -> Evidence {
        self.of
    }
}

/// Nothing is in two places: one look that knows an object elsewhere gives its place up, and a thing of
/// which nobody knows how far it is gives up the ground it may stand on, until that is seen free.
#[test]
fn what_is_seen_elsewhere_is_here_no_longer() {
    let there = room([("cup", [0.0, 1.0]), ("box", [0.6, 1.0])]);
    let gone = room([("box", [0.6, 1.0])]);
    let mut memory = memory(follow());
    for _ in 0..2 {
        see(&mut memory, Eye::new(&there, GroundPose::default()));
    }
    let at = |x: f64, z: f64| Observer::At(GroundPose::new(x, z, 0.0).unwrap());
    let way = |memory: &SceneMemory| memory.free_path(&at(-0.25, 0.6), &at(0.25, 0.6), 0.05);
    assert_eq!(way(&memory), Some(FreePath::Clear));
    let eye = Eye::new(&gone, GroundPose::default());
    let knowing = |of, taken| Knowing {
        eye: Eye::new(&gone, GroundPose::default()),
        of,
        taken,
    };
    let look = |memory: &mut SceneMemory, evidence: &Knowing<'_>| {
        let time_ms = memory.time_ms() + 100;
        memory.observe(&eye.look(time_ms, STILL), evidence).unwrap();
    };
    // A thing that is seen where it may be says nothing, however often.
    for _ in 0..9 {
        look(&mut memory, &knowing(Evidence::Taken, None));
        assert_eq!(life(&memory, "cup"), Life::Confirmed);
    }
    look(&mut memory, &knowing(Evidence::Elsewhere, Some([0.0, 0.6])));
    assert_eq!(life(&memory, "cup"), Life::Missing);
    assert!(matches!(way(&memory), Some(FreePath::Unknown { .. })));
    look(&mut memory, &knowing(Evidence::NoEvidence, None));
    assert_eq!(way(&memory), Some(FreePath::Clear));
    // Seen again, it is believed again, and where it stands now is no free ground.
    let moved = room([("cup", [0.0, 0.6]), ("box", [0.6, 1.0])]);
    let mut memory = SceneMemory::from_json(&memory.to_json()).unwrap();
    let time_ms = memory.time_ms() + 100;
    let follows = Eye::new(&moved, GroundPose::default()).look(time_ms, STILL);
    memory.observe(&follows, &NoDepth).unwrap();
    assert_eq!(
        way(&memory),
        Some(FreePath::Blocked {
            by: vec!["cup".into()]
        })
    );
}

proptest! {
    /// Ground is clear for a traveller only if no thing that the look did not name stands in its way:
    /// a look that shows all places free but those where lines of sight meet a body, up to one line in
    /// twenty, calls no way clear that the body reaches into.
    #[test]
    fn a_clear_way_is_clear_to_its_edges(
        x in -0.4..0.4f64, z in 0.6..1.4f64, body_m in 0.02..0.1f64, from in -0.5..0.5f64, to in -0.5..0.5f64,
    ) {
        let mut memory = memory(MemoryParams { cell_mm: 30, ground_mm: 2000, ..MemoryParams::default() });
        let look = Look {
            time_ms: 1,
            pose: PoseKnowledge::Known(RobotPose::default()),
            observations: vec![],
        };
        // A disc reaches into another by less than a tenth of its width where a twentieth of it is covered.
        let evidence = |place: AskedPlace| {
            let apart = (place.right_m - x).hypot(place.forward_m - z);
            if apart < body_m + 0.8 * place.within_m {
                Evidence::NoEvidence
            } else {
                Evidence::FreeSpace
            }
        };
        memory.observe(&look, &evidence).unwrap();
        let end = |x: f64, z: f64| Observer::At(GroundPose::new(x, z, 0.0).unwrap());
        let (radius, ends) = (0.03, [[from, 0.4], [to, 1.6]]);
        let way = memory.free_path(&end(from, 0.4), &end(to, 1.6), radius);
        let [a, b] = ends;
        let along = [b[0] - a[0], b[1] - a[1]];
        let part = ((x - a[0]) * along[0] + (z - a[1]) * along[1]) / (along[0] * along[0] + along[1] * along[1]);
        let nearest = [a[0] + part * along[0], a[1] + part * along[1]];
        let clearance = (nearest[0] - x).hypot(nearest[1] - z) - body_m - radius;
        if clearance < 0.0 {
            prop_assert!(!matches!(way, Some(FreePath::Clear)), "{clearance}");
        }
        // Squares are as fine as this: farther off nothing keeps it from being clear.
        if clearance > 0.07 {
            prop_assert_eq!(way, Some(FreePath::Clear));
        }
    }
}

/// A look that says the same of all ground, and the same of every object that it does not report.
#[derive(Clone, Copy)]
struct Told {
    ground: Evidence,
    of: Evidence,
}

impl LookEvidence for Told {
    fn at(&self, _: AskedPlace) -> Evidence {
        self.ground
    }

    fn of(&self, _: &ObjectId, _: AskedPlace) -> Evidence {
        self.of
    }
}

/// A look at a cup straight ahead, or at nothing.
fn look_at_cup(memory: &SceneMemory, cup: Option<(f64, f64)>) -> Look {
    let seen = cup.map(|(distance_m, sigma_distance_m)| Observation {
        sighting: Sighting {
            object: "cup".into(),
            distance_m,
            bearing_rad: std::f64::consts::FRAC_PI_2,
            sigma_distance_m,
            sigma_bearing_rad: 0.005,
        },
        radius_mm: 50,
        height_mm: 0,
    });
    Look {
        time_ms: memory.time_ms() + 100,
        pose: PoseKnowledge::Known(RobotPose::default()),
        observations: seen.into_iter().collect(),
    }
}

proptest! {
    /// What a memory vouches for has been seen: ground is clear if it was seen free within the looks for
    /// which the world is trusted, and since the last sighting of the cup while that is lost and may stand
    /// anywhere; the cup is believed where it was for as many looks. The file keeps all of it.
    #[test]
    fn a_memory_vouches_for_what_it_has_seen_of_late(
        looks in proptest::collection::vec((0usize..4, any::<bool>()), 1..14), trusted_looks in 0u32..5,
    ) {
        let mut memory = memory(MemoryParams { trusted_looks, ..follow() });
        let [mut cup, mut free, mut now] = [0u64; 3];
        let mut lost = false;
        // Two sightings confirm the cup.
        for (of_cup, is_free) in [(0, true), (0, true)].into_iter().chain(looks) {
            now += 1;
            let seen = of_cup == 0;
            let of = [Evidence::NoEvidence, Evidence::OutOfView, Evidence::Occluded, Evidence::Elsewhere][of_cup];
            let ground = if is_free { Evidence::FreeSpace } else { Evidence::NoEvidence };
            let look = look_at_cup(&memory, seen.then_some((1.0, 0.01)));
            memory.observe(&look, &Told { ground, of }).unwrap();
            memory = SceneMemory::from_json(&memory.to_json()).unwrap();
            cup = if seen { now } else { cup };
            free = if is_free { now } else { free };
            lost = !seen && (lost || of == Evidence::Elsewhere);

            let is_late = |look: u64| trusted_looks == 0 || now - look <= u64::from(trusted_looks);
            let at = |x: f64| Observer::At(GroundPose::new(x, 0.6, 0.0).unwrap());
            let clear = memory.free_path(&at(-0.25), &at(0.25), 0.05) == Some(FreePath::Clear);
            prop_assert_eq!(clear, is_late(free) && (!lost || free > cup));
            prop_assert_eq!(memory.free_ground().is_empty(), !clear);
            let life = life(&memory, "cup");
            prop_assert_eq!(life == Life::Missing, lost);
            prop_assert_eq!(life == Life::Stale, !lost && !is_late(cup));
        }
    }

    /// Who moves within the errors of its place is not believed in between, surer than either: wherever
    /// it went along the line of sight, a sighting as sure as the old place leaves it within three
    /// standard errors.
    #[test]
    fn what_moved_within_its_errors_is_where_it_is_seen(
        step_m in -0.4..0.4f64, sigma_m in 0.02..0.08f64, surer in 0.5..1.0f64, pose_sigma in 0.0..0.01f64,
    ) {
        let mut memory = memory(follow());
        let evidence = Told { ground: Evidence::NoEvidence, of: Evidence::NoEvidence };
        let pose = RobotPose::new(GroundPose::default(), [[0.0; 2]; 2], pose_sigma).unwrap();
        for (distance_m, sigma_m) in [(1.2, sigma_m), (1.2 + step_m, sigma_m * surer)] {
            let mut look = look_at_cup(&memory, Some((distance_m, sigma_m)));
            look.pose = PoseKnowledge::Known(pose);
            memory.observe(&look, &evidence).unwrap();
        }
        let place = memory.from_robot(&"cup".into()).unwrap();
        let sigma_m = place.covariance_m2[1][1].sqrt();
        let off_m = (place.forward_m - 1.2 - step_m).abs();
        prop_assert!(off_m <= 3.0 * sigma_m + 1e-5, "{off_m} {sigma_m}");
    }

    /// An object at the end of a way lends it no more ground than it stands on: however unsure its place,
    /// a body beside it that no look has measured is not overlooked.
    #[test]
    fn who_stands_beside_an_unsure_thing_is_not_overlooked(
        sigma_m in 0.0..0.3f64, body_m in 0.035..0.1f64, beyond_m in 0.0..0.3f64, aside_m in -0.05..0.05f64,
    ) {
        let mut memory = memory(MemoryParams { cell_mm: 30, ground_mm: 2000, ..follow() });
        let (cup_m, radius_m) = (1.2, 0.05);
        let ahead_m = cup_m - radius_m - body_m - beyond_m;
        let evidence = |place: AskedPlace| {
            let apart = (place.right_m - aside_m).hypot(place.forward_m - ahead_m);
            if apart < body_m + place.within_m {
                Evidence::NoEvidence
            } else {
                Evidence::FreeSpace
            }
        };
        let look = look_at_cup(&memory, Some((cup_m, sigma_m)));
        memory.observe(&look, &evidence).unwrap();
        memory.observe(&Look { time_ms: 900, observations: vec![], ..look }, &evidence).unwrap();
        let from = Observer::At(GroundPose::new(0.0, 0.4, 0.0).unwrap());
        let way = memory.free_path(&from, &Observer::Object("cup".into()), 0.03);
        prop_assert!(matches!(way, Some(FreePath::Unknown { .. })), "{way:?}");
    }
}

#[test]
fn a_life_goes_on_by_evidence_alone() {
    let there = room([("cup", [0.0, 1.0])]);
    let gone = Room::new();
    let hidden = room([("box", [0.0, 0.5])]);
    let pose = GroundPose::default();
    let eye = |room| Eye::new(room, pose);
    let mut memory = memory(MemoryParams::default());
    assert_eq!(
        see(&mut memory, eye(&there)),
        [Change::Appeared {
            object: "cup".into()
        }]
    );
    assert_eq!(life(&memory, "cup"), Life::Tentative);
    see(&mut memory, eye(&there));
    assert_eq!(life(&memory, "cup"), Life::InView);
    // A hole in the measurement says nothing, however often.
    for _ in 0..20 {
        see(
            &mut memory,
            Eye {
                hole: Some([0.0, 1.0, 0.3]),
                ..eye(&gone)
            },
        );
        assert_eq!(life(&memory, "cup"), Life::Confirmed);
    }
    for _ in 0..20 {
        see(&mut memory, eye(&hidden));
        assert_eq!(life(&memory, "cup"), Life::Occluded);
    }
    for _ in 0..20 {
        see(
            &mut memory,
            Eye::new(&gone, GroundPose::new(0.0, 0.0, 2.0).unwrap()),
        );
        assert_eq!(life(&memory, "cup"), Life::OutOfView);
    }
    for expected in [
        Life::Confirmed,
        Life::Confirmed,
        Life::Missing,
        Life::Missing,
        Life::Missing,
    ] {
        see(&mut memory, eye(&gone));
        assert_eq!(life(&memory, "cup"), expected);
    }
    // A sighting leads back; free space must begin anew.
    see(&mut memory, eye(&there));
    assert_eq!(life(&memory, "cup"), Life::InView);
    for _ in 0..6 {
        see(&mut memory, eye(&gone));
    }
    assert_eq!(life(&memory, "cup"), Life::Removed);
    assert_eq!(memory.from_robot(&"cup".into()), None);
    // The tombstone survives reload, and says when.
    let memory_again = SceneMemory::from_json(&memory.to_json()).unwrap();
    assert_eq!(memory_again, memory);
    assert_eq!(
        memory_again.last_seen(&"cup".into()),
        memory.last_seen(&"cup".into())
    );
    let epoch = memory.object(&"cup".into()).unwrap().epoch;
    see(&mut memory, eye(&there));
    assert_eq!(life(&memory, "cup"), Life::Tentative);
    assert_eq!(memory.object(&"cup".into()).unwrap().epoch, epoch + 1);
    // A tentative thing that was never there goes as soon as a confirmed one would be missing.
    for _ in 0..3 {
        see(&mut memory, eye(&gone));
    }
    assert_eq!(life(&memory, "cup"), Life::Removed);
}

#[test]
fn what_moved_is_refused_or_followed() {
    let before = room([("cup", [0.0, 1.0]), ("box", [0.3, 1.2])]);
    let after = room([("cup", [-0.2, 1.0]), ("box", [0.3, 1.2])]);
    let all = room([("cup", [-0.2, 1.0]), ("box", [0.1, 1.2])]);
    for params in [MemoryParams::default(), follow()] {
        let mut memory = memory(params);
        for _ in 0..2 {
            see(&mut memory, Eye::new(&before, GroundPose::default()));
        }
        let kept = memory.clone();
        let eye = Eye::new(&all, GroundPose::default());
        let refused = memory.observe(&eye.look(1000, STILL), &eye).unwrap_err();
        // Everything elsewhere is a wrong pose, whatever the policy.
        assert!(matches!(&refused, Refused::Moved { moved, known: 2 } if moved.len() == 2));
        assert_eq!(memory, kept);
        let eye = Eye::new(&after, GroundPose::default());
        let result = memory.observe(&eye.look(1000, STILL), &eye);
        if params.policy == Policy::Refuse {
            let Err(Refused::Moved { moved, .. }) = result else {
                panic!("the cup moved")
            };
            assert_eq!(moved[0].object, "cup".into());
            assert_eq!(moved[0].last_look, 2);
            assert_eq!(memory, kept);
        } else {
            assert!(result.unwrap().contains(&Change::Moved {
                object: "cup".into(),
                epoch: 1
            }));
            let place = memory.from_robot(&"cup".into()).unwrap();
            assert!((place.right_m + 0.2).abs() < 1e-3);
            assert_eq!(memory.object(&"box".into()).unwrap().epoch, 0);
        }
    }
}

#[test]
fn bad_looks_leave_the_memory_as_it_was() {
    let (room, mut memory) = figure_12();
    let before = memory.clone();
    let eye = Eye::new(&room, GroundPose::default());
    let good = eye.look(5000, STILL);
    assert!(good.observations.len() >= 2);
    let mut refuse = |change: &dyn Fn(&mut Look)| {
        let mut bad = good.clone();
        change(&mut bad);
        let refused = memory.observe(&bad, &eye).unwrap_err();
        assert_eq!(memory, before);
        assert!(memory.what_if(&bad, &eye).is_err());
        refused
    };
    type Spoil = fn(&mut Sighting);
    let spoils: [Spoil; 7] = [
        |s| s.distance_m = f64::NAN,
        |s| s.distance_m = -0.5,
        |s| s.distance_m = f64::INFINITY,
        |s| s.bearing_rad = f64::NAN,
        |s| s.sigma_distance_m = -0.1,
        |s| s.sigma_bearing_rad = f64::NAN,
        |s| s.sigma_distance_m = f64::INFINITY,
    ];
    for spoil in spoils {
        let refused = refuse(&|look| spoil(&mut look.observations[1].sighting));
        assert!(matches!(refused, Refused::Sighting(_)), "{refused}");
    }
    let twice = refuse(&|look| look.observations.push(look.observations[0].clone()));
    assert!(matches!(twice, Refused::Sighting(BadSighting::Twice(_))));
    let late = refuse(&|look| look.time_ms = 1);
    assert_eq!(
        late,
        Refused::Time {
            look_ms: 1,
            last_ms: 300
        }
    );
    // An error of zero is taken, but never believed: no place is surer than the creep.
    let mut exact = good.clone();
    for seen in &mut exact.observations {
        (
            seen.sighting.sigma_distance_m,
            seen.sighting.sigma_bearing_rad,
        ) = (0.0, 0.0);
    }
    memory.observe(&exact, &eye).unwrap();
    let place = memory.from_robot(&"cd_box".into()).unwrap();
    assert!(place.covariance_m2[0][0] > 1e-7);
    // An empty look is a look.
    let looks = memory.looks();
    let empty = Look {
        observations: vec![],
        ..exact
    };
    memory.observe(&empty, &NoDepth).unwrap();
    assert_eq!(memory.looks(), looks + 1);
    assert_eq!(life(&memory, "cd_box"), Life::Confirmed);
    let bad = |params| SceneMemory::new(&DepthReference::drs1(), params).unwrap_err();
    let zero = MemoryParams {
        confirm_after: 0,
        ..MemoryParams::default()
    };
    assert_eq!(bad(zero), BadMemoryParams::Life);
    let fine = MemoryParams {
        cell_mm: 1,
        ..MemoryParams::default()
    };
    assert!(matches!(bad(fine), BadMemoryParams::Ground { .. }));
    let position = [[f64::NAN, 0.0], [0.0, 1.0]];
    assert!(RobotPose::new(GroundPose::default(), position, 0.0).is_err());
    assert!(RobotPose::new(GroundPose::default(), [[1.0, 2.0], [2.0, 1.0]], 0.0).is_err());
}

#[test]
fn facts_are_told_explained_and_taken_back() {
    let (_, mut memory) = figure_12();
    let near = memory.read_fact("lamp within vc of pc_screen").unwrap();
    memory.tell(near.clone()).unwrap();
    // The lamp was never seen: what is known of it goes through the screen.
    let relation = memory
        .relation(&"cd_box".into(), &"lamp".into(), &Observer::Robot)
        .unwrap();
    assert_eq!(
        memory.reference().labels(relation.places.depth),
        ["vc", "c", "n"]
    );
    let why = memory.explain(&"cd_box".into(), &"lamp".into()).unwrap();
    let expected = "\
cd_box - lamp: {vc, c, n}, through pc_screen
  cd_box - pc_screen: {vc}, measured in looks 3 and 2
  lamp - pc_screen: {vc}, told: lamp within vc of pc_screen
";
    assert_eq!(why.to_string(), expected);
    // What cannot be is refused with its premises, and the memory stands.
    let before = memory.clone();
    let far = memory.read_fact("lamp within vf of cd_box").unwrap();
    let Err(Refused::Contradiction(proof)) = memory.tell(far.clone()) else {
        panic!("a lamp within 60 cm of the screen is not 250 cm from the box");
    };
    assert!(
        proof.to_string().contains("told: lamp within vf of cd_box"),
        "{proof}"
    );
    assert_eq!(memory, before);
    assert!(matches!(memory.retract(&far), Err(Refused::NeverTold(_))));
    memory.retract(&near).unwrap();
    memory.tell(far).unwrap();
    let diff = before.diff(&memory);
    let told = Change::Told {
        fact: "lamp within vf of cd_box".into(),
    };
    let gone = Change::Retracted {
        fact: "lamp within vc of pc_screen".into(),
    };
    assert_eq!(diff, [told, gone]);
    assert_eq!(SceneMemory::from_json(&memory.to_json()).unwrap(), memory);
    assert!(matches!(
        memory.read_fact("lamp within near of cup"),
        Err(BadQuery::Word { .. })
    ));
}

/// What is seen outweighs what was told, if the policy is to follow.
#[test]
fn a_fact_that_is_seen_to_be_wrong_yields_by_policy() {
    let room = room([("cup", [0.0, 1.0]), ("box", [0.1, 1.2])]);
    for params in [MemoryParams::default(), follow()] {
        let mut memory = memory(params);
        let wrong = memory.read_fact("cup within vf of box").unwrap();
        memory.tell(wrong).unwrap();
        let eye = Eye::new(&room, GroundPose::default());
        let result = memory.observe(&eye.look(1, STILL), &eye);
        if params.policy == Policy::Refuse {
            assert!(matches!(result, Err(Refused::Contradiction(_))));
            assert_eq!(memory.looks(), 0);
        } else {
            let fact = "cup within vf of box".into();
            assert!(result.unwrap().contains(&Change::Retracted { fact }));
            assert!(memory.facts().is_empty());
        }
    }
}

/// After a lost pose a pair that no frame has in common may be anything, until a landmark that both
/// frames have narrows it.
#[test]
fn landmarks_join_two_frames() {
    let first = room([("cup", [0.0, 1.0]), ("box", [0.2, 1.1])]);
    let mut memory = memory(MemoryParams::default());
    for _ in 0..2 {
        see(&mut memory, Eye::new(&first, GroundPose::default()));
    }
    // The robot is carried elsewhere: its own frame now has the lamp straight ahead.
    let second = room([("lamp", [0.0, 0.9])]);
    let eye = Eye::new(&second, GroundPose::default());
    let lost = Look {
        pose: PoseKnowledge::Lost,
        ..eye.look(200, STILL)
    };
    let changes = memory.observe(&lost, &eye).unwrap();
    assert!(changes.contains(&Change::NewFrame { frame: 1 }));
    let (cup, lamp) = ("cup".into(), "lamp".into());
    let across = |memory: &SceneMemory| {
        let relation = memory.relation(&cup, &lamp, &Observer::Robot).unwrap();
        assert_eq!(relation.places.orientation, OrientationSet::ALL);
        memory.reference().labels(relation.places.depth).join(" ")
    };
    assert_eq!(across(&memory), "vc c n f vf");
    assert_eq!(memory.from_robot(&cup), None);
    assert_eq!(life(&memory, "cup"), Life::OutOfView);
    // The box comes into view beside the lamp.
    let second = room([("lamp", [0.0, 0.9]), ("box", [0.3, 0.9])]);
    see(&mut memory, Eye::new(&second, GroundPose::default()));
    assert_eq!(across(&memory), "vc c n");
    let why = memory.explain(&cup, &lamp).unwrap().to_string();
    assert!(why.contains("through box"), "{why}");
    assert_eq!(SceneMemory::from_json(&memory.to_json()).unwrap(), memory);
    // Two frames that measure one pair differently contradict each other.
    let wrong = room([("cup", [0.0, 2.4]), ("box", [0.3, 0.9])]);
    let eye = Eye::new(&wrong, GroundPose::default());
    let refused = memory.observe(&eye.look(900, STILL), &eye).unwrap_err();
    assert!(matches!(refused, Refused::Contradiction(_)), "{refused}");
}

/// Two landmarks that both frames have carry everything of the one into the other: an object that the
/// robot has not seen since it lost its pose has a place for it, with the errors of all of that.
#[test]
fn two_landmarks_carry_a_frame_into_another() {
    let world = room([
        ("cup", [0.0, 1.0]),
        ("box", [0.4, 1.3]),
        ("vase", [-0.5, 1.2]),
        ("lamp", [0.9, 2.1]),
    ]);
    let mut memory = memory(MemoryParams::default());
    for _ in 0..2 {
        see(&mut memory, Eye::new(&world, GroundPose::default()));
    }
    // The robot is carried to another place and wakes there; box and vase are in its view.
    let stands = GroundPose::new(0.3, 0.1, 0.4).unwrap();
    let eye = Eye::new(&world, stands);
    let mut look = eye.look(300, STILL);
    look.pose = PoseKnowledge::Lost;
    look.observations
        .retain(|seen| ["box", "vase"].contains(&seen.sighting.object.as_str()));
    assert_eq!(look.observations.len(), 2);
    let two = look.clone();
    memory.observe(&look, &NoDepth).unwrap();
    let (cup, lamp) = ("cup".into(), "lamp".into());
    let place = memory.from_robot(&cup).unwrap();
    let (sin, cos) = stands.heading_rad().sin_cos();
    let (dx, dz) = (0.0 - 0.3, 1.0 - 0.1);
    let (right, forward) = (dx * cos + dz * sin, dz * cos - dx * sin);
    // The eye errs by nothing here, so only rounding is left.
    assert!((place.right_m - right).abs() < 1e-4, "{place:?}");
    assert!((place.forward_m - forward).abs() < 1e-4, "{place:?}");
    // Four sightings of a centimetre and more, over landmarks 0.9 m apart.
    let sigma = place.covariance_m2[0][0].sqrt();
    assert!((0.005..0.05).contains(&sigma), "{sigma}");
    // What is known of one frame alone and of both is one room for every question.
    let relation = memory
        .relation(&"box".into(), &cup, &Observer::Robot)
        .unwrap();
    assert_eq!(memory.reference().labels(relation.places.depth), ["vc"]);
    assert!(relation.read.is_some());
    let way = memory.free_path(&Observer::Robot, &Observer::Object(cup.clone()), 0.02);
    assert!(way.is_some());
    let answer = ask(&memory, "within c,n of robot");
    assert!(answer.to_string().contains("cup"), "{answer}");
    // A thing of the new frame and one of the old: measured, by the landmarks.
    look.time_ms = 400;
    look.pose = PoseKnowledge::Known(RobotPose::default());
    look.observations.push(Observation::from(Sighting {
        object: "bell".into(),
        distance_m: 0.5,
        bearing_rad: 1.2,
        sigma_distance_m: 0.01,
        sigma_bearing_rad: 0.005,
    }));
    memory.observe(&look, &NoDepth).unwrap();
    let across = memory
        .relation(&"bell".into(), &lamp, &Observer::Robot)
        .unwrap();
    assert!(across.places.depth.len() < 3 && across.places.orientation != OrientationSet::ALL);
    let why = memory.explain(&"bell".into(), &lamp).unwrap().to_string();
    assert!(why.contains("whose frames box, vase join"), "{why}");
    assert_eq!(SceneMemory::from_json(&memory.to_json()).unwrap(), memory);
    // A life in another frame is not ended by what is seen in this one.
    for _ in 0..9 {
        let time_ms = memory.time_ms() + 1;
        let empty = Look {
            time_ms,
            observations: vec![],
            ..look.clone()
        };
        memory.observe(&empty, &|_| Evidence::FreeSpace).unwrap();
    }
    assert_eq!(life(&memory, "cup"), Life::OutOfView);
    // A third frame that shares nothing with the second, and two landmarks with none: no place.
    let mut lost = two;
    lost.time_ms = memory.time_ms() + 1;
    lost.observations.clear();
    memory.observe(&lost, &NoDepth).unwrap();
    assert_eq!(memory.frame(), 2);
    assert_eq!(memory.from_robot(&cup), None);
}

/// A robot that is lost at every step keeps a memory of one size, and still joins what it sees.
#[test]
fn being_lost_again_and_again_fills_no_memory() {
    let world = room([("cup", [0.0, 1.0]), ("box", [0.4, 1.3])]);
    let mut memory = memory(MemoryParams {
        ground_mm: 0,
        most_changes: 20,
        ..MemoryParams::default()
    });
    let mut sizes = Vec::new();
    for step in 0..60 {
        let mut look = Eye::new(&world, GroundPose::default()).look(step, STILL);
        look.pose = PoseKnowledge::Lost;
        memory.observe(&look, &NoDepth).unwrap();
        sizes.push(memory.to_json().len());
    }
    assert_eq!(memory.frame(), 59);
    assert_eq!(memory.object(&"cup".into()).unwrap().places.len(), 16);
    // A few digits more than when the frames were full.
    assert!(sizes[59] < sizes[30] + 100, "{} {}", sizes[30], sizes[59]);
    assert!(memory.from_robot(&"cup".into()).is_some());
}

#[test]
fn questions_get_certain_and_possible_answers() {
    let (_, memory) = figure_12();
    let objects = |words: &str| match ask(&memory, words) {
        Answer::Objects { certain, possible } => (certain, possible),
        other => panic!("{words}: {other}"),
    };
    let (certain, possible) = objects("within vc,c of cd_box and front,back,left,right of cd_box");
    assert_eq!((certain.len(), possible.len()), (2, 0));
    let (certain, possible) = objects("between pc_screen and cup");
    assert_eq!((certain, possible), (vec!["cd_box".into()], vec![]));
    // An exact ray is never certain.
    let (certain, possible) = objects("r of cd_box");
    assert!(certain.is_empty());
    assert_eq!(possible, ["pc_screen".into()]);
    let Answer::Reachable { reach, way } = ask(&memory, "reachable cd_box within 1.2") else {
        panic!("a reach was asked for");
    };
    assert_eq!((reach, way), (Certainty::Certain, FreePath::Clear));
    let Answer::Reachable { reach, .. } = ask(&memory, "reachable cd_box within 0.2") else {
        panic!("a reach was asked for");
    };
    assert_eq!(reach, Certainty::No);
    let Answer::LastSeen { look, life, .. } = ask(&memory, "last_seen pc_screen") else {
        panic!("a look was asked for");
    };
    assert_eq!((look, life), (2, Life::OutOfView));
    let json = serde_json::to_value(ask(&memory, "where cup")).unwrap();
    assert_eq!(json["answer"], "where");
    let text = ask(&memory, "relation cup from cd_box seen from pc_screen").to_string();
    assert!(text.starts_with("cup at cd_box: {vc}"), "{text}");
    let refuse = |words: &str| memory.ask(&words.parse().unwrap()).unwrap_err();
    assert_eq!(refuse("where ghost"), Unanswerable::Object("ghost".into()));
    assert_eq!(
        refuse("left of ghost"),
        Unanswerable::Object("ghost".into())
    );
    assert!(matches!(
        refuse("within near of robot"),
        Unanswerable::Class { .. }
    ));
    for words in [
        "",
        "relation",
        "relation a",
        "relation a from",
        "within vc robot",
        "up of cup",
        "left of cup and",
        "free_path from robot to",
        "where cup now",
        "reachable cup within far",
        "relation robot from cup",
    ] {
        assert!(words.parse::<Query>().is_err(), "{words}");
    }
    assert!(
        memory
            .to_dot()
            .contains("\"cd_box\" -> \"cup\" [label=\"vc fl\"]"),
        "{}",
        memory.to_dot()
    );
}

#[test]
fn an_older_snapshot_is_read() {
    let reference = DepthReference::robot_120();
    let sighting = |object: &str, distance_m: f64, bearing_rad: f64| Sighting {
        object: object.into(),
        distance_m,
        bearing_rad,
        sigma_distance_m: 0.01,
        sigma_bearing_rad: 0.005,
    };
    let look = [sighting("cup", 0.8, 1.6), sighting("box", 0.9, 1.1)];
    let scene = QualitativeScene::qualify(look, &reference).unwrap();
    let map = AllocentricMap::new(&reference, QualifyParams::default()).unwrap();
    let map = map.with(&scene, GroundPose::default()).unwrap();
    let memory = SceneMemory::from_json(&serde_json::to_string(&map).unwrap()).unwrap();
    let depth = |depth| reference.labels(depth);
    let old = map.relation(&"cup".into(), &"box".into()).unwrap();
    let new = memory
        .relation(&"cup".into(), &"box".into(), &Observer::Robot)
        .unwrap();
    assert_eq!(depth(old.places.depth), depth(new.places.depth));
    assert_eq!(old.read, new.read);
    assert_eq!(life(&memory, "cup"), Life::OutOfView);
    let schema = r#"{"schema":"dorsal-memory/9"}"#;
    assert_eq!(
        SceneMemory::from_json(schema),
        Err(BadMemory::Schema("dorsal-memory/9".into()))
    );
    assert!(matches!(
        SceneMemory::from_json("{"),
        Err(BadMemory::Json(_))
    ));
    let text = memory.to_json();
    for (good, bad) in [
        (r#""last_look":1"#, r#""last_look":7"#),
        (r#""sightings":1"#, r#""sightings":0"#),
        (r#""looks":1"#, r#""looks":0"#),
    ] {
        assert!(text.contains(good));
        assert!(
            SceneMemory::from_json(&text.replace(good, bad)).is_err(),
            "{bad}"
        );
    }
}

fn poses() -> impl Strategy<Value = GroundPose> {
    (-1.0..1.0f64, -1.0..0.2f64, -0.8..0.8f64)
        .prop_map(|(x, z, heading)| GroundPose::new(x, z, heading).unwrap())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    /// Whatever is off by less than a standard error, seen from anywhere by a robot whose pose is
    /// off too, the truth is in every relation, and a reloaded memory says the same.
    #[test]
    fn relations_contain_the_truth(
        spots in proptest::collection::vec((-1.2..1.2f64, 0.4..2.4f64), 2..5),
        looks in proptest::collection::vec((poses(), -0.9..0.9f64, -0.9..0.9f64, -0.7..0.7f64), 1..5),
    ) {
        let mut memory = memory(MemoryParams { ground_mm: 0, ..MemoryParams::default() });
        let reference = memory.reference().clone();
        let mut last = GroundPose::default();
        for (k, &(told, off_x, off_z, off_turn)) in looks.iter().enumerate() {
            // The robot stands a centimetre and a hundredth of a radian from where it believes.
            let stands = GroundPose::new(
                told.x_m() + 0.007 * off_x, told.z_m() + 0.007 * off_z, told.heading_rad() + 0.01 * off_turn,
            ).unwrap();
            let (sin, cos) = stands.heading_rad().sin_cos();
            let observations = spots.iter().enumerate().map(|(name, &(x, z))| {
                let (dx, dz) = (x - stands.x_m(), z - stands.z_m());
                let (right, forward) = (dx * cos + dz * sin, dz * cos - dx * sin);
                Observation::from(Sighting {
                    object: format!("o{name}").into(),
                    distance_m: right.hypot(forward) + 0.007 * off_z,
                    bearing_rad: forward.atan2(right) + 0.003 * off_x,
                    sigma_distance_m: 0.01,
                    sigma_bearing_rad: 0.005,
                })
            }).collect();
            let pose = RobotPose::new(told, [[1e-4, 0.0], [0.0, 1e-4]], 0.01).unwrap();
            let look = Look { time_ms: k as u64, pose: PoseKnowledge::Known(pose), observations };
            memory.observe(&look, &NoDepth).unwrap();
            last = stands;
        }
        let read = SceneMemory::from_json(&memory.to_json()).unwrap();
        prop_assert_eq!(&read, &memory);
        prop_assert_eq!(read.to_json(), memory.to_json());
        for (i, &a) in spots.iter().enumerate() {
            for (j, &b) in spots.iter().enumerate().filter(|&(j, _)| j != i) {
                let name = |k: usize| format!("o{k}").into();
                let relation = memory.relation(&name(i), &name(j), &Observer::Robot).unwrap();
                let (front, way) = ((a.0 - last.x_m(), a.1 - last.z_m()), (b.0 - a.0, b.1 - a.1));
                let is = Orientation::of_offset(
                    front.0 * way.0 + front.1 * way.1, front.0 * way.1 - front.1 * way.0,
                );
                prop_assert!(relation.places.depth.contains(reference.qualify(way.0.hypot(way.1)).unwrap()));
                prop_assert!(relation.places.orientation.contains(is), "{is} {relation:?}");
            }
        }
    }

    /// A new look is asked for evidence where the object is, in the robot's own frame.
    #[test]
    fn evidence_is_asked_where_the_object_is(spot in (-1.0..1.0f64, 0.5..2.0f64), pose in poses()) {
        let room = room([("cup", [spot.0, spot.1])]);
        let mut memory = memory(MemoryParams { ground_mm: 0, ..MemoryParams::default() });
        let eye = Eye { half_rad: 3.2, reach_m: 9.0, ..Eye::new(&room, GroundPose::default()) };
        see(&mut memory, eye);
        let from = Eye { half_rad: 3.2, reach_m: 9.0, ..Eye::new(&room, pose) };
        let seen = from.look(0, STILL).observations[0].sighting.clone();
        let asked = std::cell::Cell::new(None);
        let look = Look { time_ms: 500, pose: PoseKnowledge::Known(pose.into()), observations: vec![] };
        let evidence = |place| { asked.set(Some(place)); Evidence::NoEvidence };
        memory.observe(&look, &evidence).unwrap();
        let place = asked.get().unwrap();
        prop_assert!((place.right_m.hypot(place.forward_m) - seen.distance_m).abs() < 1e-5);
        let turn = place.forward_m.atan2(place.right_m) - seen.bearing_rad;
        prop_assert!(turn.sin().abs() < 1e-4 && turn.cos() > 0.0);
        prop_assert!(LookEvidence::at(&NoDepth, place) == Evidence::NoEvidence);
    }

    /// No words make the reader panic, and what it reads it writes.
    #[test]
    fn any_words_are_read_or_refused(words in "(relation|within|left|of|from|to|robot|cup|vc|,|and|seen|radius|0.1|between|where| ){0,12}") {
        if let Ok(query) = words.parse::<Query>() {
            prop_assert_eq!(query.to_string().parse::<Query>(), Ok(query));
        }
    }
}
