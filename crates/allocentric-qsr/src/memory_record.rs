use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::depth_reference::DepthReference;
use crate::ground_estimate::GroundEstimate;
use crate::memory_change::Dated;
use crate::memory_object::MemoryObject;
use crate::memory_params::{BadMemoryParams, MemoryParams};
use crate::place::owned_labels;
use crate::robot_pose::RobotPose;
use crate::scene_memory::SceneMemory;
use crate::told_fact::ToldFact;
use crate::{AllocentricMap, DepthSet, Life, Mode, ObjectId, Observer};

/// The form of a memory as data. A change of form changes the number.
const SCHEMA: &str = "dorsal-memory/1";

/// The form of a map of looks without lives, which is read too.
const MAP_SCHEMA: &str = "dorsal-map/1";

/// Why a text is no memory.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BadMemory {
    /// The text is not JSON of the expected form.
    #[error("not a memory: {0}")]
    Json(String),
    /// The data have another schema.
    #[error("schema `{0}` is unknown; this library reads `dorsal-memory/1` and `dorsal-map/1`")]
    Schema(String),
    /// The parameters cannot be.
    #[error(transparent)]
    Params(#[from] BadMemoryParams),
    /// An object is kept in a way no look can have left it.
    #[error("`{0}` is kept in a way no look leaves it")]
    Object(ObjectId),
    /// A fact is none of this system, or contradicts the rest.
    #[error("the fact about `{0}` and `{1}` cannot stand")]
    Fact(ObjectId, ObjectId),
}

/// A memory as data.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct MemoryRecord {
    schema: String,
    mode: Mode,
    reference: DepthReference,
    params: MemoryParams,
    looks: u64,
    time_ms: u64,
    frame: u32,
    robot: RobotPose,
    objects: BTreeMap<ObjectId, MemoryObject>,
    facts: Vec<FactRecord>,
    changes: Vec<Dated>,
    free: Vec<RunRecord>,
}

/// A run of squares seen free as data: row, first column, one past the last, and the look that saw them free last.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum RunRecord {
    Seen(i32, i32, i32, u64),
    /// Of a memory that did not keep when.
    Undated(i32, i32, i32),
}

/// A told fact as data, in labels.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct FactRecord {
    between: [ObjectId; 2],
    depth: Vec<String>,
}

/// The one field that every schema has.
#[derive(Deserialize)]
struct OnlySchema {
    schema: String,
}

impl SceneMemory {
    /// The memory as one line of JSON, the same bytes for the same memory. Write it beside the old
    /// one and rename, and a crash loses nothing that stood.
    ///
    /// # Panics
    /// Never: every part has a form in JSON.
    #[must_use]
    pub fn to_json(&self) -> String {
        let facts = self.facts.iter().map(|fact| FactRecord {
            between: fact.between.clone(),
            depth: owned_labels(&self.reference, fact.depth),
        });
        let record = MemoryRecord {
            schema: SCHEMA.to_owned(),
            mode: Mode::Sound,
            reference: self.reference.clone(),
            params: self.params,
            looks: self.looks,
            time_ms: self.time_ms,
            frame: self.frame,
            robot: self.robot,
            objects: self.objects.clone(),
            facts: facts.collect(),
            changes: self.changes.iter().cloned().collect(),
            free: self.free_record(),
        };
        serde_json::to_string(&record).expect("maps of strings and numbers have a form in JSON")
    }

    /// The squares of ground of the present frame that count as free, seen so lately and since anything
    /// was lost, in runs along x: row, first column and one past the last, of squares of
    /// [`MemoryParams::cell_mm`]; row 0 begins at z = 0, column 0 at x = 0.
    #[must_use]
    pub fn free_ground(&self) -> Vec<[i32; 3]> {
        let free = self.trusted_ground();
        let squares = self.free.keys().filter(|square| free(**square));
        let runs = runs(squares.map(|&(x, z)| (z, x, 0)));
        runs.map(|(row, from, to, _)| [row, from, to]).collect()
    }

    fn free_record(&self) -> Vec<RunRecord> {
        let squares = self.free.iter().map(|(&(x, z), &look)| (z, x, look));
        let runs = runs(squares);
        runs.map(|(row, from, to, look)| RunRecord::Seen(row, from, to, look))
            .collect()
    }

    /// Reads a memory, of this schema or the older one of an [`AllocentricMap`], whose objects
    /// come in as confirmed and out of view, in one frame, with default parameters.
    ///
    /// # Errors
    /// [`BadMemory`] says what is wrong; no half-read memory comes out.
    pub fn from_json(text: &str) -> Result<Self, BadMemory> {
        let json = |error: serde_json::Error| BadMemory::Json(error.to_string());
        let OnlySchema { schema } = serde_json::from_str(text).map_err(json)?;
        match schema.as_str() {
            SCHEMA => serde_json::from_str::<MemoryRecord>(text)
                .map_err(json)?
                .into_memory(),
            MAP_SCHEMA => of_map(&serde_json::from_str(text).map_err(json)?),
            _ => Err(BadMemory::Schema(schema)),
        }
    }

    /// The memory as a picture of Graphviz: objects with their life, and between each two seen in
    /// one frame the relation a person reads.
    #[must_use]
    pub fn to_dot(&self) -> String {
        let quoted = |name: &str| format!("{name:?}");
        let mut text = String::from("digraph memory {\n");
        for (name, kept) in self.objects() {
            text += &format!("  {} [tooltip=\"{}\"];\n", quoted(name.as_str()), kept.life);
        }
        let names: Vec<&ObjectId> = self.present().map(|(name, ..)| name).collect();
        for (at, from) in names.iter().enumerate() {
            for to in &names[at + 1..] {
                let relation = self.relation(from, to, &Observer::Robot);
                if let Some(read) = relation.and_then(|relation| relation.read) {
                    text += &format!(
                        "  {} -> {} [label=\"{} {}\"];\n",
                        quoted(from.as_str()),
                        quoted(to.as_str()),
                        self.reference.short(read.depth),
                        read.orientation.short(),
                    );
                }
            }
        }
        text + "}\n"
    }
}

impl MemoryRecord {
    fn into_memory(self) -> Result<SceneMemory, BadMemory> {
        let params = self.params.check()?;
        for (name, kept) in &self.objects {
            let given_up = kept.given_up_ms.unwrap_or(kept.last_time_ms);
            let seen = (1..=self.looks).contains(&kept.last_look)
                && (kept.last_time_ms..=self.time_ms).contains(&given_up);
            let placed = kept
                .places
                .iter()
                .all(|(&frame, place): (&u32, &GroundEstimate)| {
                    frame <= self.frame && place.is_sane()
                });
            if !(seen && placed && kept.sightings > 0) {
                return Err(BadMemory::Object(name.clone()));
            }
        }
        let mut facts = Vec::new();
        for FactRecord { between, depth } in self.facts {
            let named = depth.iter().map(|label| self.reference.class_named(label));
            let depth: Option<DepthSet> = named.collect();
            let [a, b] = between.clone();
            let depth = depth.filter(|depth| !depth.is_empty());
            let depth = depth.ok_or(BadMemory::Fact(a, b))?;
            facts.push(ToldFact { between, depth });
        }
        let looks = self.looks;
        let free = self.free.into_iter().flat_map(|run| {
            let (row, from, to, look) = match run {
                RunRecord::Seen(row, from, to, look) => (row, from, to, look.min(looks)),
                RunRecord::Undated(row, from, to) => (row, from, to, 0),
            };
            // A run longer than a memory may hold is cut.
            (from..to)
                .take(params.most_cells)
                .map(move |column| ((column, row), look))
        });
        let memory = SceneMemory {
            reference: self.reference,
            params,
            looks: self.looks,
            time_ms: self.time_ms,
            frame: self.frame,
            robot: self.robot,
            objects: self.objects,
            facts: Vec::new(),
            changes: self.changes.into(),
            free: free.take(params.most_cells).collect(),
        };
        let mut told = memory.clone();
        for fact in facts {
            let [a, b] = fact.between.clone();
            told.tell(fact).map_err(|_| BadMemory::Fact(a, b))?;
        }
        Ok(SceneMemory {
            facts: told.facts,
            ..memory
        })
    }
}

/// Squares as `(row, column, look)` in runs `(row, first column, one past the last, look)`.
fn runs(
    squares: impl Iterator<Item = (i32, i32, u64)>,
) -> impl Iterator<Item = (i32, i32, i32, u64)> {
    let mut squares: Vec<(i32, i32, u64)> = squares.collect();
    squares.sort_unstable();
    let mut runs: Vec<(i32, i32, i32, u64)> = Vec::new();
    for (row, column, look) in squares {
        match runs.last_mut() {
            Some((at, _, end, seen)) if *at == row && *end == column && *seen == look => *end += 1,
            _ => runs.push((row, column, column + 1, look)),
        }
    }
    runs.into_iter()
}

fn of_map(map: &AllocentricMap) -> Result<SceneMemory, BadMemory> {
    let params = MemoryParams {
        qualify: map.params,
        ..MemoryParams::default()
    };
    let mut memory = SceneMemory::new(map.reference(), params)?;
    memory.looks = map.looks();
    memory.robot = map.pose().into();
    memory.objects = map
        .objects()
        .map(|(name, kept)| {
            let object = MemoryObject {
                life: Life::OutOfView,
                // The map may claim exact places; a memory never does.
                places: BTreeMap::from([(0, kept.estimate.widened([[1e-6, 0.0], [0.0, 1e-6]]))]),
                last_look: kept.last_seen,
                last_time_ms: 0,
                sightings: 1,
                misses: 0,
                given_up_ms: None,
                epoch: 0,
                radius_mm: 0,
                height_mm: 0,
            };
            (name.clone(), object)
        })
        .collect();
    Ok(memory)
}
