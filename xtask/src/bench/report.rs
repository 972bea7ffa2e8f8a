use std::collections::BTreeMap;
use std::time::Duration;

use serde::Serialize;
use v1_gabor::Size;

use super::ceilings::Ceilings;
use super::counts::Count;
use super::look_memory::LookMemory;
use super::memory_use::MemoryUse;
use super::shares::Share;
use super::spread::Spread;
use crate::clocked::Clocked;
use crate::machine::Machine;

/// What was measured.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    pub(crate) schema: &'static str,
    pub(crate) date: String,
    pub(crate) machine: Machine,
    pub(crate) command: String,
    pub(crate) threads: u16,
    pub(crate) rounds: u16,
    /// OpenCV's version, if it ran.
    pub(crate) opencv: Option<String>,
    /// What a core can do, in the same run.
    pub(crate) ceilings: Option<Ceilings>,
    pub(crate) sizes: Vec<AtSize>,
    /// How the time a pixel varies over the sizes, if there are several.
    pub(crate) spreads: Vec<Spread>,
    /// Instructions, if they were counted.
    pub(crate) counts: Vec<Count>,
    /// Why they were not, if they were asked for.
    pub(crate) uncounted: Option<String>,
    /// How many times faster than OpenCV's SGBM, by CPU medians (with peers only; `vector_vs_sgbm` is the
    /// pyramid without its look back, `vector_default_vs_sgbm` with it), and whole looks a second by the
    /// median wall time on two threads, at the size that comes nearest to 1024 x 768.
    pub(crate) ratios: BTreeMap<&'static str, f64>,
}

/// The contestants at one size.
#[derive(Debug, Serialize)]
pub(crate) struct AtSize {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) contestants: Vec<Contestant>,
    /// The same on two threads, for those that are asked.
    pub(crate) two_threads: Vec<TwoThreads>,
    /// What ours ask of the allocator.
    pub(crate) memory: Vec<MemoryUse>,
    /// How near the vector pyramid comes to the ceilings.
    pub(crate) shares: Vec<Share>,
    /// What `dorsal look` holds at the most.
    pub(crate) looks: Vec<LookMemory>,
}

/// One contestant on one thread and on two, in the same rounds.
#[derive(Debug, Serialize)]
pub(crate) struct TwoThreads {
    pub(crate) name: &'static str,
    /// Median wall time.
    pub(crate) wall_ms: f64,
    /// The median over the rounds of the wall time on as many threads as all contestants have over this one.
    pub(crate) times_faster: f64,
}

/// One contestant's medians.
#[derive(Debug, Serialize)]
pub(crate) struct Contestant {
    pub(crate) name: &'static str,
    pub(crate) cpu_ms: f64,
    pub(crate) least_cpu_ms: f64,
    pub(crate) wall_ms: f64,
    pub(crate) cpu_ns_a_pixel: f64,
}

impl Contestant {
    pub(super) fn new(name: &'static str, runs: &[Clocked], size: Size) -> Self {
        let sorted = |of: fn(&Clocked) -> Duration| {
            let mut times: Vec<f64> = runs.iter().map(|run| of(run).as_secs_f64() * 1e3).collect();
            times.sort_by(f64::total_cmp);
            times
        };
        let (cpu, wall) = (sorted(|run| run.cpu), sorted(|run| run.wall));
        let middle = runs.len() / 2;
        Self {
            name,
            cpu_ms: cpu[middle],
            least_cpu_ms: cpu[0],
            wall_ms: wall[middle],
            cpu_ns_a_pixel: cpu[middle] * 1e6 / size.area() as f64,
        }
    }
}
