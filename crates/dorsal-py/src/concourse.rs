use std::collections::BTreeSet;
use std::sync::{Mutex, MutexGuard, PoisonError};

use common_ground::{Contradiction, Route, SharedMap};
use pyo3::prelude::*;

use crate::refusal::value_error;
use crate::scene_record::json;
use crate::shared::no_answer;

/// Where the shards of a map meet: who has seen what in which shard.
#[pyclass(frozen, module = "dorsal._native")]
#[derive(Debug)]
pub(crate) struct Concourse {
    shards: usize,
    inner: Mutex<common_ground::Concourse>,
}

#[pymethods]
impl Concourse {
    #[new]
    fn new(shards: usize) -> Self {
        Self {
            shards,
            inner: Mutex::new(common_ground::Concourse::new(shards)),
        }
    }

    /// Notes that the map of this shard has a robot's sightings of objects.
    fn saw(&self, shard: usize, robot: &str, objects: Vec<String>) -> PyResult<()> {
        if shard >= self.shards {
            return Err(value_error(format!(
                "there is no shard {shard}; there are {}, counted from 0",
                self.shards
            )));
        }
        let mut inner = self.held();
        for object in objects {
            inner.saw(shard, &robot.into(), &object.as_str().into());
        }
        Ok(())
    }

    /// The shard that answers a question alone, or the robots whose memories are needed of all shards; these too if
    /// `across`.
    fn route(
        &self,
        robot: &str,
        words: &str,
        across: bool,
    ) -> PyResult<(Option<usize>, Vec<String>)> {
        let (inner, robot) = (self.held(), robot.into());
        let route = if across {
            inner.across(&robot, words)
        } else {
            inner.route(&robot, words)
        };
        match route.map_err(no_answer)? {
            Route::Shard(shard) => Ok((Some(shard), Vec::new())),
            Route::Memories(robots) => {
                let names = robots.iter().map(|robot| robot.as_str().to_owned());
                Ok((None, names.collect()))
            }
        }
    }
}

impl Concourse {
    fn held(&self) -> MutexGuard<'_, common_ground::Concourse> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The answer that parts of a map give together: in words, and as JSON.
#[pyfunction]
pub(crate) fn ask_together(
    py: Python<'_>,
    parts: Vec<String>,
    robot: &str,
    words: &str,
) -> PyResult<(String, String)> {
    let robot = robot.into();
    let answer = py.detach(|| together(&parts)?.ask(&robot, words).map_err(no_answer))?;
    Ok((answer.to_string(), json(&answer)?))
}

/// What robots contradict each other about in a map of parts, as JSON.
#[pyfunction]
pub(crate) fn contradictions_together(py: Python<'_>, parts: Vec<String>) -> PyResult<String> {
    let found: Vec<Contradiction> =
        py.detach(|| PyResult::Ok(together(&parts)?.contradictions()))?;
    json(&found)
}

fn together(parts: &[String]) -> PyResult<SharedMap> {
    let read = |text: &String| SharedMap::from_json(text).map_err(value_error);
    let maps: Vec<SharedMap> = parts.iter().map(read).collect::<PyResult<_>>()?;
    let Some((first, others)) = maps.split_first() else {
        return Err(value_error("there is no part to answer from"));
    };
    others.iter().try_fold(first.clone(), |joined, part| {
        joined.together(part).map_err(value_error)
    })
}

/// The names of robots as a set.
pub(crate) fn robots(names: Vec<String>) -> BTreeSet<common_ground::RobotId> {
    names.iter().map(|name| name.as_str().into()).collect()
}
