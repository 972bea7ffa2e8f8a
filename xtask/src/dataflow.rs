use std::path::PathBuf;
use std::process::Command;

use clap::Args;

use crate::python_environment::run;
use crate::wheel::{Environment, TESTER, build, folders};

/// What the graphs run on beside the wheel, from the Python package index.
const PACKAGES: [&str; 4] = [
    "dora-rs==1.1.0",
    "dora-rs-cli==1.1.0",
    "mcap==1.6.0",
    TESTER,
];

/// Runs the graphs of `crates/dorsal-dataflow` on real daemons of dora-rs, and tests what comes of them
///
/// Needs python3 (3.10 or later, with venv and pip) and the Python package index. The wheel is built, and with
/// dora-rs, MCAP and pytest installed into an environment below the target folder. The graph of two machines
/// needs root and the command `ip`, for it makes two network namespaces; without them that test is left out,
/// and pytest says so.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  cargo xtask dataflow
  cargo xtask dataflow -- -k three_robots")]
pub(crate) struct Options {
    /// The Python that makes the virtual environment
    #[arg(long, value_name = "PYTHON", default_value = "python3")]
    python: PathBuf,

    /// What goes to pytest
    #[arg(last = true, value_name = "ARGUMENT")]
    pytest: Vec<String>,
}

pub(crate) fn run_task(options: &Options) -> anyhow::Result<()> {
    let (root, target) = folders()?;
    let wheel = build(&options.python)?;
    let environment = Environment::kept(&target.join("dataflow"), &options.python, &PACKAGES)?;
    environment.install(&[
        "--force-reinstall",
        "--no-deps",
        &wheel.display().to_string(),
    ])?;
    run(Command::new(environment.program("python"))
        .args(["-m", "pytest", "-p", "no:cacheprovider", "-rs", "tests"])
        .args(&options.pytest)
        .current_dir(root.join("crates/dorsal-dataflow")))
}
