use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use anyhow::{Context, bail};
use clap::Args;
use serde::{Deserialize, Serialize};

/// What is installed where no Python with OpenCV is named.
const PACKAGES: [&str; 2] = ["numpy", "opencv-python-headless"];

/// Where OpenCV, the yardstick beside us, comes from.
#[derive(Args, Debug)]
pub(crate) struct OpenCvOptions {
    /// A Python 3 that has numpy and OpenCV; without it, a virtual environment below target/ is
    /// made once, and numpy and opencv-python-headless are installed into it from PyPI
    #[arg(long, value_name = "PATH", conflicts_with = "no_opencv")]
    python: Option<PathBuf>,
    /// Leave OpenCV's rows out: no Python is started and nothing is installed
    #[arg(long)]
    no_opencv: bool,
}

/// A Python that has OpenCV.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct OpenCv {
    python: PathBuf,
}

/// One thing that `python/opencv_peer.py` does; it reads pictures and writes one array.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
#[serde(tag = "matcher", rename_all = "snake_case")]
pub(crate) enum Job {
    /// Block matching.
    Bm(StereoJob),
    /// Semi-global block matching.
    Sgbm(StereoJob),
    /// Farneback's polynomial expansion.
    Farneback(FlowJob),
    /// Dense inverse search, the medium preset.
    Dis(FlowJob),
}

/// A disparity over `least .. least + count` pixels, `x_left - x_right`; `out` gets float32 `(y, x)`,
/// NaN unknown.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct StereoJob {
    /// The left picture.
    pub(crate) left: PathBuf,
    /// The right picture.
    pub(crate) right: PathBuf,
    /// The least disparity, in whole pixels.
    pub(crate) least: i32,
    /// How many, a multiple of 16.
    pub(crate) count: i32,
    /// The array to write.
    pub(crate) out: PathBuf,
}

/// A flow; `out` gets float32 `(2, y, x)`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub(crate) struct FlowJob {
    /// The earlier frame.
    pub(crate) prev: PathBuf,
    /// The later frame.
    pub(crate) next: PathBuf,
    /// The array to write.
    pub(crate) out: PathBuf,
}

/// What the script says when all jobs are done.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub(crate) struct Done {
    /// OpenCV's version.
    pub(crate) version: String,
    /// Seconds of computing for each job, reading and writing left out.
    pub(crate) seconds: Vec<f64>,
}

impl OpenCvOptions {
    /// The Python to use; `None` if OpenCV is to be left out, or is not there and cannot be
    /// installed, which is said on standard error.
    pub(crate) fn find(&self) -> anyhow::Result<Option<OpenCv>> {
        if self.no_opencv {
            return Ok(None);
        }
        if let Some(python) = &self.python {
            if !has_opencv(python) {
                bail!(
                    "{} does not import numpy and cv2; install {} for it, or leave --python out",
                    python.display(),
                    PACKAGES.join(" and ")
                );
            }
            return Ok(Some(OpenCv {
                python: python.clone(),
            }));
        }
        match environment() {
            Ok(python) => Ok(Some(OpenCv { python })),
            Err(reason) => {
                eprintln!("note: OpenCV's rows are left out: {reason:#}");
                Ok(None)
            }
        }
    }
}

impl OpenCv {
    /// Runs the jobs one after another in one process; `advance` is called after each.
    pub(crate) fn run(
        &self,
        jobs: &[Job],
        scratch: &Path,
        mut advance: impl FnMut(),
    ) -> anyhow::Result<Done> {
        let list = scratch.join("jobs.json");
        std::fs::write(&list, serde_json::to_vec(jobs)?)
            .with_context(|| format!("{} cannot be written", list.display()))?;
        let script = scratch.join("opencv_peer.py");
        std::fs::write(&script, include_str!("../python/opencv_peer.py"))
            .with_context(|| format!("{} cannot be written", script.display()))?;
        let mut child = Command::new(&self.python)
            .arg(&script)
            .arg(&list)
            .stdout(Stdio::piped())
            .spawn()
            .with_context(|| format!("{} cannot be started", self.python.display()))?;
        let mut last = String::new();
        if let Some(said) = child.stdout.take() {
            for line in BufReader::new(said).lines() {
                last = line.context("OpenCV's script does not speak UTF-8")?;
                if last == "done" {
                    advance();
                }
            }
        }
        let status = child.wait().context("OpenCV's script was lost")?;
        if !status.success() {
            bail!("OpenCV's script ended with {status}; what it said stands above");
        }
        serde_json::from_str(&last)
            .with_context(|| format!("OpenCV's script ended with the line {last:?}"))
    }
}

/// The Python of our own virtual environment, made if need be.
fn environment() -> anyhow::Result<PathBuf> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .context("the repository is not where this program was built")?;
    let folder = root.join("target").join("opencv-python");
    let python = if cfg!(windows) {
        folder.join("Scripts").join("python.exe")
    } else {
        folder.join("bin").join("python3")
    };
    if has_opencv(&python) {
        return Ok(python);
    }
    eprintln!(
        "note: making {} and installing {} there from PyPI; --python PATH names a Python that has \
         them, --no-opencv does without",
        folder.display(),
        PACKAGES.join(" and ")
    );
    let system = if cfg!(windows) { "python" } else { "python3" };
    succeed(Command::new(system).args(["-m", "venv"]).arg(&folder))?;
    let mut install = Command::new(&python);
    install.args([
        "-m",
        "pip",
        "install",
        "--quiet",
        "--disable-pip-version-check",
    ]);
    succeed(install.args(PACKAGES))?;
    Ok(python)
}

fn succeed(command: &mut Command) -> anyhow::Result<()> {
    let program = command.get_program().to_owned();
    let program = Path::new(&program).display();
    let status = command
        .stdout(Stdio::null())
        .status()
        .with_context(|| format!("{program} cannot be started"))?;
    if !status.success() {
        bail!("{program} ended with {status}");
    }
    Ok(())
}

fn has_opencv(python: &Path) -> bool {
    Command::new(python)
        .args(["-c", "import numpy, cv2"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()
        .is_ok_and(|status| status.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_reads_as_the_script_expects() {
        let job = Job::Dis(FlowJob {
            prev: "a.png".into(),
            next: "b.png".into(),
            out: "c.npy".into(),
        });
        assert_eq!(
            serde_json::to_value(job).unwrap(),
            serde_json::json!({"matcher": "dis", "prev": "a.png", "next": "b.png", "out": "c.npy"})
        );
    }

    #[test]
    fn a_program_that_is_no_python_is_refused() {
        let options = OpenCvOptions {
            python: Some("no such python".into()),
            no_opencv: false,
        };
        let refused = options.find().unwrap_err().to_string();
        assert!(refused.contains("numpy and cv2"), "{refused}");
        let left_out = OpenCvOptions {
            python: None,
            no_opencv: true,
        };
        assert_eq!(left_out.find().unwrap(), None);
    }
}
