use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, bail};
use clap::Args;
use disparity_pyramid::{DisparityField, MatchParams, estimate};
use ndarray::{Axis, Ix3};
use stereo_formats::scene_folder::{self, FlowScene, Frames};
use stereo_formats::{npy, picture};
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage};

use crate::data_folder;
use crate::date;
use crate::docs_folder::docs_folder;
use crate::eval_middlebury::{progress, write_file};
use crate::flow_errors::FlowErrors;
use crate::flow_page::flow_page;
use crate::flow_run::{FlowRun, FlowScore, MethodScore, OURS_DENSE};
use crate::machine::Machine;
use crate::opencv_peer::{FlowJob, Job, OpenCv, OpenCvOptions};

/// Compares optic flow with the truth: every flow scene in the data folder, OpenCV's Farneback and
/// DIS beside us.
///
/// Prints endpoint and angular errors, dense and valid with density, and whether the marks hold;
/// writes docs/flow.md.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask eval-flow --data ~/data
  cargo xtask eval-flow --scene rubberwhale --no-opencv
  cargo xtask eval-flow --python ~/venv/bin/python --json out/flow.json --check

A data folder holds scenes as flow/SCENE; each has scene.toml, two frames and a .flo file. \
Middlebury's can be downloaded from https://vision.middlebury.edu/flow/data/")]
pub(crate) struct Options {
    /// The data folder; without it, the one that the variable DORSAL_DATA names
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Only this scene, by the name in its scene.toml; may be given more than once
    #[arg(long, value_name = "NAME")]
    scene: Vec<String>,
    #[command(flatten)]
    opencv: OpenCvOptions,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the page of results to this file; without it, to docs/flow.md if every scene is
    /// evaluated and OpenCV beside it
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
    /// Fail if a mark is missed
    #[arg(long)]
    check: bool,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Scales of the pyramid, those of `dorsal flow`.
const SCALES: usize = 5;

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let data = data_folder::required(options.data.as_deref())?;
    let scenes = scenes(&data, options)?;
    let opencv = options.opencv.find()?;
    let progress = progress(options.quiet);
    progress.set_length(scenes.len() as u64);
    let mut run = FlowRun {
        schema: FlowRun::SCHEMA,
        date: date::today(),
        machine: Machine::this(),
        command: command(options),
        opencv: None,
        scenes: Vec::new(),
    };
    for scene in &scenes {
        let name = &scene.description.name;
        progress.set_message(name.clone());
        let (score, version) =
            score(scene, opencv.as_ref()).with_context(|| format!("scene {name}"))?;
        run.scenes.push(score);
        run.opencv = version;
        progress.inc(1);
    }
    progress.finish_and_clear();
    println!("{}\n{}", run.table(), run.marks());
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&run)?)?;
    }
    let docs = || {
        // A page of some scenes, or without its yardstick, is no replacement for the page of all.
        let whole = options.scene.is_empty() && opencv.is_some();
        whole
            .then(docs_folder)
            .flatten()
            .map(|docs| docs.join("flow.md"))
    };
    if let Some(path) = options.results.clone().or_else(docs) {
        write_file(&path, flow_page(&run).as_bytes())?;
    }
    match run.missed() {
        Some(missed) if options.check => bail!(missed),
        _ => Ok(()),
    }
}

/// The scenes that are wanted, in the order of their paths.
fn scenes(data: &Path, options: &Options) -> anyhow::Result<Vec<FlowScene>> {
    let mut scenes = scene_folder::flow_scenes(data)?;
    let names: Vec<String> = scenes
        .iter()
        .map(|scene| scene.description.name.clone())
        .collect();
    if let Some(missing) = options.scene.iter().find(|name| !names.contains(name)) {
        bail!(
            "no flow scene {missing} below {}; there are {}",
            data.display(),
            names.join(", ")
        );
    }
    if !options.scene.is_empty() {
        scenes.retain(|scene| options.scene.contains(&scene.description.name));
    }
    Ok(scenes)
}

/// The score of one scene, with OpenCV's version if it ran.
fn score(
    scene: &FlowScene,
    opencv: Option<&OpenCv>,
) -> anyhow::Result<(FlowScore, Option<String>)> {
    let truth = scene.truth()?;
    let frames = scene.frames()?;
    let start = Instant::now();
    let field = ours(&frames)?;
    let seconds = start.elapsed().as_secs_f64();
    let (u, v) = (field.only_valid(field.dx()), field.only_valid(field.dy()));
    let mut methods = vec![
        MethodScore {
            method: OURS_DENSE.to_owned(),
            errors: FlowErrors::of(field.dx(), field.dy(), &truth),
            seconds,
        },
        MethodScore {
            method: "dorsal, valid".to_owned(),
            errors: FlowErrors::of(u.view(), v.view(), &truth),
            seconds,
        },
    ];
    let mut version = None;
    if let Some(opencv) = opencv {
        let scratch = tempfile::tempdir().context("no room for OpenCV's frames")?;
        let path = |name: &str| scratch.path().join(name);
        let write = |name: &str, luma: &LumaImage| {
            let grey = luma.plane().mapv(|luma| [(luma * 255.0).round() as u8; 3]);
            picture::write_rgb(path(name), grey.view()).map(|()| path(name))
        };
        let prev = write("prev.png", frames.first.luma())?;
        let next = write("next.png", frames.second.luma())?;
        let job = |out: &str| FlowJob {
            prev: prev.clone(),
            next: next.clone(),
            out: path(out),
        };
        let jobs = [
            Job::Farneback(job("farneback.npy")),
            Job::Dis(job("dis.npy")),
        ];
        let done = opencv.run(&jobs, scratch.path(), || ())?;
        let rows = [
            ("OpenCV Farneback", "farneback.npy"),
            ("OpenCV DIS", "dis.npy"),
        ];
        for ((method, file), seconds) in rows.into_iter().zip(done.seconds) {
            let flow = npy::read::<f32>(path(file))?.into_dimensionality::<Ix3>()?;
            let (u, v) = (flow.index_axis(Axis(0), 0), flow.index_axis(Axis(0), 1));
            methods.push(MethodScore {
                method: method.to_owned(),
                errors: FlowErrors::of(u, v, &truth),
                seconds,
            });
        }
        version = Some(done.version);
    }
    let described = &scene.description;
    let score = FlowScore {
        scene: described.name.clone(),
        dataset: described.dataset.clone(),
        citation: described.citation.clone(),
        width: described.size.width,
        height: described.size.height,
        methods,
    };
    Ok((score, version))
}

/// The flow that `dorsal flow` finds.
fn ours(frames: &Frames) -> anyhow::Result<DisparityField> {
    let size = frames.first.size();
    let params = GaborParams {
        scales: SCALES,
        ..GaborParams::default()
    };
    let bank = FilterBank::plan(params.fitted_to(size), size)?;
    let moments = Binocular {
        left: frames.first.luma(),
        right: frames.second.luma(),
    };
    let responses = moments.try_map(|moment| bank.respond(moment))?;
    Ok(estimate(&responses, MatchParams::for_flow())?)
}

/// The command that gives the same numbers again. Folders are one machine's own and left out.
fn command(options: &Options) -> String {
    let mut command = "cargo xtask eval-flow".to_owned();
    for scene in &options.scene {
        command += " --scene ";
        command += scene;
    }
    command
}
