//! From the truth of a rendered room to the memory: what is there is remembered, and what is taken
//! away is given up when it is seen to be gone, not before.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use dorsal::allocentric_qsr::{
    AskedPlace, DepthReference, Evidence, FreePath, GroundPose, Life, Look, LookEvidence as _,
    MemoryParams, ObjectId, Observer, PoseKnowledge, RobotPose, SceneMemory,
};
use dorsal::egocentric_depth::{DepthMap, EgocentricScene, LocateParams, StereoRig, locate};
use dorsal::v1_gabor::Size;
use dorsal::{DepthEvidence, Names, observations, radius_m};
use stereo_scenes::{Exposure, Room, View, render};

/// The eyes of the demo's head are so high above its table: 1.17 m and 0.75 m.
const EYES_M: f64 = 0.42;

/// The demo's room at a quarter of its resolution.
struct Stage {
    rig: StereoRig,
    view: View,
    scene: EgocentricScene,
    names: Names,
}

impl Stage {
    fn new() -> Self {
        let room = Room::demo();
        let head = room.head().resized(Size {
            width: 256,
            height: 192,
        });
        let gaze = head.fixate(room.fixation_m()).unwrap();
        let view = render(&room, &gaze, Exposure::default()).unwrap();
        let rig = gaze.rig();
        let truth = &view.truth;
        let scene = locate(&truth.depth, &truth.labels, &rig, &LocateParams::default()).unwrap();
        let names = room.names();
        Self {
            rig,
            names: names.map(|(l, name)| (l, name.to_owned())).collect(),
            scene,
            view,
        }
    }

    fn look(&self, time_ms: u64) -> Look {
        let seen = observations(&self.scene, &self.names, &self.rig, EYES_M);
        Look {
            time_ms,
            pose: PoseKnowledge::Known(RobotPose::default()),
            observations: seen.collect(),
        }
    }

    /// The look without one object.
    fn look_without(&self, object: &ObjectId, time_ms: u64) -> Look {
        let mut look = self.look(time_ms);
        look.observations
            .retain(|seen| seen.sighting.object != *object);
        look
    }

    /// The depth map with another depth on the pixels of one object.
    fn depth_with(&self, object: &str, depth_m: f32) -> DepthMap {
        let (label, _) = self
            .names
            .iter()
            .find(|(_, name)| name.as_str() == object)
            .unwrap();
        let mut metres = self.view.truth.depth.metres().to_owned();
        for ((y, x), metres) in metres.indexed_iter_mut() {
            if self.view.truth.labels.at(x, y) == Some(*label) {
                *metres = depth_m;
            }
        }
        DepthMap::new(metres)
    }

    fn evidence<'a>(&'a self, depth: &'a DepthMap) -> DepthEvidence<'a> {
        DepthEvidence::new(depth, &self.rig, EYES_M, 0.25)
    }
}

fn memory() -> SceneMemory {
    SceneMemory::new(&DepthReference::robot_120(), MemoryParams::default()).unwrap()
}

#[test]
fn what_is_taken_away_is_given_up_by_evidence_alone() {
    let stage = Stage::new();
    let cup = ObjectId::new("cup");
    let mut memory = memory();
    for time in 0..2 {
        let evidence = stage.evidence(&stage.view.truth.depth);
        memory.observe(&stage.look(time), &evidence).unwrap();
    }
    let life = |memory: &SceneMemory| memory.object(&cup).unwrap().life;
    assert_eq!(life(&memory), Life::InView);
    // A hole, and something in front, say nothing of the cup.
    for (depth_m, expected) in [(f32::NAN, Life::Confirmed), (0.3, Life::Occluded)] {
        let depth = stage.depth_with("cup", depth_m);
        for _ in 0..8 {
            let look = stage.look_without(&cup, memory.time_ms() + 1);
            memory.observe(&look, &stage.evidence(&depth)).unwrap();
        }
        if expected == Life::Confirmed {
            assert_eq!(life(&memory), expected);
        } else {
            assert!(matches!(life(&memory), Life::Occluded | Life::Confirmed));
        }
    }
    // The cup itself in its place, not reported: it is there.
    let look = stage.look_without(&cup, memory.time_ms() + 1);
    let evidence = stage.evidence(&stage.view.truth.depth);
    memory.observe(&look, &evidence).unwrap();
    assert_eq!(life(&memory), Life::Confirmed);
    // The far wall through the place of the cup.
    let depth = stage.depth_with("cup", 2.4);
    for expected in [Life::Confirmed, Life::Confirmed, Life::Missing] {
        let look = stage.look_without(&cup, memory.time_ms() + 1);
        memory.observe(&look, &stage.evidence(&depth)).unwrap();
        assert_eq!(life(&memory), expected);
    }
}

/// Places and sizes are those of the room, and the table before the cup is seen to be free.
#[test]
fn places_sizes_and_free_ground_are_true() {
    let stage = Stage::new();
    let mut memory = memory();
    let evidence = stage.evidence(&stage.view.truth.depth);
    memory.observe(&stage.look(0), &evidence).unwrap();
    for object in &stage.scene.objects {
        let kept = memory
            .object(&stage.names[&object.label].as_str().into())
            .unwrap();
        // Everything stands on the table and is less than half a metre high and wide.
        assert!((-20..500).contains(&kept.height_mm), "{}", kept.height_mm);
        let radius = radius_m(object, &stage.rig);
        assert!((0.01..0.3).contains(&radius), "{radius}");
        assert_eq!(kept.radius_mm, (radius * 1e3).round() as u32);
    }
    let at = |x: f64, z: f64| {
        let pose = GroundPose::new(x, z, 0.0);
        Observer::At(pose.unwrap())
    };
    // From the near edge of the table to just before the cup, which stands 0.89 m ahead.
    let way = memory.free_path(&at(-0.15, 0.72), &at(-0.05, 0.78), 0.02);
    assert_eq!(way, Some(FreePath::Clear));
    // Straight through the cup.
    let way = memory.free_path(&at(-0.23, 0.75), &at(-0.23, 1.1), 0.02);
    assert!(
        matches!(&way, Some(FreePath::Blocked { by }) if by.contains(&"cup".into())),
        "{way:?}"
    );
    // Behind the head nobody has looked.
    let way = memory.free_path(&at(0.0, -1.0), &at(0.6, -1.6), 0.02);
    assert!(matches!(way, Some(FreePath::Unknown { .. })), "{way:?}");
    let behind = AskedPlace {
        right_m: 0.0,
        forward_m: -1.0,
        height_m: 0.1,
        within_m: 0.05,
        radius_m: 0.0,
    };
    assert_eq!(evidence.at(behind), Evidence::OutOfView);
}
