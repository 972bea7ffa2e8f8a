use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::Args;
use dorsal_scan::{LAST_LOOKS, Scan, ScanParams, figure_12, random_room};

use crate::clocked::clocked;
use crate::date;
use crate::docs_folder::docs_folder;
use crate::eval_middlebury::{progress, write_file};
use crate::machine::Machine;
use crate::scan_in_results;
use crate::scan_run::{ScanRun, Scanned};

/// Lets a head scan random rooms, and counts what its map gets right.
///
/// Every room has another head, with other errors; half way one thing is moved. Prints and writes how
/// many relations hold the truth, how much they say, what is missed, and whether a way was called clear
/// that is not.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask eval-scan
  cargo xtask eval-scan --rooms 5 --check --results out/scan.md")]
pub(crate) struct Options {
    /// How many rooms
    #[arg(long, value_name = "N", default_value_t = 50, value_parser = clap::value_parser!(u64).range(1..))]
    rooms: u64,
    /// The first room's number
    #[arg(long, value_name = "N", default_value_t = 1)]
    first: u64,
    /// How often the head fixates in each
    #[arg(long, value_name = "N", default_value_t = 8)]
    fixations: usize,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the page of results to this file; without it, to docs/scan.md
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
    /// Fail if a mark is missed
    #[arg(long)]
    check: bool,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let progress = progress(options.quiet);
    progress.set_length(options.rooms);
    let mut run = ScanRun::new(date::today(), Machine::this(), options.fixations);
    for room in options.first..options.first + options.rooms {
        progress.set_message(format!("room {room}"));
        let scanned = scan(room, options.fixations).with_context(|| format!("room {room}"))?;
        run.rooms.push(scanned);
        progress.inc(1);
    }
    progress.finish_and_clear();
    println!("{run}");
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&run)?)?;
    }
    let docs = || docs_folder().map(|docs| docs.join("scan.md"));
    if let Some(path) = options.results.clone().or_else(docs) {
        write_file(&path, run.page().as_bytes())?;
    }
    if let (None, Some(docs)) = (&options.results, docs_folder()) {
        scan_in_results::refresh(&docs)?;
    }
    match run.missed() {
        Some(missed) if options.check => bail!(missed),
        _ => Ok(()),
    }
}

/// How many looks the question for a hand's way may cost.
const WAY_LOOKS: usize = 3;

fn scan(room: u64, fixations: usize) -> anyhow::Result<Scanned> {
    let params = ScanParams {
        fixations,
        seed: room,
        ..ScanParams::default()
    };
    let mut scan = Scan::begin(random_room(room)?, params)?;
    let mut times = Vec::new();
    let mut refused = 0;
    let mut moved = None;
    while let Some(fixation) = scan.next() {
        let stirred = scan.stir();
        moved = moved.or_else(|| stirred.clone());
        let shown = scan.show(&fixation)?;
        let (look, clocked) = clocked(|| scan.perceive(shown, stirred));
        times.push(clocked);
        refused += usize::from(look?.refused.is_some());
    }
    for _ in 0..LAST_LOOKS {
        let Some(fixation) = scan.make_sure() else {
            break;
        };
        let shown = scan.show(&fixation)?;
        let (look, clocked) = clocked(|| scan.perceive(shown, None));
        times.push(clocked);
        refused += usize::from(look?.refused.is_some());
    }
    // The ways are asked for as in the demo; these looks are not timed, for they look twice.
    if let Some([grasped, _]) = figure_12(scan.memory()) {
        for _ in 0..WAY_LOOKS {
            let Some(fixation) = scan.on_the_way(&grasped) else {
                break;
            };
            let shown = scan.show(&fixation)?;
            refused += usize::from(scan.perceive(shown, None)?.refused.is_some());
        }
    }
    Ok(Scanned::new(room, &scan.score()?, &times, refused, moved))
}
