//! A room of points and a robot with a wide eye, for the laws of the memory.
#![allow(dead_code, reason = "each law uses some of them")]

use std::collections::BTreeMap;

use allocentric_qsr::{
    AskedPlace, DepthReference, Evidence, GroundPose, Look, LookEvidence, MemoryParams,
    Observation, PoseKnowledge, RobotPose, SceneMemory, Sighting,
};

/// Things of this radius stand in the room, in metres.
pub(crate) const RADIUS_M: f64 = 0.05;

/// Objects by name, at `[x, z]` in metres.
pub(crate) type Room = BTreeMap<String, [f64; 2]>;

pub(crate) fn room<'o>(objects: impl IntoIterator<Item = (&'o str, [f64; 2])>) -> Room {
    objects
        .into_iter()
        .map(|(name, at)| (name.to_owned(), at))
        .collect()
}

pub(crate) fn memory(params: MemoryParams) -> SceneMemory {
    SceneMemory::new(&DepthReference::robot_120(), params).expect("the parameters can be")
}

/// An eye at a pose: it sees what is within its angle and reach, behind nothing.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Eye<'r> {
    pub(crate) room: &'r Room,
    pub(crate) pose: GroundPose,
    /// Half the angle of view.
    pub(crate) half_rad: f64,
    pub(crate) reach_m: f64,
    /// Where the measurement fails: a circle in the robot's frame, right, forward, radius.
    pub(crate) hole: Option<[f64; 3]>,
}

impl<'r> Eye<'r> {
    pub(crate) fn new(room: &'r Room, pose: GroundPose) -> Self {
        Self {
            room,
            pose,
            half_rad: 0.6,
            reach_m: 3.0,
            hole: None,
        }
    }

    /// Right and forward of the robot.
    fn relative(&self, [x, z]: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = self.pose.heading_rad().sin_cos();
        let (dx, dz) = (x - self.pose.x_m(), z - self.pose.z_m());
        [dx * cos + dz * sin, dz * cos - dx * sin]
    }

    fn in_view(&self, [right, forward]: [f64; 2]) -> bool {
        right.hypot(forward) < self.reach_m && right.atan2(forward).abs() < self.half_rad
    }

    fn in_hole(&self, [right, forward]: [f64; 2]) -> bool {
        self.hole
            .is_some_and(|[r, f, radius]| (right - r).hypot(forward - f) < radius)
    }

    /// Whether something else stands on the line of sight to a place.
    fn hidden(&self, [right, forward]: [f64; 2]) -> bool {
        let distance = right.hypot(forward);
        self.room.values().any(|&other| {
            let [r, f] = self.relative(other);
            let along = (r * right + f * forward) / distance;
            let aside = (r * forward - f * right).abs() / distance;
            along > 0.0 && along < distance - 2.0 * RADIUS_M && aside < RADIUS_M
        })
    }

    /// The look, every measurement off by so many standard errors.
    pub(crate) fn look(&self, time_ms: u64, off: impl Fn(usize) -> [f64; 2]) -> Look {
        let seen = self.room.iter().enumerate().filter_map(|(k, (name, &at))| {
            let place = self.relative(at);
            if !self.in_view(place) || self.in_hole(place) || self.hidden(place) {
                return None;
            }
            let ([right, forward], [du, dv]) = (place, off(k));
            Some(Observation {
                sighting: Sighting {
                    object: name.as_str().into(),
                    distance_m: (right.hypot(forward) + 0.01 * du).max(0.0),
                    bearing_rad: forward.atan2(right) + 0.005 * dv,
                    sigma_distance_m: 0.01,
                    sigma_bearing_rad: 0.005,
                },
                radius_mm: (RADIUS_M * 1e3) as u32,
                height_mm: 0,
            })
        });
        Look {
            time_ms,
            pose: PoseKnowledge::Known(RobotPose::from(self.pose)),
            observations: seen.collect(),
        }
    }
}

impl LookEvidence for Eye<'_> {
    fn at(&self, place: AskedPlace) -> Evidence {
        let at = [place.right_m, place.forward_m];
        if !self.in_view(at) {
            return Evidence::OutOfView;
        }
        if self.in_hole(at) {
            return Evidence::NoEvidence;
        }
        if self.hidden(at) {
            return Evidence::Occluded;
        }
        let filled = self.room.values().any(|&other| {
            let [r, f] = self.relative(other);
            (r - at[0]).hypot(f - at[1]) < RADIUS_M + place.within_m
        });
        // A surface where the thing should be is neither behind nor in front of it.
        if filled {
            Evidence::NoEvidence
        } else {
            Evidence::FreeSpace
        }
    }
}
