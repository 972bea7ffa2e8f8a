use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::Life;
use crate::ground_estimate::GroundEstimate;

/// What a memory keeps of an object.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MemoryObject {
    /// Where in its life it is.
    pub life: Life,
    /// Where it is, by map frame; the sixteen latest that have seen it.
    pub places: BTreeMap<u32, GroundEstimate>,
    /// The look that shows it last, counted from 1.
    pub last_look: u64,
    /// The time of that look.
    pub last_time_ms: u64,
    /// How many looks have shown it since it appeared or moved.
    pub sightings: u64,
    /// How many looks in a row have shown free space in its place.
    pub misses: u32,
    /// When it was first found not to be in its place, in milliseconds, if it is missing or removed: free space was
    /// where it should be, often enough. Memories written before this was kept do not say.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub given_up_ms: Option<u64>,
    /// How often it has moved or come back from its tombstone.
    pub epoch: u32,
    /// The radius of the circle on the ground it stands in, in millimetres.
    pub radius_mm: u32,
    /// How high above the ground its middle is, in millimetres.
    pub height_mm: i32,
}
