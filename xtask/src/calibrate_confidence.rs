use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::Args;
use disparity_pyramid::{DenseParams, DisparityField, EyeView, MatchParams, estimate_near_first};
use dorsal::DenseLook;
use egocentric_depth::scatter;
use ndarray::Array2;
use stereo_formats::scene_folder::{self, StereoScene};
use v1_gabor::{FilterBank, GaborParams};

use crate::confidence_run::{ConfidenceRun, Pixel, Sample, Source};
use crate::data_folder;
use crate::date;
use crate::docs_folder::docs_folder;
use crate::eval_middlebury::{progress, write_file};
use crate::machine::Machine;

/// Fits the error of a disparity to its confidence on real pairs, each left out in turn.
///
/// Prints for the vector pyramid and for both presets of the dense estimator the error by confidence,
/// how often a claimed interval holds the truth of scenes that were not fitted on, and whether the mark
/// holds; writes docs/confidence.md.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask calibrate-confidence --data ~/data
  cargo xtask calibrate-confidence --json out/confidence.json --check")]
pub(crate) struct Options {
    /// The data folder; without it, the one that the variable DORSAL_DATA names
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the page of results to this file; without it, to docs/confidence.md
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
    /// Write the reliability diagrams to this folder; without it, to docs/pictures
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    /// Fail if the mark is missed
    #[arg(long)]
    check: bool,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let data = data_folder::required(options.data.as_deref())?;
    let scenes = scene_folder::stereo_scenes(&data)?;
    let progress = progress(options.quiet);
    progress.set_length(scenes.len() as u64);
    let mut samples = Source::ALL.map(|_| Vec::new());
    for scene in &scenes {
        progress.set_message(scene.description.name.clone());
        if let Some(of_scene) = sample(scene)? {
            for (samples, sample) in samples.iter_mut().zip(of_scene) {
                samples.push(sample);
            }
        }
        progress.inc(1);
    }
    progress.finish_and_clear();
    let run = ConfidenceRun::fit(date::today(), Machine::this(), &samples);
    println!("{run}");
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&run)?)?;
    }
    let docs = || docs_folder().map(|docs| docs.join("confidence.md"));
    if let Some(path) = options.results.clone().or_else(docs) {
        write_file(&path, run.page().as_bytes())?;
    }
    let pictures = || docs_folder().map(|docs| docs.join("pictures"));
    if let Some(folder) = options.pictures.clone().or_else(pictures) {
        for (name, picture) in run.pictures() {
            write_file(&folder.join(name), picture.as_bytes())?;
        }
    }
    match run.missed() {
        Some(missed) if options.check => bail!(missed),
        _ => Ok(()),
    }
}

/// What is known of the valid pixels of known truth, and their errors, by each source; `None` of a pair
/// without dense truth, or whose truth is rounded to whole pixels.
fn sample(scene: &StereoScene) -> anyhow::Result<Option<[Sample; Source::ALL.len()]>> {
    let description = &scene.description;
    if description.integer_truth || !description.rectified {
        return Ok(None);
    }
    let Some(truth) = scene.truth()? else {
        return Ok(None);
    };
    let eyes = scene.pair()?;
    let gabor = GaborParams::default();
    let gabor = GaborParams {
        scales: gabor.most_scales(eyes.left.size()),
        ..gabor
    };
    let bank = FilterBank::plan(gabor, eyes.left.size())?;
    let vector = {
        let responses = eyes.as_ref().try_map(|eye| bank.respond(eye.luma()))?;
        let matching = MatchParams {
            covariance: true,
            ..MatchParams::default()
        };
        estimate_near_first(&responses, matching)?.field
    };
    let views = eyes.as_ref().map(|eye| EyeView {
        luma: eye.luma(),
        rgb: Some(eye.rgb()),
    });
    let presets = [DenseParams::best(), DenseParams::fast()];
    let looks = presets.map(|params| DenseLook {
        params,
        ..DenseLook::default()
    });
    let preparation = looks[0].prepare(&views, &bank, MatchParams::default())?;
    let [best, fast] = looks.map(|look| look.look(&views, &preparation));
    let name = &description.name;
    Ok(Some([
        of_field(name, Source::Vector, &vector, &truth)?,
        of_field(name, Source::DenseBest, &best?, &truth)?,
        of_field(name, Source::DenseFast, &fast?, &truth)?,
    ]))
}

/// The same of one field.
fn of_field(
    scene: &str,
    source: Source,
    field: &DisparityField,
    truth: &Array2<f32>,
) -> anyhow::Result<Sample> {
    // Pixels beside one another say the same; so many of a pair leave a tenth of a per cent.
    const PIXELS: usize = 60_000;
    let scatter = scatter(field);
    let known = || {
        truth.indexed_iter().filter_map(|((y, x), &d)| {
            let found = field.at(x, y).filter(|_| d.is_finite())?;
            Some((found, scatter[[y, x]]?, d))
        })
    };
    let step = known().count().div_ceil(PIXELS).max(1);
    let pixels = known().step_by(step).map(|(found, scatter, d)| Pixel {
        error_px: (found.dx + d).abs(),
        confidence: found.confidence,
        sigma_dx_px: found.covariance.map_or(f32::NAN, |it| it.sigma_dx()),
        scatter_px: scatter.0,
    });
    let roughness_px = source.library().roughness_px(field);
    Ok(Sample {
        scene: scene.to_owned(),
        pixels: pixels.collect(),
        roughness_px: roughness_px.context("a field without answers")?,
        unanswered: 1.0 - field.density(),
    })
}
