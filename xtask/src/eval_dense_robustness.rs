use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;
use disparity_pyramid::RowAlignment;
use ndarray::{Array2, Zip};
use stereo_formats::file_sign;
use stereo_formats::picture::{self, Picture, Samples};
use stereo_formats::scene_folder::StereoScene;
use v1_gabor::{Binocular, Size};

use crate::altered_truth::{AlteredTruth, opencv_range};
use crate::data_folder;
use crate::date;
use crate::dense_robustness_marks::{self, EXPOSURES};
use crate::dense_robustness_page;
use crate::dense_robustness_run::{Condition, DenseRobustnessRun, DenseTrial};
use crate::docs_folder::docs_folder;
use crate::estimator::{Preset, dense, search_of, self_rectified};
use crate::eval_middlebury::{dense_scenes, progress, write_file};
use crate::machine::Machine;
use crate::masks::Masks;
use crate::metrics::Metrics;
use crate::opencv::{self, Pair, TUNED_SGBM};
use crate::python_environment;
use crate::rig_signs::RigSigns;

/// Measures what bad cameras and a bad rig cost the dense estimator, both presets.
///
/// Listed scenes clean, with noise, another gain and another gamma; Venus with the right eye 3 px lower or
/// higher, turned by a degree either way and 2 % larger or smaller, its rows aligned as `dorsal look
/// --rectify auto` does; Motorcycle with another exposure. Prints visible bad-1 and mean absolute error, a value
/// everywhere, and every mark that is missed; writes docs/dense-robustness.md.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask eval-dense-robustness --data ~/data
  cargo xtask eval-dense-robustness --scene venus --json out/venus.json
  cargo xtask eval-dense-robustness --peers --check
  cargo xtask eval-dense-robustness --peers --python ~/venv/bin/python")]
pub(crate) struct Options {
    /// The data folder; without it, the one that the variable DORSAL_DATA names
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Only this scene; may be given more than once
    #[arg(long, value_name = "NAME", value_parser = clap::builder::PossibleValuesParser::new(SCENES))]
    scene: Vec<String>,
    /// Run OpenCV's SGBM on the same pairs, as compare-opencv does; its marks count then too
    #[arg(long)]
    peers: bool,
    /// A Python that has numpy and OpenCV already; nothing is installed then
    #[arg(long, value_name = "PATH", requires = "peers")]
    python: Option<PathBuf>,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the page to this file; without it, to docs/dense-robustness.md if every scene runs
    /// with --peers
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
    /// Fail if a mark is missed
    #[arg(long)]
    check: bool,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// The listed scenes, and the two exposures.
const SCENES: [&str; 9] = [
    "tsukuba",
    "venus",
    "sawtooth",
    "barn1",
    "bull",
    "teddy",
    "cloth3",
    EXPOSURES[0],
    EXPOSURES[1],
];

/// The scene whose right eye is put out of place.
const RIG_SCENE: &str = "venus";

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let data = data_folder::required(options.data.as_deref())?;
    let wanted = |name: &&str| options.scene.is_empty() || options.scene.iter().any(|n| n == name);
    let names: Vec<String> = SCENES
        .into_iter()
        .filter(wanted)
        .map(str::to_owned)
        .collect();
    let scenes = dense_scenes(&data, &names)?;
    let python = match (options.peers, &options.python) {
        (false, _) => None,
        (true, Some(python)) => Some(python.clone()),
        (true, None) => {
            let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent();
            let root = root.context("the task stands in the repository")?;
            Some(python_environment::ready(&root.join("target"))?)
        }
    };
    let scratch = tempfile::tempdir().context("no room for altered pictures")?;
    let progress = progress(options.quiet);
    let mut seen = Vec::new();
    for name in &names {
        let named = scenes
            .iter()
            .find(|(scene, _)| scene.description.name == *name);
        let (scene, truth) = named.with_context(|| format!("no scene {name}"))?;
        let conditions = conditions(name);
        progress.inc_length(conditions.len() as u64);
        for condition in conditions {
            progress.set_message(format!("{name}, {}", condition.title()));
            let stem = scratch.path().join(format!("{name}-{}", seen.len()));
            let one = Seen::of(scene, truth, condition, &stem)
                .with_context(|| format!("scene {name}, {}", condition.title()))?;
            seen.push(one);
            progress.inc(1);
        }
    }
    let mut versions = BTreeMap::new();
    if let Some(python) = &python {
        progress.set_message("SGBM");
        versions = sgbm(python, scratch.path(), &mut seen)?;
    }
    progress.finish_and_clear();
    let run = DenseRobustnessRun {
        schema: DenseRobustnessRun::SCHEMA,
        date: date::today(),
        machine: Machine::this(),
        command: command(options),
        versions,
        trials: seen.into_iter().map(|seen| seen.trial).collect(),
    };
    println!("{}", dense_robustness_page::table(&run));
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&run)?)?;
    }
    let docs = || {
        // A page of a part, or without its yardstick, is no replacement for the page of all.
        let whole = options.scene.is_empty() && options.peers;
        whole
            .then(docs_folder)
            .flatten()
            .map(|docs| docs.join("dense-robustness.md"))
    };
    if let Some(path) = options.results.clone().or_else(docs) {
        write_file(&path, dense_robustness_page::page(&run).as_bytes())?;
    }
    let missed = dense_robustness_marks::missed(&run);
    for missed in &missed {
        println!("missed: {missed}");
    }
    if options.check && !missed.is_empty() {
        bail!("{} marks are missed; they stand above", missed.len());
    }
    Ok(())
}

/// What a scene is seen under.
fn conditions(scene: &str) -> Vec<Condition> {
    if EXPOSURES.contains(&scene) {
        return vec![Condition::AsTaken];
    }
    let rigs = (scene == RIG_SCENE).then(|| RigSigns::all().map(Condition::Rig));
    let rigs = rigs.into_iter().flatten();
    Condition::SERIES.into_iter().chain(rigs).collect()
}

/// A pair that we have seen, and that others are to see.
struct Seen {
    trial: DenseTrial,
    pair: Pair,
    /// NaN where it does not count.
    truth: Array2<f32>,
    visible: Array2<bool>,
}

impl Seen {
    fn of(
        scene: &StereoScene,
        truth: &Array2<f32>,
        condition: Condition,
        stem: &Path,
    ) -> anyhow::Result<Self> {
        let pair = scene.pair()?;
        let visible = Masks::of(scene, truth.view(), pair.left.rgb())?.visible;
        let on_rig = matches!(condition, Condition::Rig(_));
        let (eyes, paths) = if condition == Condition::AsTaken {
            (pair, scene.eye_paths())
        } else {
            altered(&pair, condition, stem)?
        };
        let search = search_of(truth.view())?;
        let altered = AlteredTruth::of(truth.view(), &condition.alteration());
        let mut residuals = None;
        let mut look = |preset: Preset| {
            let field = if on_rig {
                let (field, rows) = self_rectified(preset.params(), &eyes)?;
                let left = residual_px(&rows, &altered, &visible);
                residuals = Some((left, rows.residual_px()));
                field
            } else {
                dense(preset.params(), &eyes, search)?
            };
            let d = file_sign::d_of_field(&field, true);
            anyhow::Ok(Metrics::of(d.view(), altered.d.view(), visible.view()))
        };
        let (best, fast) = (look(Preset::Best)?, look(Preset::Fast)?);
        let (least, shifts) = if on_rig {
            let (least, count) = opencv_range(truth.view());
            (least, usize::try_from(count)?)
        } else {
            (0, search.shifts())
        };
        let trial = DenseTrial {
            scene: scene.description.name.clone(),
            condition,
            best,
            fast,
            sgbm: None,
            residual_px: residuals.map(|(left, _)| left),
            told_residual_px: residuals.map(|(_, told)| told),
        };
        let name = stem.file_name().context("a stem has a name")?;
        let pair = Pair {
            name: name.to_string_lossy().into_owned(),
            left: paths.left,
            right: paths.right,
            least,
            shifts,
        };
        Ok(Self {
            trial,
            pair,
            truth: altered.d,
            visible,
        })
    }
}

/// The eyes under a condition, grey, and the files that hold them.
fn altered(
    pair: &Binocular<Picture>,
    condition: Condition,
    stem: &Path,
) -> anyhow::Result<(Binocular<Picture>, Binocular<PathBuf>)> {
    let alteration = condition.alteration();
    let grey = Binocular {
        left: alteration.of_left(pair.left.luma().plane()),
        right: alteration.of_right(pair.right.luma().plane()),
    };
    let paths = Binocular {
        left: stem.with_extension("left.png"),
        right: stem.with_extension("right.png"),
    };
    for (grey, path) in [(&grey.left, &paths.left), (&grey.right, &paths.right)] {
        picture::write_rgb(path, grey.mapv(|grey| [grey; 3]).view())?;
    }
    let eyes = grey.try_map(|grey| Picture::of_samples(Samples::Grey8(grey)))?;
    Ok((eyes, paths))
}

/// Root mean square of the vertical disparity that an alignment truly leaves over visible pixels, px.
fn residual_px(rows: &RowAlignment, truth: &AlteredTruth, visible: &Array2<bool>) -> f64 {
    let (mut squares, mut count) = (0.0, 0usize);
    Zip::indexed(&truth.d)
        .and(&truth.dy)
        .and(visible)
        .for_each(|(y, x), d, dy, visible| {
            if *visible && d.is_finite() {
                let y = y as f64;
                let miss = rows.row(x as f64 - f64::from(*d), y) - (y + f64::from(*dy));
                squares += miss * miss;
                count += 1;
            }
        });
    (squares / count as f64).sqrt()
}

/// SGBM on every pair; with OpenCV's and numpy's versions.
fn sgbm(
    python: &Path,
    folder: &Path,
    seen: &mut [Seen],
) -> anyhow::Result<BTreeMap<String, String>> {
    let pairs: Vec<Pair> = seen.iter().map(|seen| seen.pair.clone()).collect();
    let runs = opencv::match_pairs(python, folder, &pairs, Some(TUNED_SGBM))?;
    let [run] = &*runs.runs else {
        bail!("OpenCV's script has no setting {TUNED_SGBM:?}");
    };
    for seen in seen {
        let size = Size::of_dim(seen.truth.dim());
        let (d, _) = opencv::read(folder, run, &seen.pair.name, size)?;
        seen.trial.sgbm = Metrics::of(d.view(), seen.truth.view(), seen.visible.view());
    }
    Ok(runs.versions)
}

/// The command that gives the same numbers again. Folders are one machine's own and left out.
fn command(options: &Options) -> String {
    let scenes = options
        .scene
        .iter()
        .map(|scene| format!(" --scene {scene}"));
    let peers = options.peers.then(|| " --peers".to_owned());
    std::iter::once("cargo xtask eval-dense-robustness".to_owned())
        .chain(scenes)
        .chain(peers)
        .collect()
}
