use anyhow::{Context, bail};
use clap::Args;
use dorsal_scan::{Scan, ScanParams, Shown};
use stereo_scenes::Room;

use crate::eval_middlebury::progress;

/// Looks a thousand times in one process, and watches its memory.
///
/// A head sees a few rendered views again and again, from two pictures to the map. After the tenth look
/// the resident memory may not grow by more than a twentieth.
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

/// How much larger the process may be at the end than after the tenth look.
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
    let (mut tenth, mut most) = (0, 0);
    for look in 1..=options.looks {
        if views.len() < 4 {
            let fixation = scan.next().context("a scan has a next fixation")?;
            views.push(scan.show(&fixation)?);
        }
        // A view is copied for each look; what the look leaves is dropped.
        let shown = views[(look % views.len() as u64) as usize].clone();
        scan.perceive(shown, None)?;
        let kib = resident_kib()?;
        if look == 10 {
            tenth = kib;
        }
        if look > 10 {
            most = most.max(kib);
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    println!(
        "{} looks: {:.1} MiB after the tenth, {:.1} MiB at the most since",
        options.looks,
        f64::from(tenth) / 1024.0,
        f64::from(most) / 1024.0
    );
    if f64::from(most) > GROWTH * f64::from(tenth) {
        bail!("memory is not flat after the tenth look");
    }
    Ok(())
}

/// The resident memory of this process, in KiB, as Linux tells it.
fn resident_kib() -> anyhow::Result<u32> {
    let status = std::fs::read_to_string("/proc/self/status")
        .context("only Linux tells the memory of a process")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    let words = line.context("no VmRSS")?.trim().trim_end_matches("kB");
    Ok(words.trim().parse()?)
}
