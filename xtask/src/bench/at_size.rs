use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
use indicatif::ProgressBar;
use v1_gabor::{Binocular, LumaImage, Size};

use super::Options;
use super::ceilings::Roof;
use super::contender::{Contender, contender};
use super::contestants::{ON_TWO, OURS};
use super::look_memory::look_memory;
use super::median::median;
use super::memory_use::MemoryUse;
use super::peers::{ALONG_ROWS, start_peers};
use super::report::{AtSize, Contestant, TwoThreads};
use super::scene::Scene;
use crate::clocked::{Clocked, clocked};
use crate::opencv_clock::MATCHERS;

/// The programs that run beside this one, where they are asked for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Programs<'a> {
    /// A Python with OpenCV.
    pub(super) python: Option<&'a Path>,
    /// The `dorsal` command.
    pub(super) dorsal: Option<&'a Path>,
}

/// Every contestant at one size, round after round, and OpenCV's version if it ran.
pub(super) fn at_size(
    size: Size,
    programs: Programs<'_>,
    options: &Options,
    roof: &mut Roof,
    bar: &ProgressBar,
) -> anyhow::Result<(AtSize, Option<String>)> {
    let scene = Scene::render(size)?;
    let start = |images: &Binocular<LumaImage>| match programs.python {
        None => Ok(None),
        Some(python) => start_peers(python, images, usize::from(options.threads)).map(Some),
    };
    let mut peers = start(&scene.verged)?;
    let mut along_rows = start(&scene.parallel)?;
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(options.threads))
        .build()?;
    let two = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    let memory = OURS.map(|name| MemoryUse::measure(name, &scene, &threads));
    let memory = memory.into_iter().collect::<anyhow::Result<_>>()?;
    let looks = match programs.dorsal {
        None => Vec::new(),
        Some(dorsal) => look_memory(&scene, dorsal)?,
    };
    let planned = OURS.map(|name| Ok((name, contender(name, &scene)?)));
    let mut ours: BTreeMap<&str, Box<dyn Contender + '_>> =
        planned.into_iter().collect::<anyhow::Result<_>>()?;
    let mut run = |name: &str, pool: &rayon::ThreadPool| -> anyhow::Result<Clocked> {
        let one = ours.get_mut(name);
        let one = one.with_context(|| format!("nobody is called {name}"))?;
        let (done, took) = clocked(|| pool.install(|| one.run()));
        done.map(|()| took)
    };
    let mut on_two = ON_TWO.map(|name| (name, Vec::new(), Vec::new()));
    let mut runs: Vec<(&'static str, Vec<Clocked>)> = OURS.map(|name| (name, Vec::new())).to_vec();
    if peers.is_some() {
        runs.extend(MATCHERS.map(|name| (name, Vec::new())));
    }
    // The first round fills buffers and caches and does not count.
    for round in 0..=options.rounds {
        for (name, runs) in &mut runs {
            let clock = if ALONG_ROWS.contains(name) {
                &mut along_rows
            } else {
                &mut peers
            };
            let took = match clock {
                Some(peers) if MATCHERS.contains(name) => peers.run(name)?,
                _ => run(name, &threads)?,
            };
            if round > 0 {
                runs.push(took);
            }
        }
        for (name, walls, gains) in &mut on_two {
            let mut wall = |pool: &rayon::ThreadPool| {
                run(name, pool).map(|took| took.wall.as_secs_f64() * 1e3)
            };
            // One after the other, so that both meet the same machine.
            let (alone, both) = (wall(&threads)?, wall(&two)?);
            if round > 0 {
                walls.push(both);
                gains.push(alone / both);
            }
        }
        if round > 0 {
            roof.measure();
            bar.inc(1);
        }
    }
    let contestants = runs
        .into_iter()
        .map(|(name, runs)| Contestant::new(name, &runs, size));
    let at_size = AtSize {
        width: size.width,
        height: size.height,
        contestants: contestants.collect(),
        two_threads: on_two
            .into_iter()
            .map(|(name, walls, gains)| TwoThreads {
                name,
                wall_ms: median(walls),
                times_faster: median(gains),
            })
            .collect(),
        memory,
        shares: Vec::new(),
        looks,
    };
    Ok((at_size, peers.map(|peers| peers.version.clone())))
}
