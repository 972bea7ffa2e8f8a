use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::Args;
use disparity_pyramid::{EyeView, MatchParams};
use dorsal::{DenseLook, Range, Rows};
use egocentric_depth::{DepthMap, LabelImage, SegmentParams, StereoRig, segment, triangulate};
use ndarray::{Array2, Array3, Axis};
use stereo_formats::picture;
use stereo_scenes::{Exposure, Room, View, render};
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage};

use crate::camera_noise::CameraNoise;
use crate::date;
use crate::docs_folder::docs_folder;
use crate::eval_middlebury::{progress, write_file};
use crate::label_sheet::label_sheet;
use crate::machine::Machine;
use crate::segment_run::{Found, Looked, SegmentRun, Source};

/// Finds the objects of random rooms without labels, from true depth and from what both estimators
/// see.
///
/// Prints precision and recall at an intersection over union of one half, and whether the bounds hold;
/// writes docs/segment.md and its picture.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask eval-segment
  cargo xtask eval-segment --rooms 5 --first-seed 100 --results out/segment.md --picture out/segment.png
  cargo xtask eval-segment --json out/segment.json --check")]
pub(crate) struct Options {
    /// How many rooms
    #[arg(long, value_name = "N", default_value = "20")]
    rooms: u32,
    /// The seed of the first; the others follow
    #[arg(long, value_name = "N", default_value = "0")]
    first_seed: u32,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the page of results to this file; without it, to docs/segment.md
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
    /// Write the picture of the first room to this file; without it, to docs/pictures/segment.png
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
    /// Fail if a bound is missed
    #[arg(long)]
    check: bool,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let progress = progress(options.quiet);
    progress.set_length(u64::from(options.rooms));
    let mut run = SegmentRun::new(date::today(), Machine::this());
    let docs = |name: &str| docs_folder().map(|docs| docs.join(name));
    let picture = options
        .picture
        .clone()
        .or_else(|| docs("pictures/segment.png"));
    for seed in options.first_seed..options.first_seed.saturating_add(options.rooms) {
        progress.set_message(format!("room {seed}"));
        let room = Seen::of(seed).with_context(|| format!("room {seed}"))?;
        if let (Some(path), 0) = (&picture, run.rooms.len()) {
            write_file(path, &room.sheet()?)?;
        }
        run.rooms.push(room.looked());
        progress.inc(1);
    }
    progress.finish_and_clear();
    println!("{run}");
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&run)?)?;
    }
    if let Some(path) = options.results.clone().or_else(|| docs("segment.md")) {
        write_file(&path, run.page().as_bytes())?;
    }
    match run.missed() {
        Some(missed) if options.check => bail!(missed),
        _ => Ok(()),
    }
}

/// A room and what was found in it.
struct Seen {
    seed: u32,
    rgb: Array2<[u8; 3]>,
    truth: LabelImage,
    /// By source, in the order of [`Source::ALL`].
    segments: Vec<Result<LabelImage, String>>,
}

impl Seen {
    fn of(seed: u32) -> anyhow::Result<Self> {
        let room = Room::random(seed);
        let gaze = room.gaze()?;
        let view = render(&room, &gaze, Exposure::default())?;
        let rgb = Binocular {
            left: taken(&view.colour.left, u64::from(2 * seed)),
            right: taken(&view.colour.right, u64::from(2 * seed + 1)),
        };
        let rig = gaze.rig();
        let segments = Source::ALL.into_iter().map(|source| {
            let depth = depth(source, &view, &rgb, &rig)?;
            let found = segment(&depth, rgb.left.view(), &rig, &SegmentParams::default());
            Ok(found
                .map(|found| found.labels)
                .map_err(|reason| reason.to_string()))
        });
        Ok(Self {
            seed,
            segments: segments.collect::<anyhow::Result<_>>()?,
            rgb: rgb.left.clone(),
            truth: view.truth.labels,
        })
    }

    fn looked(&self) -> Looked {
        let nothing = LabelImage::new(Array2::zeros(self.truth.plane().dim()));
        let found = self.segments.iter().map(|segments| match segments {
            Ok(segments) => Found::of(segments, &self.truth),
            Err(reason) => Found {
                refused: Some(reason.clone()),
                ..Found::of(&nothing, &self.truth)
            },
        });
        Looked {
            seed: self.seed,
            found: found.collect(),
        }
    }

    /// The objects and the segments as a picture.
    fn sheet(&self) -> anyhow::Result<Vec<u8>> {
        let nothing = LabelImage::new(Array2::zeros(self.truth.plane().dim()));
        let segments = self.segments.iter();
        let segments = segments.map(|found| found.as_ref().unwrap_or(&nothing));
        let all: Vec<&LabelImage> = std::iter::once(&self.truth).chain(segments).collect();
        Ok(picture::encode_rgb_small(
            label_sheet(self.rgb.view(), &all).view(),
        )?)
    }
}

/// A colour picture as a camera takes it.
fn taken(light: &Array3<f32>, seed: u64) -> Array2<[u8; 3]> {
    let noise = CameraNoise::default();
    let channel = |c: usize| noise.take(light.index_axis(Axis(2), c), 3 * seed + c as u64);
    let (red, green, blue) = (channel(0), channel(1), channel(2));
    Array2::from_shape_fn(red.dim(), |at| [red[at], green[at], blue[at]])
}

/// Depth of every pixel of the left picture.
fn depth(
    source: Source,
    view: &View,
    rgb: &Binocular<Array2<[u8; 3]>>,
    rig: &StereoRig,
) -> anyhow::Result<DepthMap> {
    if source == Source::Truth {
        return Ok(view.truth.depth.clone());
    }
    let luma = rgb.as_ref().try_map(|rgb| {
        let weights = [0.299, 0.587, 0.114];
        LumaImage::new(rgb.mapv(|rgb| {
            let grey: f32 = rgb
                .iter()
                .zip(weights)
                .map(|(&c, w)| w * f32::from(c))
                .sum();
            grey / 255.0
        }))
    })?;
    let gabor = GaborParams::default();
    // A coarse look reads the coarsest scales.
    let gabor = GaborParams {
        scales: gabor.most_scales(luma.left.size()),
        ..gabor
    };
    let bank = FilterBank::plan(gabor, luma.left.size())?;
    // As `dorsal look --segment` matches.
    let matching = MatchParams::for_objects();
    let field = if source == Source::Dense {
        let views = Binocular {
            left: EyeView {
                luma: &luma.left,
                rgb: Some(rgb.left.view()),
            },
            right: EyeView {
                luma: &luma.right,
                rgb: Some(rgb.right.view()),
            },
        };
        let look = DenseLook {
            rows: Rows::Rectified,
            ..DenseLook::default()
        };
        look.disparity(&views, rig, &bank, matching)?
    } else {
        let responses = luma.as_ref().try_map(|eye| bank.respond(eye))?;
        Range::Wide.disparity(&responses, matching)?.field
    };
    Ok(triangulate(&field, rig))
}
