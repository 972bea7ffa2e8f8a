use std::path::PathBuf;

use anyhow::{Context, bail};
use clap::Args;
use disparity_pyramid::{MatchParams, estimate_near_first};
use egocentric_depth::{roughness_px, scatter};
use stereo_formats::scene_folder::{self, StereoScene};
use v1_gabor::{FilterBank, GaborParams};

use crate::confidence_run::{ConfidenceRun, Pixel, Sample};
use crate::data_folder;
use crate::date;
use crate::docs_folder::docs_folder;
use crate::eval_middlebury::{progress, write_file};
use crate::machine::Machine;

/// Fits the error of a disparity to its confidence on real pairs, each left out in turn.
///
/// Prints the error by confidence, how often a claimed interval holds the truth of scenes that were not
/// fitted on, and whether the mark holds; writes docs/confidence.md.
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
    /// Write the reliability diagrams to this file; without it, to docs/pictures/confidence.svg
    #[arg(long, value_name = "FILE")]
    picture: Option<PathBuf>,
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
    let mut samples = Vec::new();
    for scene in &scenes {
        progress.set_message(scene.description.name.clone());
        samples.extend(sample(scene)?);
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
    let pictures = || docs_folder().map(|docs| docs.join("pictures/confidence.svg"));
    if let Some(path) = options.picture.clone().or_else(pictures) {
        write_file(&path, run.picture().as_bytes())?;
    }
    match run.missed() {
        Some(missed) if options.check => bail!(missed),
        _ => Ok(()),
    }
}

/// What is known of the valid pixels of known truth, and their errors; `None` of a pair without dense
/// truth, or whose truth is rounded to whole pixels.
fn sample(scene: &StereoScene) -> anyhow::Result<Option<Sample>> {
    // Pixels beside one another say the same; so many of a pair leave a tenth of a per cent.
    const PIXELS: usize = 60_000;
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
    let responses = eyes.as_ref().try_map(|eye| bank.respond(eye.luma()))?;
    let matching = MatchParams {
        covariance: true,
        ..MatchParams::default()
    };
    let field = estimate_near_first(&responses, matching)?.field;
    let covariance = field.covariance().context("a field without covariance")?;
    let scatter = scatter(&field);
    let known = || {
        truth.indexed_iter().filter_map(|((y, x), &d)| {
            let found = field.at(x, y).filter(|_| d.is_finite())?;
            Some((found, covariance[[y, x]], scatter[[y, x]]?, d))
        })
    };
    let step = known().count().div_ceil(PIXELS).max(1);
    let pixels = known()
        .step_by(step)
        .map(|(found, covariance, scatter, d)| Pixel {
            error_px: (found.dx + d).abs(),
            confidence: found.confidence,
            sigma_dx_px: covariance.sigma_dx(),
            scatter_px: scatter.0,
        });
    Ok(Some(Sample {
        scene: description.name.clone(),
        pixels: pixels.collect(),
        roughness_px: roughness_px(&field).context("a field without answers")?,
        unanswered: 1.0 - field.density(),
    }))
}
