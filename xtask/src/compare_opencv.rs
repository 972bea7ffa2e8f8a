use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::Args;
use cpu_time::ProcessTime;
use disparity_pyramid::{DisparityField, Validity};
use ndarray::{Array2, ArrayView2};
use stereo_formats::file_sign;
use stereo_formats::scene_folder::StereoScene;
use v1_gabor::Size;

use crate::comparison::{Comparison, Contestant, OnScene};
use crate::date;
use crate::dense_results_page::dense_results_page;
use crate::estimator::{Preset, dense, search_of};
use crate::eval_middlebury::{data_folder, dense_scenes, write_file};
use crate::machine::Machine;
use crate::masks::Masks;
use crate::metrics::Metrics;
use crate::opencv::{self, Pair, Run};
use crate::python_environment;
use crate::score::Score;

/// Compares the dense estimator with OpenCV's BM, SGBM, HH and 3WAY on the same pairs and masks.
///
/// OpenCV runs in a Python environment that is made below the target folder (numpy and
/// opencv-python-headless, pinned, from the Python package index). Every mode tries a small grid of
/// settings; the one with the least mean of visible bad-1 over all scenes stands for it. Its left
/// border is continued so that it covers the whole picture, its holes are filled with the lower
/// neighbour on the row. All run on one thread; times are CPU times of the same run. Writes
/// docs/dense-results.md.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask compare-opencv --data ~/data
  cargo xtask compare-opencv --scene venus --scene teddy --python ~/venv/bin/python \\
    --results out/venus-teddy.md --json out/venus-teddy.json")]
pub(crate) struct Options {
    /// The data folder; without it, the one that the variable DORSAL_DATA names
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Only this scene, by the name in its scene.toml; may be given more than once
    #[arg(long, value_name = "NAME")]
    scene: Vec<String>,
    /// A Python that has numpy and OpenCV already; nothing is installed then
    #[arg(long, value_name = "PATH")]
    python: Option<PathBuf>,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the page to this file; without it, to docs/dense-results.md if every scene is compared
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let data = data_folder(options.data.as_deref())?;
    let scenes = dense_scenes(&data, &options.scene)?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR"))
        .parent()
        .context("the task stands in the repository")?;
    let python = match &options.python {
        Some(python) => python.clone(),
        None => python_environment::ready(&root.join("target"))?,
    };
    let folder = std::env::temp_dir().join(format!("dorsal-compare-{}", std::process::id()));
    std::fs::create_dir_all(&folder)
        .with_context(|| format!("the folder {} cannot be made", folder.display()))?;
    let compared = compare(&scenes, &python, &folder, options);
    // The exchange is of no use to anyone else; a folder that stays behind does no harm.
    let _ = std::fs::remove_dir_all(&folder);
    let comparison = compared?;
    println!("{}", dense_results_page(&comparison));
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&comparison)?)?;
    }
    let docs = || {
        options
            .scene
            .is_empty()
            .then(|| root.join("docs").join("dense-results.md"))
    };
    if let Some(path) = options.results.clone().or_else(docs) {
        write_file(&path, dense_results_page(&comparison).as_bytes())?;
    }
    Ok(())
}

fn compare(
    scenes: &[(StereoScene, Array2<f32>)],
    python: &Path,
    folder: &Path,
    options: &Options,
) -> anyhow::Result<Comparison> {
    let mut pairs = Vec::new();
    for (scene, truth) in scenes {
        let eyes = scene.eye_paths();
        pairs.push(Pair {
            name: scene.description.name.clone(),
            left: eyes.left,
            right: eyes.right,
            least: 0,
            shifts: search_of(truth.view())?.shifts(),
        });
    }
    let runs = opencv::match_pairs(python, folder, &pairs, None)?;
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;

    let mut ours = [Vec::new(), Vec::new()];
    let mut scores = [Vec::new(), Vec::new()];
    let mut theirs: Vec<Vec<OnScene>> = vec![Vec::new(); runs.runs.len()];
    for (scene, truth) in scenes {
        let name = &scene.description.name;
        eprintln!("{name}");
        let pair = scene.pair()?;
        let masks = Masks::of(scene, truth.view(), pair.left.rgb())?;
        let search = search_of(truth.view())?;
        let mut fields = Vec::new();
        for (preset, (ours, scores)) in [Preset::Best, Preset::Fast]
            .into_iter()
            .zip(ours.iter_mut().zip(&mut scores))
        {
            let clock = ProcessTime::now();
            let field = one.install(|| dense(preset.params(), &pair, search))?;
            let took = clock.elapsed();
            let d = file_sign::d_of_field(&field, true);
            let valid = field.validity().mapv(Validity::is_valid);
            ours.push(on_scene(
                name,
                &d,
                &valid,
                truth.view(),
                &masks,
                took.as_secs_f64(),
            )?);
            scores.push(Score::of(
                &scene.description,
                &field,
                truth.view(),
                &masks,
                took,
            ));
            fields.push(field);
        }
        let size = Size::of_dim(truth.dim());
        for (run, theirs) in runs.runs.iter().zip(&mut theirs) {
            let (d, valid) = opencv::read(folder, run, name, size)?;
            let seconds = run.seconds.get(name).copied().unwrap_or(f64::NAN);
            let mut result = on_scene(name, &d, &valid, truth.view(), &masks, seconds)?;
            result.ours_at_its_density = fields
                .iter()
                .map(|field| at_density(field, &valid, truth.view(), &masks))
                .collect();
            theirs.push(result);
        }
    }
    let [best, fast] = ours;
    let [best_scores, fast_scores] = scores;
    let contestants = runs
        .runs
        .iter()
        .zip(theirs)
        .map(|(run, scenes)| contestant(run, scenes));
    Ok(Comparison {
        schema: Comparison::SCHEMA,
        date: date::today(),
        machine: Machine::this(),
        command: command(options),
        versions: runs.versions,
        best: Contestant {
            name: "best".to_owned(),
            setting: String::new(),
            scenes: best,
        },
        fast: Contestant {
            name: "fast".to_owned(),
            setting: String::new(),
            scenes: fast,
        },
        tried: contestants.collect(),
        best_scores,
        fast_scores,
    })
}

fn contestant(run: &Run, scenes: Vec<OnScene>) -> Contestant {
    Contestant {
        name: run.matcher.clone(),
        setting: run.setting.clone(),
        scenes,
    }
}

fn on_scene(
    name: &str,
    d: &Array2<f32>,
    valid: &Array2<bool>,
    truth: ArrayView2<'_, f32>,
    masks: &Masks,
    seconds: f64,
) -> anyhow::Result<OnScene> {
    let over = |mask: &Array2<bool>| Metrics::of(d.view(), truth, mask.view());
    let nothing = || format!("{name} has no visible pixel of known truth");
    Ok(OnScene {
        scene: name.to_owned(),
        visible: over(&masks.visible).with_context(nothing)?,
        all: over(&masks.all).with_context(nothing)?,
        estimated: over(&masks.estimated(valid)),
        seconds,
        ours_at_its_density: Vec::new(),
    })
}

/// Our errors over as many visible pixels as another matcher calls valid, the most confident ones.
fn at_density(
    field: &DisparityField,
    valid: &Array2<bool>,
    truth: ArrayView2<'_, f32>,
    masks: &Masks,
) -> Option<Metrics> {
    let many = masks
        .estimated(valid)
        .iter()
        .filter(|counts| **counts)
        .count();
    let confidence = field.confidence();
    let mut order: Vec<(usize, usize)> = masks
        .visible
        .indexed_iter()
        .filter_map(|(place, counts)| counts.then_some(place))
        .collect();
    order.sort_by(|a, b| confidence[*b].total_cmp(&confidence[*a]));
    let mut mask = Array2::from_elem(valid.dim(), false);
    for place in order.into_iter().take(many) {
        mask[place] = true;
    }
    Metrics::of(
        file_sign::d_of_field(field, true).view(),
        truth,
        mask.view(),
    )
}

/// The command that gives the same numbers again. Folders are one machine's own and left out.
fn command(options: &Options) -> String {
    let scenes = options
        .scene
        .iter()
        .map(|scene| format!(" --scene {scene}"));
    std::iter::once("cargo xtask compare-opencv".to_owned())
        .chain(scenes)
        .collect()
}
