mod at_size;
mod callgrind;
mod ceilings;
mod contender;
mod contestants;
mod counts;
mod dense_stream;
mod depths;
mod flops;
pub(crate) mod frames;
mod look_memory;
mod matching;
mod median;
mod memory_use;
mod objects;
mod page;
mod pair;
mod peers;
mod picture;
mod profile_page;
mod ratios;
mod report;
mod responding;
mod scene;
mod shares;
mod size_argument;
mod spread;
mod stage;
mod unfused;
mod whole_look;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use v1_gabor::Size;

use crate::date;
use crate::docs_folder::docs_folder;
use crate::eval_middlebury::{progress, write_file};
use crate::machine::Machine;
use crate::python_environment;
use at_size::{Programs, at_size};
use ceilings::Roof;
use counts::{COUNTED, counts};
use look_memory::{dorsal, mark_mib};
use page::bench_page;
use picture::{PICTURE, picture};
use profile_page::profile_page;
use ratios::ratios;
use report::Report;
use shares::shares;
use size_argument::size;
use spread::spreads;

/// Disparities that the dense estimators search, ours and others.
const SHIFTS: usize = 128;

/// Time the levels on a rendered pair, with OpenCV's matchers in turn
///
/// Renders the project's own room at each size and runs every contestant once a round, so that what
/// else the machine does meets all of them alike; the medians of the rounds stand. A contestant's time
/// goes from the images to the field: for the vector pyramid with both banks. With --peers OpenCV's
/// SGBM, its three-way mode, BM (all with 128 disparities) and DIS run in the same rounds, in a
/// Python of their own (see compare-opencv). A whole look goes on from both fields to depths, objects and
/// relations. Some contestants run on two threads too. Beside the times it measures what each asks of the
/// allocator, what `dorsal look` holds in memory, and what a core can do at the most. Writes
/// docs/performance.md and its picture if all sizes run with --peers.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask bench
  cargo xtask bench --size 1024x768 --peers --json out/bench.json
  cargo xtask bench --peers --counts --rounds 5
  cargo xtask bench --profile --size 1024x768
  cargo xtask bench --size 640x480 --threads 2 --rounds 21")]
pub(crate) struct Options {
    /// Size of the images; may be given more than once. Without it 384x288, 640x480, 1024x768 and
    /// 1920x1080
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Vec<Size>,
    /// Rounds, each with one run of every contestant
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// Threads of every contestant
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    threads: u16,
    /// Run OpenCV's matchers too
    #[arg(long)]
    peers: bool,
    /// Count instructions too, with valgrind where it is there; takes minutes
    #[arg(long)]
    counts: bool,
    /// Count instructions, and write docs/profile.md: where the time of one look goes
    #[arg(long)]
    profile: bool,
    /// A Python that has numpy and OpenCV already; nothing is installed then
    #[arg(long, value_name = "PATH", requires = "peers")]
    python: Option<PathBuf>,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let all = options.size.is_empty();
    let sizes = if all {
        let sizes = [(384, 288), (640, 480), (1024, 768), (1920, 1080)];
        sizes.map(|(width, height)| Size { width, height }).to_vec()
    } else {
        options.size.clone()
    };
    let python = match (&options.python, options.peers) {
        (_, false) => None,
        (Some(python), true) => Some(python.clone()),
        (None, true) => {
            let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent();
            let root = root.context("the task stands in the repository")?;
            Some(python_environment::ready(&root.join("target"))?)
        }
    };
    let mut report = Report {
        schema: "dorsal-bench-2",
        date: date::today(),
        machine: Machine::this(),
        command: command(options),
        threads: options.threads,
        rounds: options.rounds,
        opencv: None,
        ceilings: None,
        sizes: Vec::new(),
        spreads: Vec::new(),
        counts: Vec::new(),
        uncounted: None,
        ratios: BTreeMap::new(),
    };
    let marked = sizes.iter().any(|&size| mark_mib(size).is_some());
    let dorsal = if marked { Some(dorsal()?) } else { None };
    let programs = Programs {
        python: python.as_deref(),
        dorsal: dorsal.as_deref(),
    };
    let mut roof = Roof::new();
    let bar = progress(false);
    bar.set_length(sizes.len() as u64 * u64::from(options.rounds));
    for &size in &sizes {
        let (at_size, version) = at_size(size, programs, options, &mut roof, &bar)?;
        report.sizes.push(at_size);
        report.opencv = version;
    }
    bar.finish_and_clear();
    let ceilings = roof.ceilings();
    for at in &mut report.sizes {
        at.shares = shares(at, &ceilings);
    }
    report.ceilings = Some(ceilings);
    report.spreads = spreads(&report.sizes);
    report.ratios = ratios(&report.sizes);
    if options.counts || options.profile {
        match counts(&COUNTED)? {
            Ok(counts) => report.counts = counts,
            Err(why) => report.uncounted = Some(why),
        }
    }
    println!("{}", bench_page(&report));
    if options.profile
        && let (Some(page), Some(docs)) = (profile_page(&report), docs_folder())
    {
        println!("{page}");
        write_file(&docs.join("profile.md"), page.as_bytes())?;
    }
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&report)?)?;
    }
    if all
        && options.peers
        && let Some(docs) = docs_folder()
    {
        write_file(&docs.join("performance.md"), bench_page(&report).as_bytes())?;
        if let Some(svg) = picture(&report) {
            write_file(&docs.join(PICTURE), svg.as_bytes())?;
        }
    }
    Ok(())
}

/// The command that measures the same again.
fn command(options: &Options) -> String {
    let mut command = "cargo xtask bench".to_owned();
    for size in &options.size {
        command += &format!(" --size {}x{}", size.width, size.height);
    }
    if options.peers {
        command += " --peers";
    }
    if options.counts {
        command += " --counts";
    }
    if options.profile {
        command += " --profile";
    }
    command + &format!(" --threads {} --rounds {}", options.threads, options.rounds)
}

#[cfg(test)]
mod tests {
    use indicatif::ProgressBar;

    use super::contestants::{ON_TWO, OURS};
    use super::*;

    /// Ours run, each a round, and no ratio is claimed without a peer.
    #[test]
    fn a_small_bench_runs() {
        let options = Options {
            size: Vec::new(),
            rounds: 1,
            threads: 1,
            peers: false,
            counts: false,
            profile: false,
            python: None,
            json: None,
        };
        let size = Size {
            width: 160,
            height: 120,
        };
        let mut roof = Roof::new();
        let (at_size, version) = at_size(
            size,
            Programs::default(),
            &options,
            &mut roof,
            &ProgressBar::hidden(),
        )
        .unwrap();
        assert!(at_size.memory.iter().all(|one| one.workspace_bytes > 0));
        let ceilings = roof.ceilings();
        assert!(ceilings.fma_gflops > 0.0 && ceilings.copy_gb_s > 0.0);
        let shares = shares(&at_size, &ceilings);
        assert!(
            shares
                .iter()
                .all(|share| share.of_fma > 0.0 && share.of_fma < 1.0)
        );
        assert_eq!(at_size.contestants.len(), OURS.len());
        assert!(at_size.contestants.iter().all(|one| one.wall_ms > 0.0));
        assert_eq!(at_size.two_threads.len(), ON_TWO.len());
        assert!(at_size.two_threads.iter().all(|one| one.times_faster > 0.0));
        let ratios = ratios(&[at_size]);
        assert!(version.is_none() && ratios.keys().eq(["looks_per_second"].iter()));
    }
}
