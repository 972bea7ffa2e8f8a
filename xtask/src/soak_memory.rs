use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Instant;

use anyhow::anyhow;
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::machine::Machine;

#[path = "../../crates/allocentric-qsr/tests/room/mod.rs"]
mod room;
#[path = "../../crates/allocentric-qsr/tests/soak_life/mod.rs"]
mod soak_life;

/// Lets a memory live for thousands of looks in a restless room.
///
/// Objects appear, move and vanish, the eye wanders, its measurement has holes. After every look no
/// object may be believed longer than its evidence allows, nor given up earlier. The life is lived
/// twice, the second time with a reload in the middle, and both must end in the same bytes; and the
/// snapshots of the last third may not be larger than those of the second by more than a tenth.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask soak-memory
  cargo xtask soak-memory --looks 50000

Exit codes: 0 every law held, 1 otherwise.")]
pub(crate) struct Options {
    /// How many looks
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(900..))]
    pub(crate) looks: u64,
    /// Show no progress
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

/// What a life came to.
#[derive(Clone, Debug)]
pub(crate) struct Soak {
    looks: u64,
    /// The size of every hundredth snapshot, in bytes.
    sizes: Vec<usize>,
    seconds: f64,
}

impl fmt::Display for Soak {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} looks, twice, with a reload: no ghost, no early farewell, the same bytes ({:.0} s of wall time)",
            self.looks, self.seconds
        )?;
        let third = (self.sizes.len() / 3).max(1);
        let most = self.sizes.chunks(third).take(3).map(|sizes| {
            let most = sizes.iter().copied().max().unwrap_or(0);
            format!("{:.1}", most as f64 / 1024.0)
        });
        let most: Vec<String> = most.collect();
        writeln!(
            f,
            "largest snapshot of each third of the time: {} KiB",
            most.join(", ")
        )
    }
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let soak = live(options)?;
    let Machine { cpu, cores, .. } = Machine::this();
    print!("{soak}");
    println!("on {cpu}, {cores} cores");
    Ok(())
}

/// The life itself.
pub(crate) fn live(options: &Options) -> anyhow::Result<Soak> {
    let start = Instant::now();
    let target = if options.quiet {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} looks, {eta} left");
    let bar = ProgressBar::with_draw_target(Some(2 * options.looks), target)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    // A law that does not hold panics, as in the suite; the message has been printed then.
    let lived = catch_unwind(AssertUnwindSafe(|| {
        soak_life::soak(options.looks, |look| bar.set_position(look))
    }));
    bar.finish_and_clear();
    Ok(Soak {
        looks: options.looks,
        sizes: lived.map_err(|_| anyhow!("a law of the memory does not hold; see above"))?,
        seconds: start.elapsed().as_secs_f64(),
    })
}
