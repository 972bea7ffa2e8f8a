use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use clap::Args;
use disparity_pyramid::{DisparityField, MatchParams};
use ndarray::{Array2, ArrayView2, Ix2};
use stereo_formats::scene_folder::{self, StereoScene};
use stereo_formats::{npy, picture};
use v1_gabor::{Binocular, LumaImage};

use crate::alteration::Alteration;
use crate::altered_truth::{self, AlteredTruth};
use crate::curve_svg;
use crate::data_folder;
use crate::date;
use crate::docs_folder::docs_folder;
use crate::estimator::vector;
use crate::eval_middlebury::{progress, write_file};
use crate::machine::Machine;
use crate::masks::Masks;
use crate::metrics::Metrics;
use crate::opencv_peer::{Job, OpenCv, OpenCvOptions, StereoJob};
use crate::robustness_marks;
use crate::robustness_page::{self, robustness_page};
use crate::robustness_run::{AlteredTrial, RobustnessRun, SceneTrials, Trial};
use crate::robustness_series::Series;

/// Alters the right pictures of real pairs as bad rigs and bad cameras do, and measures what that
/// costs, OpenCV's SGBM and BM beside us.
///
/// Vertical shift, roll, pitch, scale, gain, gamma, noise, blur, and some together; the truth is
/// carried through every geometric change exactly. Prints tables and whether the marks hold; writes
/// docs/robustness.md and its curves.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask eval-robustness --data ~/data
  cargo xtask eval-robustness --scene venus --series roll --series noise --no-opencv
  cargo xtask eval-robustness --python ~/venv/bin/python --json out/robustness.json --check")]
pub(crate) struct Options {
    /// The data folder; without it, the one that the variable DORSAL_DATA names
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Only this scene, by the name in its scene.toml; may be given more than once
    #[arg(long, value_name = "NAME", default_values = DEFAULT_SCENES)]
    scene: Vec<String>,
    /// Only this series; may be given more than once
    #[arg(long, value_enum)]
    series: Vec<Series>,
    #[command(flatten)]
    opencv: OpenCvOptions,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write the page to this file, and its curves below the folder pictures beside it; without it,
    /// to docs/robustness.md if every series is run on the default scenes with OpenCV beside us
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
    /// Fail if a mark is missed
    #[arg(long)]
    check: bool,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Scenes of one set, with slants, steps and weak texture.
const DEFAULT_SCENES: [&str; 5] = ["tsukuba", "venus", "sawtooth", "barn1", "bull"];

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let data = data_folder::required(options.data.as_deref())?;
    let scenes = scenes(&data, options)?;
    let opencv = options.opencv.find()?;
    let conditions = options.conditions();
    let progress = progress(options.quiet);
    let matchers = if opencv.is_some() { 3 } else { 1 };
    progress.set_length((scenes.len() * (conditions.len() + 1) * matchers) as u64);
    let mut run = RobustnessRun {
        schema: RobustnessRun::SCHEMA,
        date: date::today(),
        machine: Machine::this(),
        command: command(options),
        opencv: None,
        scenes: Vec::new(),
    };
    for (scene, truth) in &scenes {
        let name = &scene.description.name;
        progress.set_message(name.clone());
        let bench = Bench::of(scene, truth).with_context(|| format!("scene {name}"))?;
        let (trials, version) = bench
            .trials(&conditions, opencv.as_ref(), || progress.inc(1))
            .with_context(|| format!("scene {name}"))?;
        run.scenes.push(SceneTrials {
            scene: name.clone(),
            citation: scene.description.citation.clone(),
            ..trials
        });
        run.opencv = version;
    }
    progress.finish_and_clear();
    for series in Series::ALL {
        if let Some(table) = robustness_page::table(&run, series) {
            println!("{}\n{table}", series.title());
        }
    }
    println!("{}", robustness_marks::table(&run));
    write(&run, options, opencv.is_some())?;
    match robustness_marks::missed(&run) {
        Some(missed) if options.check => bail!(missed),
        _ => Ok(()),
    }
}

/// The scenes that are wanted, in the order of their paths, with their truth.
fn scenes(data: &Path, options: &Options) -> anyhow::Result<Vec<(StereoScene, Array2<f32>)>> {
    let mut found = Vec::new();
    for scene in scene_folder::stereo_scenes(data)? {
        let wanted = options.scene.contains(&scene.description.name);
        if wanted
            && scene.description.rectified
            && let Some(truth) = scene.truth()?
        {
            found.push((scene, truth));
        }
    }
    let there = |name: &String| found.iter().any(|(s, _)| s.description.name == *name);
    if let Some(missing) = options.scene.iter().find(|name| !there(name)) {
        bail!(
            "no rectified scene {missing} with dense truth below {}; --scene NAME picks others",
            data.display()
        );
    }
    Ok(found)
}

fn write(run: &RobustnessRun, options: &Options, opencv: bool) -> anyhow::Result<()> {
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(run)?)?;
    }
    let docs = || {
        // A page of a part, or without its yardstick, is no replacement for the page of all.
        let whole = options.scene == DEFAULT_SCENES && options.series.is_empty() && opencv;
        whole
            .then(docs_folder)
            .flatten()
            .map(|docs| docs.join("robustness.md"))
    };
    let Some(path) = options.results.clone().or_else(docs) else {
        return Ok(());
    };
    write_file(&path, robustness_page(run).as_bytes())?;
    let folder = path.parent().unwrap_or(Path::new(""));
    let errors = robustness_page::curves(run, "mean absolute error, px", |metrics| {
        metrics.mean_absolute
    });
    let densities = robustness_page::curves(run, "answered, % of visible pixels", |metrics| {
        100.0 * metrics.density
    });
    for (name, sheet) in [
        (robustness_page::ERROR_CURVES, errors),
        (robustness_page::DENSITY_CURVES, densities),
    ] {
        write_file(&folder.join(name), curve_svg::encode(&sheet).as_bytes())?;
    }
    Ok(())
}

/// One scene on the bench: its pictures, its truth, the pixels that count.
struct Bench<'a> {
    eyes: Binocular<LumaImage>,
    /// `d = x_left - x_right`, NaN unknown.
    truth: &'a Array2<f32>,
    visible: Array2<bool>,
}

impl<'a> Bench<'a> {
    fn of(scene: &StereoScene, truth: &'a Array2<f32>) -> anyhow::Result<Self> {
        let pair = scene.pair()?;
        let masks = Masks::of(scene, truth.view(), pair.left.rgb())?;
        Ok(Self {
            eyes: pair.map(picture::Picture::into_luma),
            truth,
            visible: masks.visible,
        })
    }

    /// Every condition, and the untouched pair, by every matcher; with OpenCV's version.
    fn trials(
        &self,
        conditions: &[(Series, f64)],
        opencv: Option<&OpenCv>,
        advance: impl Fn(),
    ) -> anyhow::Result<(SceneTrials, Option<String>)> {
        let scratch = tempfile::tempdir().context("no room for altered pictures")?;
        let path = |name: String| scratch.path().join(name);
        let (least, count) = altered_truth::opencv_range(self.truth.view());
        let alterations: Vec<Alteration> = std::iter::once(Alteration::NONE)
            .chain(
                conditions
                    .iter()
                    .map(|(series, amount)| series.alteration(*amount)),
            )
            .collect();
        let mut jobs = Vec::new();
        let mut trials = Vec::new();
        let mut truths = Vec::new();
        for (place, alteration) in alterations.iter().enumerate() {
            let seen = Binocular {
                left: alteration.of_left(self.eyes.left.plane()),
                right: alteration.of_right(self.eyes.right.plane()),
            };
            if opencv.is_some() {
                let write = |name: String, grey: &Array2<u8>| {
                    let rgb = grey.mapv(|grey| [grey; 3]);
                    picture::write_rgb(path(name.clone()), rgb.view()).map(|()| path(name))
                };
                let left = write(format!("left{place}.png"), &seen.left)?;
                let right = write(format!("right{place}.png"), &seen.right)?;
                let job = |matcher: &str| StereoJob {
                    left: left.clone(),
                    right: right.clone(),
                    least,
                    count,
                    out: path(format!("{matcher}{place}.npy")),
                };
                jobs.push(Job::Sgbm(job("sgbm")));
                jobs.push(Job::Bm(job("bm")));
            }
            let eyes = seen.try_map(|grey| LumaImage::new(grey.mapv(|g| f32::from(g) / 255.0)))?;
            let field = vector(&eyes.as_ref(), MatchParams::default())?;
            let truth = AlteredTruth::of(self.truth.view(), alteration);
            trials.push(self.judge(&field, &truth));
            truths.push(truth);
            advance();
        }
        let mut version = None;
        if let Some(opencv) = opencv {
            let done = opencv.run(&jobs, scratch.path(), &advance)?;
            version = Some(done.version);
            for (place, (trial, truth)) in trials.iter_mut().zip(&truths).enumerate() {
                let score = |matcher: &str| -> anyhow::Result<Option<Metrics>> {
                    let d = npy::read::<f32>(path(format!("{matcher}{place}.npy")))?;
                    let d = d.into_dimensionality::<Ix2>()?;
                    Ok(Metrics::of(d.view(), truth.d.view(), self.visible.view()))
                };
                trial.sgbm = score("sgbm")?;
                trial.bm = score("bm")?;
            }
        }
        let untouched = trials.remove(0);
        let altered = conditions.iter().zip(trials);
        let altered = altered.map(|(&(series, amount), trial)| AlteredTrial {
            series,
            amount,
            trial,
        });
        let trials = SceneTrials {
            scene: String::new(),
            citation: String::new(),
            untouched,
            altered: altered.collect(),
        };
        Ok((trials, version))
    }

    /// Our own errors on an altered pair.
    fn judge(&self, field: &DisparityField, truth: &AlteredTruth) -> Trial {
        let over = |estimate: ArrayView2<'_, f32>, truth: &Array2<f32>| {
            Metrics::of(estimate, truth.view(), self.visible.view())
        };
        let d = field.dx().mapv(|dx| -dx);
        Trial {
            ours: over(field.only_valid(d.view()).view(), &truth.d),
            ours_dense: over(d.view(), &truth.d),
            ours_vertical: over(field.only_valid(field.dy()).view(), &truth.dy),
            sgbm: None,
            bm: None,
        }
    }
}

impl Options {
    /// The series that are wanted, amount by amount.
    fn conditions(&self) -> Vec<(Series, f64)> {
        let wanted = Series::ALL
            .into_iter()
            .filter(|series| self.series.is_empty() || self.series.contains(series));
        wanted
            .flat_map(|series| series.amounts().iter().map(move |&amount| (series, amount)))
            .collect()
    }
}

/// The command that gives the same numbers again. Folders are one machine's own and left out.
fn command(options: &Options) -> String {
    let mut command = "cargo xtask eval-robustness".to_owned();
    if options.scene != DEFAULT_SCENES {
        for scene in &options.scene {
            command += " --scene ";
            command += scene;
        }
    }
    for series in &options.series {
        use clap::ValueEnum;
        if let Some(value) = series.to_possible_value() {
            command += " --series ";
            command += value.get_name();
        }
    }
    command
}
