use std::path::Path;

use indicatif::ProgressBar;
use stereo_scenes::{Exposure, Room, render};
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};

use super::Options;
use super::contestants::{ON_TWO, OURS};
use super::median::median;
use super::ours::Ours;
use super::pair::parallel_gaze;
use super::peers::{ALONG_ROWS, start_peers};
use super::report::{AtSize, Contestant, TwoThreads};
use crate::clocked::{Clocked, clocked};
use crate::opencv_clock::MATCHERS;
use crate::whole_look::WholeLook;

/// Every contestant at one size, round after round, and OpenCV's version if it ran.
pub(super) fn at_size(
    size: Size,
    python: Option<&Path>,
    options: &Options,
    bar: &ProgressBar,
) -> anyhow::Result<(AtSize, Option<String>)> {
    let room = Room::demo();
    let gaze = room.head().resized(size).fixate(room.fixation_m())?;
    let verged = render(&room, &gaze, Exposure::default())?.images;
    let gaze = parallel_gaze(&room, size)?;
    let view = render(&room, &gaze, Exposure::default())?;
    let parallel = view.images.clone();
    let start = |images: &Binocular<LumaImage>| match python {
        None => Ok(None),
        Some(python) => start_peers(python, images, usize::from(options.threads)).map(Some),
    };
    let mut peers = start(&verged)?;
    let mut along_rows = start(&parallel)?;
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(options.threads))
        .build()?;
    let two = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size)?;
    let look = WholeLook::plan(&room, &gaze, view, bank.clone());
    let mut ours = threads.install(|| Ours::plan(bank, look, verged, parallel))?;
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
                _ => {
                    let (done, took) = clocked(|| threads.install(|| ours.run(name)));
                    done?;
                    took
                }
            };
            if round > 0 {
                runs.push(took);
            }
        }
        for (name, walls, gains) in &mut on_two {
            let mut wall = |pool: &rayon::ThreadPool| {
                let (done, took) = clocked(|| pool.install(|| ours.run(name)));
                done.map(|()| took.wall.as_secs_f64() * 1e3)
            };
            // One after the other, so that both meet the same machine.
            let (alone, both) = (wall(&threads)?, wall(&two)?);
            if round > 0 {
                walls.push(both);
                gains.push(alone / both);
            }
        }
        if round > 0 {
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
    };
    Ok((at_size, peers.map(|peers| peers.version.clone())))
}
