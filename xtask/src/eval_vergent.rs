use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use disparity_pyramid::{DisparityField, FromVotes, MatchParams, estimate, estimate_from_votes};
use ndarray::ArrayView2;
use stereo_formats::points::PointPair;
use stereo_formats::scene_folder::{self, StereoScene};
use stereo_formats::{file_sign, picture::Picture};
use v1_gabor::{Binocular, FilterBank, GaborParams, Size, V1Responses};

use crate::data_folder;
use crate::date;
use crate::docs_folder::docs_folder;
use crate::eval_middlebury::{progress, write_file};
use crate::machine::Machine;
use crate::masks::Masks;
use crate::metrics::Metrics;
use crate::point_errors::PointErrors;
use crate::vergent_run::{PointScore, StartScore, VergentRun};

/// Compares vector disparities with the sparse truth of pairs that nobody rectified: verged eyes, and
/// a rig out of line, the start of the search found by itself.
///
/// Prints endpoint errors at the points and whether the marks hold, then what the start is worth on
/// rectified pairs of large range; writes docs/vergent.md.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask eval-vergent --data ~/data
  cargo xtask eval-vergent --start zero --scene temple20
  cargo xtask eval-vergent --json out/vergent.json --check")]
pub(crate) struct Options {
    /// The data folder; without it, the one that the variable DORSAL_DATA names
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Only this scene, by the name in its scene.toml; may be given more than once
    #[arg(long, value_name = "NAME")]
    scene: Vec<String>,
    /// Where the search starts
    #[arg(long, value_enum, default_value_t = StartName::Auto)]
    start: StartName,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the page of results to this file; without it, to docs/vergent.md if every scene is
    /// evaluated from a found start
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
    /// Fail if a mark is missed
    #[arg(long)]
    check: bool,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Where a search starts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum StartName {
    /// Found by a coarse look, one or several, with as many scales as they ask for
    Auto,
    /// At zero, with six scales
    Zero,
}

/// Rectified scenes whose disparities reach far.
const FAR: [&str; 4] = ["aloe", "teddy-half", "motorcycle", "teddy"];

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let data = data_folder::required(options.data.as_deref())?;
    let scenes = scenes(&data, options)?;
    let progress = progress(options.quiet);
    progress.set_length(scenes.len() as u64);
    let mut run = VergentRun {
        schema: VergentRun::SCHEMA,
        date: date::today(),
        machine: Machine::this(),
        command: command(options),
        points: Vec::new(),
        starts: Vec::new(),
    };
    for scene in &scenes {
        let name = &scene.description.name;
        progress.set_message(name.clone());
        let context = || format!("scene {name}");
        if let Some(points) = scene.points()? {
            let score = at_points(scene, &points, options.start).with_context(context)?;
            run.points.push(score);
        } else {
            run.starts.push(from_start(scene).with_context(context)?);
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    println!(
        "{}\n{}\n{}",
        run.point_table(),
        run.marks(),
        run.start_table()
    );
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&run)?)?;
    }
    let docs = || {
        let whole = options.scene.is_empty() && options.start == StartName::Auto;
        whole
            .then(docs_folder)
            .flatten()
            .map(|docs| docs.join("vergent.md"))
    };
    if let Some(path) = options.results.clone().or_else(docs) {
        write_file(&path, run.page().as_bytes())?;
    }
    match run.missed() {
        Some(missed) if options.check => bail!(missed),
        _ => Ok(()),
    }
}

/// The scenes that are wanted, in the order of their paths: those with points, and those that reach
/// far.
fn scenes(data: &Path, options: &Options) -> anyhow::Result<Vec<StereoScene>> {
    let mut scenes = Vec::new();
    for scene in scene_folder::stereo_scenes(data)? {
        let far = FAR.contains(&&*scene.description.name);
        if far || scene.points()?.is_some() {
            scenes.push(scene);
        }
    }
    let there = |name: &String| scenes.iter().any(|s| s.description.name == *name);
    if let Some(missing) = options.scene.iter().find(|name| !there(name)) {
        let names: Vec<&str> = scenes.iter().map(|s| &*s.description.name).collect();
        bail!(
            "no scene {missing} with points below {}; there are {}",
            data.display(),
            names.join(", ")
        );
    }
    if !options.scene.is_empty() {
        scenes.retain(|scene| options.scene.contains(&scene.description.name));
    }
    Ok(scenes)
}

/// A pair's errors at its points.
fn at_points(
    scene: &StereoScene,
    points: &[PointPair],
    start: StartName,
) -> anyhow::Result<PointScore> {
    let eyes = scene.pair()?;
    let responses = respond(&eyes, most_scales(eyes.left.size()))?;
    let FromVotes {
        field,
        starts,
        scales,
    } = match start {
        StartName::Auto => estimate_from_votes(&responses, MatchParams::default())?,
        StartName::Zero => from_zero(&eyes)?,
    };
    Ok(PointScore {
        scene: scene.description.name.clone(),
        dataset: scene.description.dataset.clone(),
        starts_px: starts.iter().map(|start| start.shift_px).collect(),
        scales,
        points: points.len(),
        valid: PointErrors::of(points, |x, y| {
            let there = field.at(x, y)?;
            Some((there.dx, there.dy))
        }),
        dense: PointErrors::of(points, |x, y| {
            let there = field.guess(x, y);
            Some((there.dx, there.dy))
        }),
    })
}

/// What a found start is worth on a rectified pair with dense truth.
fn from_start(scene: &StereoScene) -> anyhow::Result<StartScore> {
    let truth = scene.truth()?.context("it has neither points nor truth")?;
    let eyes = scene.pair()?;
    let masks = Masks::of(scene, truth.view(), eyes.left.rgb())?;
    let responses = respond(&eyes, most_scales(eyes.left.size()))?;
    let score = |field: &DisparityField| {
        let over = |d: ArrayView2<'_, f32>| Metrics::of(d, truth.view(), masks.visible.view());
        (
            over(file_sign::d_of_field(field, false).view()),
            over(file_sign::d_of_field(field, true).view()),
        )
    };
    let found = estimate_from_votes(&responses, MatchParams::default())?;
    let (zero_valid, zero_dense) = score(&from_zero(&eyes)?.field);
    let (start_valid, start_dense) = score(&found.field);
    let mut known: Vec<f32> = truth.iter().copied().filter(|d| d.is_finite()).collect();
    known.sort_unstable_by(f32::total_cmp);
    let last = known.len().saturating_sub(1);
    let at = |place: usize| known.get(place).copied();
    Ok(StartScore {
        scene: scene.description.name.clone(),
        truth_px: at(last / 20).zip(at(last - last / 20)),
        starts_px: found.starts.iter().map(|start| start.shift_px).collect(),
        scales: found.scales,
        zero_valid,
        zero_dense,
        start_valid,
        start_dense,
    })
}

/// The field from zero, with six scales.
fn from_zero(eyes: &Binocular<Picture>) -> anyhow::Result<FromVotes> {
    let scales = GaborParams::default()
        .scales
        .min(most_scales(eyes.left.size()));
    Ok(FromVotes {
        field: estimate(&respond(eyes, scales)?, MatchParams::default())?,
        starts: Vec::new(),
        scales,
    })
}

/// What both eyes say, over this many scales.
fn respond(eyes: &Binocular<Picture>, scales: usize) -> anyhow::Result<Binocular<V1Responses>> {
    let params = GaborParams {
        scales,
        ..GaborParams::default()
    };
    let bank = FilterBank::plan(params, eyes.left.size())?;
    Ok(eyes.as_ref().try_map(|eye| bank.respond(eye.luma()))?)
}

fn most_scales(size: Size) -> usize {
    GaborParams::default().most_scales(size)
}

/// The command that gives the same numbers again. Folders are one machine's own and left out.
fn command(options: &Options) -> String {
    let mut command = "cargo xtask eval-vergent".to_owned();
    if options.start == StartName::Zero {
        command += " --start zero";
    }
    for scene in &options.scene {
        command += " --scene ";
        command += scene;
    }
    command
}
