use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

use anyhow::{Context, ensure};
use serde::Serialize;
use v1_gabor::Size;

use super::scene::Scene;

/// The most memory that a `dorsal look` held.
#[derive(Debug, Serialize)]
pub(crate) struct LookMemory {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// What it was asked for.
    pub(crate) arguments: String,
    pub(crate) peak_mib: f64,
    /// What it may hold at the most.
    pub(crate) mark_mib: f64,
}

/// Sizes with a mark: width, height, MiB.
const MARKS: [(usize, usize, f64); 2] = [(1024, 768, 200.0), (1920, 1080, 500.0)];

/// What a look of this size may hold, if there is a mark.
pub(super) fn mark_mib(size: Size) -> Option<f64> {
    let mark = MARKS
        .iter()
        .find(|mark| (mark.0, mark.1) == (size.width, size.height));
    mark.map(|mark| mark.2)
}

/// What a look is asked for beside its pictures and the folder of its results.
const LOOKS: [&[&str]; 3] = [
    &[],
    &["--rig", "rig.toml", "--labels", "labels.png"],
    &[
        "--rig",
        "rig.toml",
        "--labels",
        "labels.png",
        "--estimator",
        "dense",
    ],
];

/// The program, built if need be beside this one.
pub(super) fn dorsal() -> anyhow::Result<PathBuf> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| OsString::from("cargo"));
    let own = std::env::current_exe().context("this program does not know its place")?;
    let folder = own.parent().context("this program stands in a folder")?;
    let target = folder
        .parent()
        .context("cargo builds into target/PROFILE")?;
    let mut build = Command::new(cargo);
    build
        .args(["build", "--quiet", "--package", "dorsal-cli"])
        .arg("--target-dir")
        .arg(target)
        .current_dir(env!("CARGO_MANIFEST_DIR"));
    if !cfg!(debug_assertions) {
        build.arg("--release");
    }
    let built = build.status().context("cargo cannot be started")?;
    ensure!(built.success(), "dorsal-cli does not build; see above");
    let path = folder.join(format!("dorsal{}", std::env::consts::EXE_SUFFIX));
    ensure!(path.is_file(), "{} is not there", path.display());
    Ok(path)
}

/// The looks at this size, if it has a mark; none where the system does not tell a process's memory.
pub(super) fn look_memory(scene: &Scene, dorsal: &Path) -> anyhow::Result<Vec<LookMemory>> {
    let Size { width, height } = scene.size();
    let Some(mark_mib) = mark_mib(scene.size()) else {
        return Ok(Vec::new());
    };
    let folder = tempfile::tempdir().context("there is no room for the pictures")?;
    scene.write(folder.path())?;
    let mut looks = Vec::new();
    for arguments in LOOKS {
        // The rig is that of the parallel eyes.
        let eyes = if arguments.is_empty() {
            ["verged-left.pgm", "verged-right.pgm"]
        } else {
            ["parallel-left.pgm", "parallel-right.pgm"]
        };
        let mut look = Command::new(dorsal);
        look.arg("look")
            .args(eyes)
            .args(["--out", "out", "--quiet"]);
        look.args(arguments).current_dir(folder.path());
        let Some(peak_mib) = peak_mib(look)? else {
            return Ok(Vec::new());
        };
        looks.push(LookMemory {
            width,
            height,
            arguments: arguments.join(" "),
            peak_mib,
            mark_mib,
        });
    }
    Ok(looks)
}

/// Runs a command to its end and gives the most memory that was resident, in MiB, as Linux tells it;
/// asked every millisecond, since an ended process no longer says.
fn peak_mib(mut command: Command) -> anyhow::Result<Option<f64>> {
    let mut child = command
        .stdout(Stdio::null())
        .spawn()
        .context("dorsal cannot be started")?;
    let status = format!("/proc/{}/status", child.id());
    let mut peak = None;
    loop {
        let text = std::fs::read_to_string(&status).unwrap_or_default();
        let line = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.trim().trim_end_matches("kB").trim().parse().ok());
        // What it was before the command took the child's place is this program's.
        let kib: Option<f64> = kib.filter(|_| text.starts_with("Name:\tdorsal"));
        peak = kib.map(|kib| kib / 1024.0).or(peak);
        if let Some(ended) = child.try_wait().context("dorsal cannot be waited for")? {
            ensure!(ended.success(), "dorsal look failed; see above");
            return Ok(peak);
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}
