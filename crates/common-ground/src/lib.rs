#![doc = include_str!("../README.md")]

mod concourse;
mod contradiction;
mod journal;
mod receipt;
mod report;
mod robot_id;
mod robot_memory;
mod roster;
mod shard;
mod shared_map;
mod shared_question;
mod shared_record;

pub use concourse::{Concourse, Route};
pub use contradiction::{Contradiction, Witness};
pub use journal::{BadJournal, Durability, Journal};
pub use receipt::{Receipt, Verdict};
pub use report::Report;
pub use robot_id::RobotId;
pub use robot_memory::RobotMemory;
pub use shard::NotOneMap;
pub use shared_map::{SharedMap, shared_params};
pub use shared_question::NoAnswer;
pub use shared_record::BadSharedMap;
