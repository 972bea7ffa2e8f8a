use std::time::{Duration, Instant};

use cpu_time::ProcessTime;

/// What one run took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clocked {
    /// Of all threads.
    pub(crate) cpu: Duration,
    pub(crate) wall: Duration,
}

/// Times a run of ours.
pub(crate) fn clocked<T>(run: impl FnOnce() -> T) -> (T, Clocked) {
    let (cpu, wall) = (ProcessTime::now(), Instant::now());
    let result = run();
    let clocked = Clocked {
        cpu: cpu.elapsed(),
        wall: wall.elapsed(),
    };
    (result, clocked)
}
