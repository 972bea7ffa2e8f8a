use std::sync::{Mutex, MutexGuard, PoisonError};

use dorsal::allocentric_qsr::{
    GroundPose, Look as MemoryLook, MemoryParams, MemoryReply, NoDepth, Policy, PoseKnowledge,
    PoseLine, Query, RobotPose, SceneMemory,
};
use dorsal::egocentric_depth::LocateParams;
use dorsal::{DepthEvidence, observations};
use pyo3::prelude::*;

use crate::look::Look;
use crate::qsr::reference_system;
use crate::refusal::{Refused, value_error};
use crate::scene_record::json;
use crate::threads::without_the_lock;

/// A scene memory that several Python threads may hold; each call sees it whole.
#[pyclass(frozen, module = "dorsal._native")]
#[derive(Debug)]
pub(crate) struct Memory {
    memory: Mutex<SceneMemory>,
}

#[pymethods]
impl Memory {
    #[new]
    fn new(system: &str, policy: &str) -> PyResult<Self> {
        let params = MemoryParams {
            policy: match policy {
                "refuse" => Policy::Refuse,
                "follow" => Policy::Follow,
                other => {
                    return Err(value_error(format!(
                        "policy is '{other}'; it is 'refuse' or 'follow'"
                    )));
                }
            },
            ..MemoryParams::default()
        };
        let memory = SceneMemory::new(&reference_system(system)?, params);
        Ok(Self::of(memory.map_err(value_error)?))
    }

    #[staticmethod]
    fn from_json(text: &str) -> PyResult<Self> {
        Ok(Self::of(SceneMemory::from_json(text).map_err(value_error)?))
    }

    fn to_json(&self) -> String {
        self.held().to_json()
    }

    /// Takes one line of the memory's JSON and gives the reply's, or raises [`Refused`].
    fn take_line(&self, py: Python<'_>, line: &str) -> PyResult<String> {
        match without_the_lock(py, || self.held().take_line(line))? {
            MemoryReply::Refused(why) => Err(Refused::new_err(why)),
            reply => json(&reply),
        }
    }

    /// The answer to a question: in words, and as JSON.
    fn ask(&self, words: &str) -> PyResult<(String, String)> {
        let query: Query = words.parse().map_err(value_error)?;
        let answer = self.held().ask(&query);
        let answer = answer.map_err(|why| Refused::new_err(why.to_string()))?;
        Ok((answer.to_string(), json(&answer)?))
    }

    /// Takes a look of the eyes: its objects as sightings, its depth as evidence for what it does not show. The pose
    /// is JSON, and missing where it is lost. Gives the changes, as JSON.
    fn remember(
        &self,
        py: Python<'_>,
        look: &Bound<'_, Look>,
        time_ms: u64,
        pose: Option<&str>,
        eyes_above_ground_m: f64,
    ) -> PyResult<String> {
        let scene = look.get().scene.as_ref().ok_or_else(|| {
            value_error(
                "the look placed no objects; look with a rig and labels, or with segment=True",
            )
        })?;
        let seen = observations(
            &scene.egocentric,
            &scene.names,
            &scene.rig,
            eyes_above_ground_m,
        );
        let taken = MemoryLook {
            time_ms,
            pose: pose.map_or(Ok(PoseKnowledge::Lost), known)?,
            observations: seen.collect(),
        };
        let depth = look.get().depth_map();
        let changes = without_the_lock(py, || match depth {
            Some(depth) => {
                let sigma_px = LocateParams::default().disparity_sigma_px;
                let evidence = DepthEvidence::new(depth, &scene.rig, eyes_above_ground_m, sigma_px);
                self.held().observe(&taken, &evidence)
            }
            None => self.held().observe(&taken, &NoDepth),
        })?;
        json(&changes.map_err(|why| Refused::new_err(why.to_string()))?)
    }
}

impl Memory {
    const fn of(memory: SceneMemory) -> Self {
        Self {
            memory: Mutex::new(memory),
        }
    }

    /// The memory. A panic leaves it as it was, for it changes in one assignment.
    fn held(&self) -> MutexGuard<'_, SceneMemory> {
        self.memory.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn known(pose: &str) -> PyResult<PoseKnowledge> {
    let line: PoseLine = serde_json::from_str(pose).map_err(value_error)?;
    let pose = GroundPose::new(line.x_m, line.z_m, line.heading_rad).map_err(value_error)?;
    let variance = line.sigma_m * line.sigma_m;
    let covariance = [[variance, 0.0], [0.0, variance]];
    let robot = RobotPose::new(pose, covariance, line.sigma_heading_rad);
    Ok(PoseKnowledge::Known(robot.map_err(value_error)?))
}
