use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Duration;

use anyhow::{Context, bail};

use crate::clocked::Clocked;

/// OpenCV's matchers, ready to be timed one run at a time, in turn with ours.
#[derive(Debug)]
pub(crate) struct OpencvClock {
    child: Child,
    orders: ChildStdin,
    answers: BufReader<ChildStdout>,
    /// OpenCV's.
    pub(crate) version: String,
}

/// What the script calls the matchers.
pub(crate) const MATCHERS: [&str; 4] = ["SGBM", "3WAY", "BM", "DIS"];

impl OpencvClock {
    /// Starts the script on a pair of pictures.
    pub(crate) fn start(
        python: &Path,
        (left, right): (&Path, &Path),
        shifts: usize,
        threads: usize,
    ) -> anyhow::Result<Self> {
        let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("python/opencv_clock.py");
        let mut child = Command::new(python)
            .arg(script)
            .args([left, right])
            .args([shifts.to_string(), threads.to_string()])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| format!("{} cannot be started", python.display()))?;
        let orders = child.stdin.take().context("the script takes orders")?;
        let answers = BufReader::new(child.stdout.take().context("the script answers")?);
        let mut clock = Self {
            child,
            orders,
            answers,
            version: String::new(),
        };
        clock.version = clock.answer()?;
        Ok(clock)
    }

    /// One run of a matcher.
    pub(crate) fn run(&mut self, matcher: &str) -> anyhow::Result<Clocked> {
        writeln!(self.orders, "{matcher}").context("OpenCV's script has ended")?;
        let answer = self.answer()?;
        let seconds = answer.split_whitespace().map(str::parse::<f64>);
        let seconds = seconds.collect::<Result<Vec<_>, _>>();
        let Ok([cpu, wall]) = seconds.as_deref() else {
            bail!("OpenCV's script said {answer:?} of {matcher} and not two numbers");
        };
        Ok(Clocked {
            cpu: Duration::try_from_secs_f64(*cpu)?,
            wall: Duration::try_from_secs_f64(*wall)?,
        })
    }

    fn answer(&mut self) -> anyhow::Result<String> {
        let mut line = String::new();
        if self.answers.read_line(&mut line)? == 0 {
            bail!("OpenCV's script ended; what it said stands above");
        }
        Ok(line.trim().to_owned())
    }
}

impl Drop for OpencvClock {
    fn drop(&mut self) {
        // It waits for orders, and no more will come.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
