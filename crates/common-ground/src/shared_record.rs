//! A shared map as one line of JSON.

use std::collections::BTreeMap;

use allocentric_qsr::{BadMemory, BadMemoryParams, DepthReference, MemoryParams, SceneMemory};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use crate::robot_memory::RobotMemory;
use crate::{RobotId, SharedMap};

/// The form of a shared map as data. A change of form changes the number.
const SCHEMA: &str = "dorsal-shared-map/1";

/// Why a text is no shared map.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BadSharedMap {
    /// The text is not JSON of the expected form.
    #[error("not a shared map: {0}")]
    Json(String),
    /// The data have another schema.
    #[error("schema `{0}` is unknown; this library reads `dorsal-shared-map/1`")]
    Schema(String),
    /// The parameters cannot be.
    #[error(transparent)]
    Params(#[from] BadMemoryParams),
    /// The memory of a robot cannot be.
    #[error("the memory of robot `{0}`: {1}")]
    Memory(RobotId, BadMemory),
    /// The memory of a robot has another reference system or other parameters than the map.
    #[error("the memory of robot `{0}` is measured by another system than the map")]
    System(RobotId),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SharedRecord {
    schema: String,
    reference: DepthReference,
    params: MemoryParams,
    robots: BTreeMap<RobotId, RobotRecord>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RobotRecord {
    run: u64,
    seq: u64,
    lost: u64,
    refused: u64,
    /// The text of the memory: it is neither read nor written twice.
    memory: Box<RawValue>,
}

/// The one field that every schema has.
#[derive(Deserialize)]
struct OnlySchema {
    #[serde(default)]
    schema: String,
}

impl SharedMap {
    /// The map as one line of JSON, the same bytes for the same map: a snapshot for a robot that joins late, each
    /// `memory` in the form of [`SceneMemory::to_json`].
    ///
    /// # Panics
    /// Never: every part has a form in JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        let robots = self.robots.iter().map(|(robot, kept)| {
            let memory = RawValue::from_string(kept.memory.to_json());
            let record = RobotRecord {
                run: kept.last.0,
                seq: kept.last.1,
                lost: kept.lost,
                refused: kept.refused,
                memory: memory.expect("a memory writes JSON"),
            };
            (robot.clone(), record)
        });
        let record = SharedRecord {
            schema: SCHEMA.to_owned(),
            reference: self.reference.clone(),
            params: self.params,
            robots: robots.collect(),
        };
        serde_json::to_string(&record).expect("maps of strings and numbers have a form in JSON")
    }

    /// Reads a shared map.
    ///
    /// # Errors
    /// [`BadSharedMap`] says what is wrong; no half-read map comes out.
    pub fn from_json(text: &str) -> Result<Self, BadSharedMap> {
        let json = |error: serde_json::Error| BadSharedMap::Json(error.to_string());
        let OnlySchema { schema } = serde_json::from_str(text).map_err(json)?;
        if schema != SCHEMA {
            return Err(BadSharedMap::Schema(schema));
        }
        let record: SharedRecord = serde_json::from_str(text).map_err(json)?;
        let map = Self::new(&record.reference, record.params)?;
        let mut robots = BTreeMap::new();
        for (robot, kept) in record.robots {
            let memory = SceneMemory::from_json(kept.memory.get())
                .map_err(|error| BadSharedMap::Memory(robot.clone(), error))?;
            if *memory.reference() != map.reference || memory.params() != map.params {
                return Err(BadSharedMap::System(robot));
            }
            let kept = RobotMemory {
                last: (kept.run, kept.seq),
                lost: kept.lost,
                refused: kept.refused,
                memory,
            };
            robots.insert(robot, kept);
        }
        Ok(map.of_robots(robots))
    }
}
