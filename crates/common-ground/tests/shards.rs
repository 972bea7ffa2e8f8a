//! One map in two shards: what they answer together is what one map of all reports answers.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use allocentric_qsr::{Answer, DepthReference, LookLine, MemoryLine, PoseLine, SeenLine};
use common_ground::{Concourse, NoAnswer, Report, RobotId, Route, SharedMap, shared_params};
use proptest::prelude::*;

/// Things of a room, and rooms.
const THINGS: usize = 5;
const ROOMS: usize = 2;
const ROBOTS: usize = 4;

fn empty() -> SharedMap {
    SharedMap::new(&DepthReference::robot_120(), shared_params()).unwrap()
}

fn name(room: usize, thing: usize) -> String {
    format!("r{room}t{thing}")
}

/// Where a thing stands in the house.
fn place(room: usize, thing: usize) -> [f64; 2] {
    let angle = 2.4 * thing as f64 + room as f64;
    [
        4.0 * room as f64 + (1.0 + 0.2 * thing as f64) * angle.cos(),
        3.0 + angle.sin(),
    ]
}

/// A look of a robot, whose frame lies a third of a metre from the house's and turned, at some things of a room.
fn look(robot: usize, time_ms: u64, room: usize, things: &[usize]) -> MemoryLine {
    let (x, turn) = (0.3 * robot as f64, 0.7 * robot as f64);
    let seen = things.iter().map(|&thing| {
        let [right, forward] = place(room, thing);
        SeenLine {
            object: name(room, thing).into(),
            distance_m: (right - x).hypot(forward),
            bearing_rad: (forward.atan2(right - x) - turn).rem_euclid(TAU),
            sigma_distance_m: 0.02,
            sigma_bearing_rad: 0.01,
            radius_mm: 0,
            height_mm: 0,
        }
    });
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
        seen: seen.collect(),
        view: None,
    })
}

/// One map of all, and a shard for each room, that have taken the same looks.
struct House {
    whole: SharedMap,
    shards: [SharedMap; ROOMS],
    concourse: Concourse,
    sent: BTreeMap<(usize, usize), u64>,
}

impl House {
    fn new() -> Self {
        Self {
            whole: empty(),
            shards: [empty(), empty()],
            concourse: Concourse::new(ROOMS),
            sent: BTreeMap::new(),
        }
    }

    fn take(&mut self, robot: usize, room: usize, line: &MemoryLine) {
        let mut numbered = |to: usize| {
            let seq = self.sent.entry((robot, to)).or_default();
            *seq += 1;
            Report {
                robot: RobotId::new(format!("robot {robot}")),
                run: 1,
                seq: *seq,
                kept_from: None,
                line: line.clone(),
            }
        };
        assert!(self.whole.take(&numbered(ROOMS)).is_taken());
        let report = numbered(room);
        assert!(self.shards[room].take(&report).is_taken());
        if let MemoryLine::Look(look) = line {
            for seen in &look.seen {
                self.concourse.saw(room, &report.robot, &seen.object);
            }
        }
    }

    fn together(&self, route: &Route) -> SharedMap {
        let Route::Memories(robots) = route else {
            panic!("one shard alone is not put together")
        };
        let [one, other] = self.shards.each_ref().map(|shard| shard.part(robots));
        // Parts go over a network.
        let [one, other] = [one, other].map(|part| SharedMap::from_json(&part.to_json()).unwrap());
        one.together(&other).unwrap()
    }

    fn across(&self, robot: &RobotId, words: &str) -> Result<Answer, NoAnswer> {
        let route = self.concourse.across(robot, words)?;
        self.together(&route).ask(robot, words)
    }
}

/// An answer without the numbers of looks, which each memory counts for itself.
fn uncounted(answer: Result<Answer, NoAnswer>) -> Result<serde_json::Value, NoAnswer> {
    fn strip(value: &mut serde_json::Value) {
        if let Some(object) = value.as_object_mut() {
            object.remove("looks");
            object.values_mut().for_each(strip);
        }
        if let Some(list) = value.as_array_mut() {
            list.iter_mut().for_each(strip);
        }
    }
    answer.map(|answer| {
        let mut value = serde_json::to_value(answer).unwrap();
        strip(&mut value);
        value
    })
}

#[test]
fn what_a_shard_lacks_is_joined_through_a_robot_that_was_in_both() {
    let mut house = House::new();
    house.take(0, 0, &look(0, 10, 0, &[0, 1, 2]));
    house.take(1, 0, &look(1, 20, 0, &[0, 1]));
    house.take(1, 1, &look(1, 30, 1, &[0, 1]));
    house.take(2, 1, &look(2, 40, 1, &[0, 1, 4]));
    let first = RobotId::new("robot 0");
    let here = house.concourse.route(&first, "where r0t1").unwrap();
    assert_eq!(here, Route::Shard(0));
    // The first robot was never in the other room, and the one that saw the thing never in this one.
    let words = "relation r1t4 from r0t2 seen from robot";
    let route = house.concourse.route(&first, words).unwrap();
    let names = ["robot 0", "robot 1", "robot 2"];
    assert_eq!(route, Route::Memories(names.map(RobotId::new).into()));
    for shard in &house.shards {
        assert!(shard.ask(&first, words).is_err());
    }
    let across = house.across(&first, words);
    assert!(across.is_ok());
    assert_eq!(uncounted(across), uncounted(house.whole.ask(&first, words)));
    let Answer::Where {
        right_m, forward_m, ..
    } = house.across(&first, "where r1t4").unwrap()
    else {
        panic!("a place was asked for")
    };
    let [right, forward] = place(1, 4);
    assert!((right_m - right).hypot(forward_m - forward) < 1e-3);
    // Who is nowhere is told so, and so is what nobody saw.
    let nobody = RobotId::new("nobody");
    assert!(matches!(
        house.concourse.route(&nobody, words),
        Err(NoAnswer::Robot(_))
    ));
    assert!(matches!(
        house.across(&first, "where sofa"),
        Err(NoAnswer::Unknown(_))
    ));
}

/// A robot that has lost its pose in the one shard and not in the other is joined to itself by landmarks, or not at
/// all: nobody makes up where it was.
#[test]
fn frames_of_shards_that_differ_are_not_taken_for_one() {
    let mut house = House::new();
    house.take(0, 0, &look(0, 10, 0, &[0, 1, 2]));
    house.take(0, 1, &look(0, 20, 1, &[0, 1]));
    let MemoryLine::Look(mut lost) = look(0, 30, 1, &[0, 1]) else {
        unreachable!()
    };
    lost.pose = None;
    house.take(0, 1, &MemoryLine::Look(lost));
    let robot = RobotId::new("robot 0");
    let words = "relation r1t0 from r0t0";
    let answer = house
        .across(&robot, words)
        .map(|answer| serde_json::to_value(answer).unwrap());
    if let Ok(answer) = answer {
        let known = serde_json::to_value(house.whole.ask(&robot, words).unwrap()).unwrap();
        let classes =
            |answer: &serde_json::Value| answer["relation"]["depth"].as_array().map(Vec::len);
        assert!(
            classes(&answer) >= classes(&known),
            "{answer} is surer than {known}"
        );
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// However robots go about two rooms, the shards answer together as one map does, to the bit; and what one shard
    /// answers alone, one map can answer.
    #[test]
    fn shards_answer_as_one_map(
        looks in proptest::collection::vec(
            (0..ROBOTS, 0..ROOMS, proptest::sample::subsequence((0..THINGS).collect::<Vec<_>>(), 1..=THINGS)),
            1..16,
        ),
    ) {
        let mut house = House::new();
        for (time, (robot, room, things)) in looks.iter().enumerate() {
            let line = look(*robot, 10 * (time as u64 + 1), *room, things);
            house.take(*robot, *room, &line);
        }
        let names: Vec<String> =
            (0..ROOMS).flat_map(|room| (0..THINGS).map(move |thing| name(room, thing))).collect();
        let placed = names.iter().map(|name| format!("where {name}"));
        let related = names.iter().zip(names.iter().rev()).map(|(of, from)| format!("relation {of} from {from}"));
        let near = ["within vc,c,f of robot".to_owned()];
        for words in placed.chain(related).chain(near) {
            for robot in (0..ROBOTS).map(|robot| RobotId::new(format!("robot {robot}"))) {
                let whole = house.whole.ask(&robot, &words);
                let across = uncounted(house.across(&robot, &words));
                prop_assert_eq!(&across, &uncounted(whole.clone()), "{} asks {}", robot, words);
                if let Ok(Route::Shard(shard)) = house.concourse.route(&robot, &words)
                    && house.shards[shard].ask(&robot, &words).is_ok()
                {
                    prop_assert!(whole.is_ok());
                }
            }
        }
    }
}
