use serde::{Deserialize, Serialize};

use crate::ObjectId;
use crate::answer::Answer;
use crate::ground_pose::GroundPose;
use crate::look::{Look, Observation, PoseKnowledge};
use crate::look_evidence::{AskedPlace, Evidence, LookEvidence};
use crate::memory_change::Change;
use crate::robot_pose::RobotPose;
use crate::scene_memory::SceneMemory;
use crate::sighting::Sighting;

/// One line in: a look, a question, or a fact told or taken back.
///
/// ```json
/// {"look": {"time_ms": 40, "pose": {"x_m": 0, "z_m": 0, "heading_rad": 0},
///   "seen": [{"object": "cup", "distance_m": 0.8, "bearing_rad": 1.6,
///             "sigma_distance_m": 0.01, "sigma_bearing_rad": 0.005}],
///   "view": {"half_rad": 0.5, "reach_m": 2.5}}}
/// {"ask": "within c of robot"}
/// {"tell": "lamp within vc of cup"}
/// {"retract": "lamp within vc of cup"}
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum MemoryLine {
    /// A look.
    Look(LookLine),
    /// A question in the query language.
    Ask(String),
    /// A fact in words.
    Tell(String),
    /// A told fact, to be taken back.
    Retract(String),
}

/// A look as data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LookLine {
    /// When, in milliseconds.
    pub time_ms: u64,
    /// Where from; without it the robot has lost its pose.
    pub pose: Option<PoseLine>,
    /// What it shows.
    pub seen: Vec<SeenLine>,
    /// What the sensor covers; without it a look says nothing of what it does not show.
    pub view: Option<ViewLine>,
}

/// A pose as data; errors left out are zero.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PoseLine {
    /// Right of the origin, in metres.
    pub x_m: f64,
    /// Forward of the origin, in metres.
    pub z_m: f64,
    /// Turn to the left, in radians.
    pub heading_rad: f64,
    /// Standard error of the position along each axis, in metres.
    #[serde(default)]
    pub sigma_m: f64,
    /// Standard error of the heading, in radians.
    #[serde(default)]
    pub sigma_heading_rad: f64,
}

/// A sighting as data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SeenLine {
    /// What.
    pub object: ObjectId,
    /// Horizontal distance, in metres.
    pub distance_m: f64,
    /// Direction over the ground, in radians: front pi/2, right 0.
    pub bearing_rad: f64,
    /// Standard error of the distance, in metres.
    pub sigma_distance_m: f64,
    /// Standard error of the bearing, in radians.
    pub sigma_bearing_rad: f64,
    /// Radius on the ground, in millimetres.
    #[serde(default)]
    pub radius_mm: u32,
    /// Height of its middle above the ground, in millimetres.
    #[serde(default)]
    pub height_mm: i32,
}

/// What a sensor covers: a sector ahead in which it would have reported whatever stands there, but
/// for what a seen object hides.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViewLine {
    /// Half the angle of view, in radians.
    pub half_rad: f64,
    /// How far it reports, in metres.
    pub reach_m: f64,
}

/// One line out.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum MemoryReply {
    /// What became different.
    Changes(Vec<Change>),
    /// The answer.
    Answer(Answer),
    /// Why the line was refused; the memory stays as it was.
    Refused(String),
}

impl SceneMemory {
    /// Takes one line of JSON and answers with one.
    ///
    /// A line that cannot be read, or is refused, answers [`MemoryReply::Refused`] and leaves the
    /// memory as it was.
    pub fn take_line(&mut self, line: &str) -> MemoryReply {
        let refused = |error: &dyn std::fmt::Display| MemoryReply::Refused(error.to_string());
        match serde_json::from_str(line) {
            Ok(line) => self.take(line),
            Err(error) => refused(&error),
        }
    }

    /// Takes a line that has been read, and answers it as [`SceneMemory::take_line`] does.
    pub fn take(&mut self, line: MemoryLine) -> MemoryReply {
        let refused = |error: &dyn std::fmt::Display| MemoryReply::Refused(error.to_string());
        let changes = match line {
            MemoryLine::Ask(words) => {
                return match words.parse() {
                    Ok(query) => match self.ask(&query) {
                        Ok(answer) => MemoryReply::Answer(answer),
                        Err(error) => refused(&error),
                    },
                    Err(error) => refused(&error),
                };
            }
            MemoryLine::Look(look) => match look.read() {
                Ok((look, view)) => self.observe(&look, &view),
                Err(why) => return MemoryReply::Refused(why),
            },
            MemoryLine::Tell(words) => match self.read_fact(&words) {
                Ok(fact) => self.tell(fact),
                Err(error) => return refused(&error),
            },
            MemoryLine::Retract(words) => match self.read_fact(&words) {
                Ok(fact) => self.retract(&fact),
                Err(error) => return refused(&error),
            },
        };
        changes.map_or_else(|error| refused(&error), MemoryReply::Changes)
    }
}

impl LookLine {
    /// The look and what it says of places where nothing was reported.
    ///
    /// # Errors
    /// The sentence of what is wrong with the pose; sightings are checked when the look is taken.
    fn read(self) -> Result<(Look, Sector), String> {
        let pose = match self.pose {
            None => PoseKnowledge::Lost,
            Some(line) => {
                let pose = GroundPose::new(line.x_m, line.z_m, line.heading_rad)
                    .map_err(|error| error.to_string())?;
                let variance = line.sigma_m * line.sigma_m;
                let covariance = [[variance, 0.0], [0.0, variance]];
                let robot = RobotPose::new(pose, covariance, line.sigma_heading_rad)
                    .map_err(|error| error.to_string())?;
                PoseKnowledge::Known(robot)
            }
        };
        let hides = self.seen.iter().map(|seen| {
            let (sin, cos) = seen.bearing_rad.sin_cos();
            let at = [seen.distance_m * cos, seen.distance_m * sin];
            (at, f64::from(seen.radius_mm) / 1e3)
        });
        let sector = Sector {
            view: self.view,
            hides: hides.collect(),
        };
        let observations = self.seen.into_iter().map(|seen| Observation {
            sighting: Sighting {
                object: seen.object,
                distance_m: seen.distance_m,
                bearing_rad: seen.bearing_rad,
                sigma_distance_m: seen.sigma_distance_m,
                sigma_bearing_rad: seen.sigma_bearing_rad,
            },
            radius_mm: seen.radius_mm,
            height_mm: seen.height_mm,
        });
        let look = Look {
            time_ms: self.time_ms,
            pose,
            observations: observations.collect(),
        };
        Ok((look, sector))
    }
}

/// The evidence of a stated view: where the sensor would have reported something, and what stands
/// in front, `[right, forward]` with its radius.
struct Sector {
    view: Option<ViewLine>,
    hides: Vec<([f64; 2], f64)>,
}

impl LookEvidence for Sector {
    fn at(&self, place: AskedPlace) -> Evidence {
        let Some(view) = self.view else {
            return Evidence::NoEvidence;
        };
        let (right, forward) = (place.right_m, place.forward_m);
        let distance = right.hypot(forward);
        let inside = distance < view.reach_m && right.atan2(forward).abs() < view.half_rad;
        if !inside {
            return Evidence::OutOfView;
        }
        let reach = |([r, f], radius): &([f64; 2], f64)| {
            let along = (r * right + f * forward) / distance;
            let aside = (r * forward - f * right).abs() / distance;
            (along, aside <= radius + place.within_m)
        };
        let mut met = self
            .hides
            .iter()
            .map(reach)
            .filter(|(along, met)| *met && *along > 0.0);
        // What stands at the place itself is neither before nor behind it.
        if met
            .clone()
            .any(|(along, _)| along < distance - place.within_m)
        {
            Evidence::Occluded
        } else if met.any(|(along, _)| along <= distance + place.within_m) {
            Evidence::NoEvidence
        } else {
            Evidence::FreeSpace
        }
    }
}
