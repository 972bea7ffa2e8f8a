use std::time::{Duration, Instant};

use serde::{Serialize, Serializer};

/// What took how long, in the order of the steps.
///
/// The levels read no clock; this one stands beside them. As data an object of milliseconds.
#[derive(Clone, Debug, Default)]
pub(crate) struct Times(Vec<(&'static str, Duration)>);

impl Times {
    /// Does something and keeps how long it took.
    pub(crate) fn measure<T>(&mut self, step: &'static str, work: impl FnOnce() -> T) -> T {
        let start = Instant::now();
        let result = work();
        self.0.push((step, start.elapsed()));
        result
    }

    /// These steps and then those.
    pub(crate) fn and(mut self, those: Self) -> Self {
        self.0.extend(those.0);
        self
    }

    /// The steps and their milliseconds.
    pub(crate) fn milliseconds(&self) -> Vec<(&'static str, f64)> {
        let steps = self.0.iter();
        steps
            .map(|(step, time)| (*step, milliseconds(*time)))
            .collect()
    }

    /// The steps and their milliseconds, for a person.
    pub(crate) fn sentence(&self) -> String {
        let total: Duration = self.0.iter().map(|(_, time)| *time).sum();
        let steps = self
            .0
            .iter()
            .map(|(step, time)| format!("{step} {:.0}", milliseconds(*time)));
        let steps: Vec<String> = steps.collect();
        format!(
            "{} ms, together {:.0} ms",
            steps.join(", "),
            milliseconds(total)
        )
    }
}

impl Serialize for Times {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        // A hundredth of a millisecond is finer than any of them repeats.
        let rounded = |time| (milliseconds(time) * 100.0).round() / 100.0;
        serializer.collect_map(self.0.iter().map(|(step, time)| (step, rounded(*time))))
    }
}

fn milliseconds(time: Duration) -> f64 {
    time.as_secs_f64() * 1000.0
}
