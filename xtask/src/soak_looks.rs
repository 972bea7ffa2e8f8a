use std::fmt;

use anyhow::{Context, bail};
use clap::Args;
use dorsal::allocentric_qsr::SceneMemory;
use dorsal_scan::{Scan, ScanParams, Shown};
use stereo_scenes::Room;

use crate::eval_middlebury::progress;

/// Looks a thousand times in one process, and watches its memory.
///
/// A head sees a few rendered views again and again, from two pictures to the map. The most memory that
/// the process ever held may not be more than a twentieth above what it was after the tenth look: what is
/// resident between two looks says less, for the allocator gives pages back as it likes.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask soak-looks
  cargo xtask soak-looks --looks 100

Exit codes: 0 memory is flat, 1 otherwise.")]
pub(crate) struct Options {
    /// How many looks
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u64).range(20..))]
    looks: u64,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// How much more the process may ever hold than after the tenth look.
const GROWTH: f64 = 1.05;

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let text = include_str!("../../crates/stereo-scenes/rooms/scan.toml");
    let room = Room::from_toml(&text.replace("size_px = [640, 480]", "size_px = [320, 240]"))?;
    let params = ScanParams {
        fixations: usize::try_from(options.looks)?,
        moves: false,
        ..ScanParams::default()
    };
    let mut scan = Scan::begin(room, params)?;
    let progress = progress(options.quiet);
    progress.set_length(options.looks);
    let mut views: Vec<Shown> = Vec::new();
    let mut tenth = Memory::default();
    for look in 1..=options.looks {
        if views.len() < 4 {
            let fixation = scan.next().context("a scan has a next fixation")?;
            views.push(scan.show(&fixation)?);
        }
        // A view is copied for each look; what the look leaves is dropped.
        let shown = views[(look % views.len() as u64) as usize].clone();
        scan.perceive(shown, None)?;
        if look == 10 {
            tenth = Memory::now(scan.memory())?;
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    let end = Memory::now(scan.memory())?;
    println!("after the tenth look: {tenth}");
    println!("after look {}: {end}", options.looks);
    if f64::from(end.most_kib) > GROWTH * f64::from(tenth.most_kib) {
        bail!("memory is not flat after the tenth look");
    }
    Ok(())
}

/// What a process holds at a moment.
#[derive(Clone, Copy, Debug, Default)]
struct Memory {
    /// The most that was ever resident, in KiB.
    most_kib: u32,
    /// What is resident now, in KiB.
    now_kib: u32,
    /// What the scene memory is as text, in bytes.
    map_bytes: usize,
}

impl Memory {
    /// As Linux tells it.
    fn now(map: &SceneMemory) -> anyhow::Result<Self> {
        let status = std::fs::read_to_string("/proc/self/status")
            .context("only Linux tells the memory of a process")?;
        let kib = |name: &str| -> anyhow::Result<u32> {
            let line = status.lines().find_map(|line| line.strip_prefix(name));
            let words = line.with_context(|| format!("no {name}"))?;
            Ok(words.trim().trim_end_matches("kB").trim().parse()?)
        };
        Ok(Self {
            most_kib: kib("VmHWM:")?,
            now_kib: kib("VmRSS:")?,
            map_bytes: map.to_json().len(),
        })
    }
}

impl fmt::Display for Memory {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{:.1} MiB at the most, {:.1} MiB resident; the map is {} bytes of JSON",
            f64::from(self.most_kib) / 1024.0,
            f64::from(self.now_kib) / 1024.0,
            self.map_bytes
        )
    }
}
