use std::fmt;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

use allocentric_qsr::{DepthReference, TriangleTable};
use anyhow::bail;
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::lot::Lot;
use crate::machine::Machine;

#[path = "../../crates/allocentric-qsr/tests/scenes/mod.rs"]
mod scenes;
#[path = "../../crates/allocentric-qsr/tests/witness/mod.rs"]
mod witness;

use scenes::{Point, answered};
use witness::{Witness, claim_of, claims, search};

/// Scenes that a worker takes at once.
const BATCH: u64 = 10_000;

/// Violations that are printed; the others are counted.
const SHOWN: usize = 5;

/// Checks the sound calculus on random integer scenes, and every claim of it by a witness.
///
/// Four points with whole millimetres, every other scene on a grid of 10 cm where rays, right angles
/// and equal points are common: the true relation must be in the answer of CASE 1 to 4, of the
/// triangle, of the step from observer to objects and of the triangle inequality, in each of the
/// paper's four reference systems. Then each combination the triangle table claims must be met by
/// three points with whole micrometres, found by a search and checked in whole numbers.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask check-soundness
  cargo xtask check-soundness --scenes 100000 --seed 7

Exit codes: 0 no violation and no claim without witness, 1 otherwise.")]
pub(crate) struct Options {
    /// How many scenes
    #[arg(long, value_name = "N", default_value_t = 3_000_000)]
    pub(crate) scenes: u64,
    /// Which scenes: other seeds give others
    #[arg(long, value_name = "N", default_value_t = 1)]
    pub(crate) seed: u64,
    /// Show no progress
    #[arg(long, short)]
    pub(crate) quiet: bool,
}

/// What a check comes to.
#[derive(Clone, Debug)]
pub(crate) struct Soundness {
    scenes: u64,
    violations: Vec<String>,
    /// For each system its name, how many combinations it claims, and how many have a witness.
    claims: Vec<(String, usize, usize)>,
    seconds: f64,
}

impl Soundness {
    /// Whether nothing speaks against the calculus.
    pub(crate) fn holds(&self) -> bool {
        self.violations.is_empty() && self.claims.iter().all(|(_, claimed, met)| claimed == met)
    }
}

impl fmt::Display for Soundness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{} scenes in {} reference systems: {} violations ({:.0} s of wall time)",
            self.scenes,
            self.claims.len(),
            self.violations.len(),
            self.seconds
        )?;
        for violation in self.violations.iter().take(SHOWN) {
            writeln!(f, "  {violation}")?;
        }
        for (name, claimed, met) in &self.claims {
            writeln!(
                f,
                "{name}: {met} of {claimed} claimed combinations have a witness"
            )?;
        }
        Ok(())
    }
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let soundness = check(options);
    let Machine { cpu, cores, .. } = Machine::this();
    print!("{soundness}");
    println!("on {cpu}, {cores} cores, seed {}", options.seed);
    if soundness.holds() {
        Ok(())
    } else {
        bail!("the calculus is not sound, or claims what no points show; see above")
    }
}

/// The check itself.
pub(crate) fn check(options: &Options) -> Soundness {
    let start = Instant::now();
    let presets = DepthReference::PRESETS.iter();
    let references: Vec<DepthReference> = presets
        .filter_map(|name| DepthReference::preset(name))
        .collect();
    let tables: Vec<TriangleTable> = references.iter().map(TriangleTable::plan).collect();
    let target = if options.quiet {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let style = ProgressStyle::with_template("{bar:40} {pos} of {len} scenes, {eta} left");
    let bar = ProgressBar::with_draw_target(Some(options.scenes), target)
        .with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
    let next = AtomicU64::new(0);
    let violations = Mutex::new(Vec::new());
    let work = || {
        loop {
            let from = next.fetch_add(BATCH, Ordering::Relaxed);
            if from >= options.scenes {
                return;
            }
            let count = BATCH.min(options.scenes - from);
            // Each batch has its own numbers, so that the scenes are the same for any number of
            // workers.
            let mut lot = Lot::new(options.seed.wrapping_mul(1_000_003).wrapping_add(from));
            let found = batch(&tables, count, &mut lot);
            if let Ok(mut violations) = violations.lock() {
                violations.extend(found);
            }
            bar.inc(count);
        }
    };
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..workers {
            scope.spawn(work);
        }
    });
    bar.finish_and_clear();
    let claims = references.iter().map(|reference| {
        let claims = claims(reference);
        let met = claims
            .iter()
            .filter(|&&claim| search(reference, claim).is_some_and(|w| mirrors(reference, w)))
            .count();
        (reference.name().to_owned(), claims.len(), met)
    });
    Soundness {
        scenes: options.scenes,
        claims: claims.collect(),
        violations: violations.into_inner().unwrap_or_default(),
        seconds: start.elapsed().as_secs_f64(),
    }
}

fn batch(tables: &[TriangleTable], count: u64, lot: &mut Lot) -> Vec<String> {
    let mut violations = Vec::new();
    for scene in 0..count {
        let points: [Point; 4] = std::array::from_fn(|_| {
            let mut coordinate = || {
                if scene % 2 == 0 {
                    lot.below(29) as i64 * 100
                } else {
                    lot.below(2800) as i64
                }
            };
            (coordinate(), coordinate())
        });
        if points[0] == points[1] {
            // The direction from a to b is what all labels are told against.
            continue;
        }
        for table in tables {
            if let Err(what) = answered(table, points) {
                let name = table.reference().name();
                violations.push(format!("{name}: {what} at {points:?} mm"));
            }
        }
    }
    violations
}

/// Whether the mirror image of a witness witnesses the mirrored claim: what is claimed to the right
/// needs no search of its own.
fn mirrors(reference: &DepthReference, witness: Witness) -> bool {
    let Witness { c, d: (u, v) } = witness;
    let mirror = Witness { c, d: (u, -v) };
    let both = claim_of(reference, witness).zip(claim_of(reference, mirror));
    both.is_some_and(|((i, j, p, psi, k), (mi, mj, mp, mpsi, mk))| {
        (i, j, p.mirrored(), psi.mirrored(), k) == (mi, mj, mp, mpsi, mk)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_few_scenes_are_sound() {
        let options = Options {
            scenes: 300,
            seed: 3,
            quiet: true,
        };
        let soundness = check(&options);
        assert!(soundness.holds(), "{soundness}");
        assert!(
            soundness.to_string().contains("drs2: 802 of 802"),
            "{soundness}"
        );
    }
}
