use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard, PoisonError};

use common_ground::{BadJournal, Durability, Journal, NoAnswer, Report, RobotId, shared_params};
use pyo3::exceptions::PyOSError;
use pyo3::prelude::*;

use crate::concourse::robots;
use crate::qsr::reference_system;
use crate::refusal::{Refused, value_error};
use crate::scene_record::json;

/// A map of several robots in a folder, that several Python threads may hold; each call sees it whole.
#[pyclass(frozen, module = "dorsal._native")]
#[derive(Debug)]
pub(crate) struct SharedMap {
    journal: Mutex<Journal>,
}

#[pymethods]
impl SharedMap {
    #[new]
    fn new(
        py: Python<'_>,
        folder: PathBuf,
        system: &str,
        through_power_cuts: bool,
    ) -> PyResult<Self> {
        let reference = reference_system(system)?;
        let durability = if through_power_cuts {
            Durability::Machine
        } else {
            Durability::Process
        };
        let open = || Journal::open(&folder, &reference, shared_params(), durability);
        let journal = py.detach(open).map_err(os_error)?;
        Ok(Self {
            journal: Mutex::new(journal),
        })
    }

    /// Takes reports, JSON each, and gives their receipts, JSON each: with one write for all.
    fn take(&self, py: Python<'_>, reports: Vec<String>) -> PyResult<Vec<String>> {
        let read = |text: &String| serde_json::from_str(text).map_err(value_error);
        let reports: Vec<Report> = reports.iter().map(read).collect::<PyResult<_>>()?;
        let receipts = py.detach(|| self.held().take_all(&reports));
        let receipts = receipts.map_err(os_error)?;
        receipts.iter().map(json).collect()
    }

    /// The answer to a question of a robot: in words, and as JSON.
    fn ask(&self, py: Python<'_>, robot: &str, words: &str) -> PyResult<(String, String)> {
        let robot = RobotId::new(robot);
        let answer = py.detach(|| self.held().map().ask(&robot, words));
        let answer = answer.map_err(no_answer)?;
        Ok((answer.to_string(), json(&answer)?))
    }

    /// What every two robots contradict each other about, as JSON.
    fn contradictions(&self, py: Python<'_>) -> PyResult<String> {
        json(&py.detach(|| self.held().map().contradictions()))
    }

    /// The whole map as JSON.
    fn to_json(&self, py: Python<'_>) -> String {
        py.detach(|| self.held().map().to_json())
    }

    /// What the map keeps of these robots, as JSON in the form of the whole.
    fn part(&self, py: Python<'_>, names: Vec<String>) -> String {
        let wanted = robots(names);
        py.detach(|| self.held().map().part(&wanted).to_json())
    }

    /// Which objects each robot has seen, by robot, tombstones that were let go left out.
    fn roster(&self) -> BTreeMap<String, Vec<String>> {
        let held = self.held();
        let robots = held.map().robots().map(|(robot, kept)| {
            let objects = kept.memory.objects();
            let objects = objects.map(|(object, _)| object.as_str().to_owned());
            (robot.as_str().to_owned(), objects.collect())
        });
        robots.collect()
    }

    /// The memory of one robot as JSON; `None` if it has reported nothing.
    fn memory(&self, robot: &str) -> Option<String> {
        let held = self.held();
        Some(held.map().robot(&RobotId::new(robot))?.memory.to_json())
    }

    /// Writes a snapshot and begins a new journal.
    fn snapshot(&self, py: Python<'_>) -> PyResult<()> {
        py.detach(|| self.held().snapshot()).map_err(os_error)
    }
}

impl SharedMap {
    fn held(&self) -> MutexGuard<'_, Journal> {
        self.journal.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Words that are no question are a `ValueError`, what is not known is `Refused`.
pub(crate) fn no_answer(why: NoAnswer) -> PyErr {
    match why {
        NoAnswer::Words(why) => value_error(why),
        other => Refused::new_err(other.to_string()),
    }
}

fn os_error(error: BadJournal) -> PyErr {
    match error {
        BadJournal::File(..) | BadJournal::Held(_) => PyOSError::new_err(error.to_string()),
        _ => value_error(error),
    }
}
