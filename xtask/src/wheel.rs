use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use anyhow::{Context as _, bail, ensure};
use clap::Args;

use crate::python_environment::run;

/// Largest wheel that is a small one, in bytes.
const MOST_BYTES: u64 = 8_000_000;

/// What builds the wheel, from the Python package index.
const BUILDER: &str = "maturin==1.16.0";

/// What the tests run on. The wheel's own dependency is NumPy alone.
pub(crate) const TESTER: &str = "pytest==9.2.0";

/// Builds the Python wheel, installs it into a fresh virtual environment with NumPy alone, and tests it there
///
/// Needs python3 (3.10 or later, with venv and pip) and the Python package index, from which maturin, NumPy and pytest
/// are installed below the target folder. The wheel lands in `target/wheels`. It is built in the release profile
/// of the workspace and in its target folder, so that what both have in common is compiled once.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  cargo xtask wheel
  cargo xtask wheel --python python3.12
  python3 -m pip install target/wheels/dorsal-*.whl")]
pub(crate) struct Options {
    /// The Python that makes the virtual environments
    #[arg(long, value_name = "PYTHON", default_value = "python3")]
    python: PathBuf,

    /// Build and check the size only; nothing is installed into a fresh environment, no test runs
    #[arg(long)]
    no_tests: bool,
}

/// The folder of the repository and that of what is built.
pub(crate) fn folders() -> anyhow::Result<(&'static Path, PathBuf)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .context("xtask stands in the workspace")?;
    let target =
        std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), PathBuf::from);
    Ok((root, target))
}

/// Builds the wheel, checks its size, and says where it is.
pub(crate) fn build(python: &Path) -> anyhow::Result<PathBuf> {
    let (root, target) = folders()?;
    version_of(python)?;
    let builder = Environment::kept(&target.join("wheel-builder"), python, &[BUILDER])?;
    let wheels = target.join("wheels");
    if wheels.exists() {
        fs::remove_dir_all(&wheels)
            .with_context(|| format!("{} cannot be emptied", wheels.display()))?;
    }
    println!("Building the wheel; the first time this compiles what the workspace has not");
    run(Command::new(builder.program("maturin"))
        .args([
            "build",
            "--release",
            "--locked",
            "--quiet",
            "--manifest-path",
        ])
        .arg(root.join("crates/dorsal-py/Cargo.toml"))
        .arg("--target-dir")
        .arg(&target)
        .arg("--out")
        .arg(&wheels)
        .arg("--interpreter")
        .arg(builder.program("python")))?;
    let wheel = only_wheel(&wheels)?;
    let bytes = fs::metadata(&wheel)?.len();
    println!("{}: {:.2} MB", wheel.display(), bytes as f64 / 1e6);
    ensure!(
        bytes < MOST_BYTES,
        "a wheel of {bytes} bytes is larger than {MOST_BYTES}; look at what it links"
    );
    Ok(wheel)
}

pub(crate) fn run_task(options: &Options) -> anyhow::Result<()> {
    let (root, target) = folders()?;
    let wheel = build(&options.python)?;
    if options.no_tests {
        return Ok(());
    }

    let fresh = target.join("wheel-fresh");
    if fresh.exists() {
        fs::remove_dir_all(&fresh)
            .with_context(|| format!("{} cannot be removed", fresh.display()))?;
    }
    let fresh = Environment::make(&fresh, &options.python)?;
    fresh.install(&[&wheel.display().to_string()])?;
    fresh.has_numpy_alone()?;
    fresh.install(&[TESTER])?;
    println!("Building the command that the wheel is compared with");
    run(Command::new(env!("CARGO"))
        .args([
            "build",
            "--release",
            "--quiet",
            "--package",
            "dorsal-cli",
            "--target-dir",
        ])
        .arg(&target)
        .current_dir(root))?;
    let command = target
        .join("release")
        .join(format!("dorsal{}", std::env::consts::EXE_SUFFIX));
    run(Command::new(fresh.program("python"))
        .args(["-m", "pytest", "-p", "no:cacheprovider"])
        .env("DORSAL_COMMAND", command)
        .current_dir(root.join("crates/dorsal-py")))
}

/// Whether this Python is there, and recent enough for the wheel.
fn version_of(python: &Path) -> anyhow::Result<()> {
    let code = "import sys, venv; sys.exit(sys.version_info < (3, 10))";
    let output = Command::new(python).args(["-c", code]).output();
    let output = output.with_context(|| {
        format!(
            "{} cannot be started; install Python 3.10 or later, or name one with --python",
            python.display()
        )
    })?;
    if !output.status.success() {
        bail!(
            "{} is older than 3.10 or has no module venv: {}",
            python.display(),
            String::from_utf8_lossy(&output.stderr).trim()
        );
    }
    Ok(())
}

fn only_wheel(folder: &Path) -> anyhow::Result<PathBuf> {
    let entries =
        fs::read_dir(folder).with_context(|| format!("{} is not there", folder.display()))?;
    let mut wheels = Vec::new();
    for entry in entries {
        let path = entry?.path();
        if path.extension().is_some_and(|extension| extension == "whl") {
            wheels.push(path);
        }
    }
    match wheels.as_slice() {
        [wheel] => Ok(wheel.clone()),
        _ => bail!(
            "{} holds {} wheels, not one",
            folder.display(),
            wheels.len()
        ),
    }
}

/// A Python virtual environment.
pub(crate) struct Environment {
    folder: PathBuf,
}

impl Environment {
    /// The environment of these packages, made if it is not there yet.
    pub(crate) fn kept(folder: &Path, python: &Path, packages: &[&str]) -> anyhow::Result<Self> {
        let done = folder.join("installed");
        let wanted = packages.join(" ");
        let there = Self {
            folder: folder.to_owned(),
        };
        if fs::read_to_string(&done).is_ok_and(|installed| installed == wanted) {
            return Ok(there);
        }
        let made = Self::make(folder, python)?;
        made.install(packages)?;
        fs::write(&done, wanted)
            .with_context(|| format!("{} cannot be written", done.display()))?;
        Ok(made)
    }

    fn make(folder: &Path, python: &Path) -> anyhow::Result<Self> {
        println!("Making the virtual environment {}", folder.display());
        let made = run(Command::new(python).args(["-m", "venv"]).arg(folder));
        made.context("no virtual environment can be made; Debian has it in python3-venv")?;
        Ok(Self {
            folder: folder.to_owned(),
        })
    }

    pub(crate) fn install(&self, packages: &[&str]) -> anyhow::Result<()> {
        println!("Installing {} and what it needs", packages.join(" "));
        let installed = run(Command::new(self.program("python"))
            .args([
                "-m",
                "pip",
                "install",
                "--quiet",
                "--disable-pip-version-check",
            ])
            .args(packages));
        installed.context(
            "the Python package index does not give what is needed; is it reached from here?",
        )
    }

    /// Whether the environment holds `dorsal`, NumPy and what every environment has, and imports.
    fn has_numpy_alone(&self) -> anyhow::Result<()> {
        let code = "\
            import importlib.metadata as m; import dorsal; \
            print(*sorted({d.metadata['Name'] for d in m.distributions()} - {'pip', 'setuptools', 'wheel'}))";
        let output = Command::new(self.program("python"))
            .args(["-c", code])
            .output()?;
        ensure!(
            output.status.success(),
            "the wheel does not import: {}",
            String::from_utf8_lossy(&output.stderr)
        );
        let found = String::from_utf8_lossy(&output.stdout);
        ensure!(
            found.trim() == "dorsal numpy",
            "the wheel brings {} into a fresh environment, where dorsal and numpy should be alone",
            found.trim()
        );
        println!("It imports in an environment of: {}", found.trim());
        Ok(())
    }

    pub(crate) fn program(&self, name: &str) -> PathBuf {
        if cfg!(windows) {
            self.folder.join("Scripts").join(format!("{name}.exe"))
        } else {
            self.folder.join("bin").join(name)
        }
    }
}
