use std::time::{Duration, Instant};

/// A clock of the work that this process does, whatever else the machine does meanwhile.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CpuClock {
    wall: Instant,
    cpu: Option<Duration>,
}

impl CpuClock {
    pub(crate) fn start() -> Self {
        Self {
            wall: Instant::now(),
            cpu: of_all_threads(),
        }
    }

    /// CPU time of all threads since the start; wall time where the system does not tell.
    pub(crate) fn elapsed(self) -> Duration {
        match (self.cpu, of_all_threads()) {
            (Some(start), Some(now)) => now.saturating_sub(start),
            _ => self.wall.elapsed(),
        }
    }
}

/// Linux counts every thread's nanoseconds in a file.
fn of_all_threads() -> Option<Duration> {
    let threads = std::fs::read_dir("/proc/self/task").ok()?;
    let mut sum = 0;
    for thread in threads {
        let told = std::fs::read_to_string(thread.ok()?.path().join("schedstat")).ok()?;
        sum += told.split_whitespace().next()?.parse::<u64>().ok()?;
    }
    Some(Duration::from_nanos(sum))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sleep_is_no_work() {
        let clock = CpuClock::start();
        std::thread::sleep(Duration::from_millis(20));
        // Other tests share the process; wall time is all that bounds them everywhere.
        assert!(clock.elapsed() <= 64 * clock.wall.elapsed());
    }
}
