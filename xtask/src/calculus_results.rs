use std::path::PathBuf;
use std::process::Command;

use anyhow::{Context as _, bail, ensure};
use clap::Args;

use crate::check_soundness::{self, Soundness};
use crate::date;
use crate::machine::Machine;
use crate::soak_memory::{self, Soak};

/// Measures level 4 and writes docs/calculus-results.md: soundness, a long life, and what closure
/// and memory cost.
///
/// It runs `check-soundness`, `soak-memory` and `cargo bench -p allocentric-qsr --bench closure`.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask calculus-results
  cargo xtask calculus-results --page out/page.md --scenes 100000 --looks 1000

Exit codes: 0 everything held and the page is written, 1 otherwise.")]
pub(crate) struct Options {
    /// The page
    #[arg(long, value_name = "FILE", default_value = "docs/calculus-results.md")]
    page: PathBuf,
    /// How many scenes are checked
    #[arg(long, value_name = "N", default_value_t = 3_000_000)]
    scenes: u64,
    /// How many looks the memory lives
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(900..))]
    looks: u64,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    // The bench first, while the machine is as it was found.
    let bench = bench()?;
    let soundness = check_soundness::check(&check_soundness::Options {
        scenes: options.scenes,
        seed: 1,
        quiet: options.quiet,
    });
    print!("{soundness}");
    let soak = soak_memory::live(&soak_memory::Options {
        looks: options.looks,
        quiet: options.quiet,
    })?;
    print!("{soak}");
    if !soundness.holds() {
        bail!("the calculus is not sound; the page is not written");
    }
    let page = page(&soundness, &soak, &bench);
    stereo_formats::replace(&options.page, page.as_bytes())
        .with_context(|| format!("{} cannot be written", options.page.display()))?;
    println!("{}", options.page.display());
    Ok(())
}

/// What the bench says of itself, without the figures of its harness.
fn bench() -> anyhow::Result<String> {
    let arguments = ["bench", "-p", "allocentric-qsr", "--bench", "closure", "--"];
    let output = Command::new("cargo")
        .args(arguments)
        // The harness measures nothing under this name; the bench prints its own figures.
        .arg("no such name")
        .output()
        .context("cargo cannot be run")?;
    ensure!(
        output.status.success(),
        "the bench failed:\n{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let text = String::from_utf8_lossy(&output.stdout);
    let own = text.lines().filter(|line| line.starts_with("- "));
    let own: Vec<&str> = own.collect();
    ensure!(!own.is_empty(), "the bench printed no figures");
    Ok(own.join("\n"))
}

fn page(soundness: &Soundness, soak: &Soak, bench: &str) -> String {
    let Machine {
        cpu,
        cores,
        rustc,
        build,
    } = Machine::this();
    format!(
        "# Results of level 4\n\n\
         Written by `cargo xtask calculus-results`; edits by hand are lost.\n\n\
         - date: {}\n- machine: {cpu}, {cores} cores\n- compiler: {rustc}, {build} build\n\n\
         ## Soundness\n\n`cargo xtask check-soundness`\n\n```text\n{soundness}```\n\n\
         ## A long life\n\n`cargo xtask soak-memory`\n\n```text\n{soak}```\n\n\
         ## What it costs\n\n\
         `cargo bench -p allocentric-qsr --bench closure`. Full closures are CPU time, the best of \
         several runs; single facts are the median of the wall time of 200. The marks are those \
         the design sets.\n\n{bench}\n",
        date::today()
    )
}
