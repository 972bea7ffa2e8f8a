use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::Args;
use disparity_pyramid::{DisparityField, MatchParams, VectorMatcher};
use ndarray::{Array2, Zip};
use stereo_scenes::{Exposure, Room, render};
use v1_gabor::{FilterBank, GaborParams, LumaImage};

use crate::camera_noise::CameraNoise;
use crate::continuous::continuous;
use crate::date;
use crate::docs_folder::docs_folder;
use crate::eval_middlebury::{progress, write_file};
use crate::machine::Machine;
use crate::metrics::Metrics;
use crate::room_run::{RoomRun, RoomSeen};
use crate::textured::textured;

/// Errors of both components of the vector pyramid in rendered rooms, before a head whose eyes converge.
///
/// Prints mean errors over textured pixels that are valid, and whether the mark of the built-in rooms holds;
/// writes docs/rooms.md.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask eval-rooms
  cargo xtask eval-rooms --rooms 50 --results out/rooms.md
  cargo xtask eval-rooms --json out/rooms.json --check")]
pub(crate) struct Options {
    /// How many random rooms, beside those that are built in
    #[arg(long, value_name = "N", default_value = "10")]
    rooms: u32,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the page of results to this file; without it, to docs/rooms.md
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
    /// Fail if the mark is missed
    #[arg(long)]
    check: bool,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let progress = progress(options.quiet);
    let built_in = [("table", Room::demo()), ("shelf", Room::shelf())];
    let built_in = built_in.into_iter().flat_map(|(name, room)| {
        let noisy = (format!("{name}, noisy"), false, room.clone());
        [(name.to_owned(), true, room), noisy]
    });
    let random =
        (0..options.rooms).map(|seed| (format!("random {seed}"), false, Room::random(seed)));
    let rooms: Vec<_> = built_in.chain(random).collect();
    progress.set_length(rooms.len() as u64);
    let mut run = RoomRun::new(date::today(), Machine::this());
    for (number, (name, built_in, room)) in rooms.into_iter().enumerate() {
        progress.set_message(name.clone());
        let noise = name.ends_with("noisy").then(CameraNoise::default);
        let seen =
            look(&room, noise.as_ref(), number as u64).with_context(|| format!("room {name}"))?;
        let seen = seen.with_context(|| format!("room {name}: no textured pixel is valid"))?;
        let (scales, dx, dy) = seen;
        run.rooms.push(RoomSeen {
            name,
            built_in,
            scales,
            dx,
            dy,
        });
        progress.inc(1);
    }
    progress.finish_and_clear();
    println!("{run}");
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&run)?)?;
    }
    let docs = || docs_folder().map(|docs| docs.join("rooms.md"));
    if let Some(path) = options.results.clone().or_else(docs) {
        write_file(&path, run.page().as_bytes())?;
    }
    match run.missed() {
        Some(missed) if options.check => bail!(missed),
        _ => Ok(()),
    }
}

/// The number of scales, and the errors of `dx` and `dy`; `None` if there is nothing to compare.
fn look(
    room: &Room,
    noise: Option<&CameraNoise>,
    seed: u64,
) -> anyhow::Result<Option<(usize, Metrics, Metrics)>> {
    let gaze = room.gaze()?;
    let view = render(room, &gaze, Exposure::default())?;
    let mut eye_seed = 2 * seed;
    let grey = view.images.as_ref().map(|image| {
        eye_seed += 1;
        match noise {
            Some(noise) => noise.take(image.plane(), eye_seed),
            None => image
                .plane()
                .mapv(|light| (255.0 * light.clamp(0.0, 1.0)).round() as u8),
        }
    });
    let eyes = grey
        .as_ref()
        .try_map(|grey| LumaImage::new(grey.mapv(|grey| f32::from(grey) / 255.0)))?;
    let truth = &view.truth;
    let mut mask = textured(grey.left.mapv(|grey| [grey; 3]).view());
    Zip::from(&mut mask)
        .and(&continuous(truth.dx.view()))
        .and(&truth.visible)
        .for_each(|mask, &continuous, &visible| *mask &= continuous & visible);
    let seen = |plane: &Array2<f32>| {
        let known = plane.indexed_iter().filter(|&(at, _)| mask[at]);
        let numbers = known.map(|(_, &shift)| shift);
        numbers.fold(
            (f32::INFINITY, f32::NEG_INFINITY),
            |(least, most), shift| (least.min(shift), most.max(shift)),
        )
    };
    let (least, most) = seen(&truth.dx);
    let middle = (0.5 * (least + most)).round();
    // The coarsest scale tells shifts of up to two of its pixels from its start.
    let scales = 1 + (0.25 * (most - least)).log2().ceil().max(0.0) as usize;
    let gabor = GaborParams {
        scales,
        ..GaborParams::default()
    };
    let size = eyes.left.size();
    let params = MatchParams {
        zero_disparity_px: (middle, 0.0),
        ..MatchParams::default()
    };
    let bank = FilterBank::plan(gabor.fitted_to(size), size)?;
    let field = VectorMatcher::plan(bank, params)?.estimate(&eyes)?;
    let errors = |found: &dyn Fn(&DisparityField) -> Array2<f32>, truth: &Array2<f32>| {
        let mut found = found(&field);
        Zip::from(&mut found)
            .and(&field.validity())
            .for_each(|found, validity| {
                if !validity.is_valid() {
                    *found = f32::NAN;
                }
            });
        Metrics::of(found.view(), truth.view(), mask.view())
    };
    let dx = errors(&|field| field.dx().to_owned(), &truth.dx);
    let dy = errors(&|field| field.dy().to_owned(), &truth.dy);
    Ok(dx.zip(dy).map(|(dx, dy)| (scales, dx, dy)))
}
