//! The Python in which OpenCV's matchers run.

use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context, bail};

/// What the environment needs, from the Python package index.
const PACKAGES: [&str; 2] = ["numpy==2.4.6", "opencv-python-headless==5.0.0.93"];

/// The interpreter of a virtual environment with [`PACKAGES`], which is made below the target folder
/// if it is not there yet.
pub(crate) fn ready(target: &Path) -> anyhow::Result<PathBuf> {
    let folder = target.join("opencv-python");
    let python = folder.join(if cfg!(windows) {
        "Scripts/python.exe"
    } else {
        "bin/python"
    });
    let done = folder.join("installed");
    let wanted = PACKAGES.join(" ");
    if std::fs::read_to_string(&done).is_ok_and(|installed| installed == wanted) {
        return Ok(python);
    }
    println!(
        "Installing {wanted} from the Python package index into {}",
        folder.display()
    );
    run(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
    run(Command::new(&python)
        .args(["-m", "pip", "install", "--quiet"])
        .args(PACKAGES))?;
    std::fs::write(&done, wanted)
        .with_context(|| format!("{} cannot be written", done.display()))?;
    Ok(python)
}

/// Runs a command to its end.
pub(crate) fn run(command: &mut Command) -> anyhow::Result<()> {
    let status = command
        .status()
        .with_context(|| format!("{command:?} cannot be started"))?;
    if !status.success() {
        bail!("{command:?} ended with {status}");
    }
    Ok(())
}
