use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context, bail, ensure};
use clap::Args;
use disparity_pyramid::MatchParams;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use ndarray::Array2;
use stereo_formats::scene_folder::{self, StereoScene};

use crate::ablation;
use crate::bounds;
use crate::data_folder;
use crate::date;
use crate::docs_folder::docs_folder;
use crate::download::{self, Downloaded};
use crate::error_picture;
use crate::estimator::{Estimator, Preset, search_of};
use crate::evaluation::Evaluation;
use crate::machine::Machine;
use crate::manifest::{ListedScene, Manifest};
use crate::marks;
use crate::masks::Masks;
use crate::pyramid_ablation_run::{AblatedScene, AblationRun};
use crate::results_page::results_page;
use crate::scan_in_results;
use crate::score::Score;
use crate::score_tables;
use crate::table_1;
use crate::table_1_page;
use crate::table_1_run::{SceneRun, Table1Run};
use crate::textured_marks::{self, Textured};

/// Compares disparities with the truth of real pairs: every stereo scene with dense truth in the
/// data folder.
///
/// Prints mean absolute error, standard deviation, signed mean, RMS, bad-0.5/1/2/4 and density over
/// the masks all, visible, estimated and textured, for the valid pixels and for the best guess
/// everywhere, and the paper's Table 1 beside its three scenes; writes docs/results.md.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask eval-middlebury --data ~/data
  cargo xtask eval-middlebury --scene venus --scene tsukuba --pictures out
  cargo xtask eval-middlebury --estimator dense --preset fast --sparsification
  cargo xtask eval-middlebury --estimator dense --ablate --results out/ablation.md
  cargo xtask eval-middlebury --check --json out/eval.json --results out/results.md
  cargo xtask eval-middlebury --published --rows-only --scene venus
  cargo xtask eval-middlebury --table1
  cargo xtask eval-middlebury --ablate --scene venus
  cargo xtask eval-middlebury --data ~/data --download --from https://HOST/data

A data folder holds scenes as stereo/SET/SCENE; each has scene.toml beside its pictures. Middlebury's
pairs and truths can be downloaded from https://vision.middlebury.edu/stereo/data/")]
pub(crate) struct Options {
    /// The data folder; without it, the one that the variable DORSAL_DATA names
    #[arg(long, value_name = "DIR")]
    data: Option<PathBuf>,
    /// Only this scene, by the name in its scene.toml; may be given more than once
    #[arg(long, value_name = "NAME")]
    scene: Vec<String>,
    /// How disparities are estimated
    #[arg(long, value_enum, default_value_t = Estimator::Vector)]
    estimator: Estimator,
    /// The parameter set of the dense estimator
    #[arg(long, value_enum, default_value_t = Preset::Best)]
    preset: Preset,
    /// Match by the paper's own steps (`MatchParams::as_published`), the vector pyramid alone
    #[arg(long, conflicts_with_all = ["table1", "ablate"])]
    published: bool,
    /// Search along the rows only, the vector pyramid alone: the vertical shift is held at 0
    #[arg(long, conflicts_with_all = ["table1", "ablate"])]
    rows_only: bool,
    /// Least energy an orientation needs to be heard by the vector pyramid; without it 1e-7, and
    /// 1e-6 with --published
    #[arg(long, value_name = "X", conflicts_with_all = ["table1", "ablate"])]
    energy_threshold: Option<f32>,
    /// Unhear what lies near a phase singularity, the vector pyramid alone: 1.25 strictly, 1.75
    /// leniently
    #[arg(long, value_name = "TAU", conflicts_with_all = ["table1", "ablate"])]
    singularity_tau: Option<f32>,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Write pictures of truth, estimate and errors below this folder
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,
    /// Write the page of results to this file; without it, to docs/results.md if every scene is
    /// evaluated
    #[arg(long, value_name = "FILE")]
    results: Option<PathBuf>,
    /// Run the five rows of the paper's Table 1, on its three scenes, and write docs/table-1.md
    #[arg(long, conflicts_with_all = ["scene", "estimator", "pictures", "check"])]
    table1: bool,
    /// Print how well the confidence orders the errors: the area under the sparsification curve
    #[arg(long)]
    sparsification: bool,
    /// Instead, leave out each ingredient of the estimator in turn and print what that costs; the
    /// vector pyramid's goes to docs/ablation.md, that of a dense preset to --results
    #[arg(long, conflicts_with_all = ["table1", "pictures", "check"])]
    ablate: bool,
    /// Fail if an error is above its bound (dense, visible pixels: venus 0.45, sawtooth 0.70,
    /// tsukuba 0.70 px)
    #[arg(long)]
    check: bool,
    /// First fetch what is missing of the scenes into the data folder, and verify its checksums
    #[arg(long, requires = "from")]
    download: bool,
    /// Where --download finds a copy of the data folder: an http, https or file address
    #[arg(long, value_name = "URL", requires = "download")]
    from: Option<String>,
    /// Show no progress
    #[arg(long, short)]
    quiet: bool,
}

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    if options.estimator == Estimator::Dense && options.has_own_matching() {
        bail!(
            "--published, --rows-only, --energy-threshold and --singularity-tau are the vector \
             pyramid's; leave --estimator dense out"
        );
    }
    let data = data_folder(options.data.as_deref())?;
    if let (true, Some(base)) = (options.download, &options.from) {
        fetch(&data, base, options)?;
    }
    if options.table1 {
        return table_1(&data, options);
    }
    if options.ablate {
        return match options.estimator {
            Estimator::Vector => ablate_vector(&data, options),
            Estimator::Dense => ablate_dense(&data, options),
        };
    }
    let evaluation = Evaluation {
        schema: Evaluation::SCHEMA,
        date: date::today(),
        machine: Machine::this(),
        command: command(options),
        estimator: options.estimator,
        scenes: scores(&data, options)?,
        textured: textured(&data, options)?,
    };
    print(&evaluation, options);
    write(&evaluation, options)?;
    if options.check {
        bounds::check(&evaluation.scenes)?;
        textured_marks::check(&evaluation.textured)?;
        if options.estimator == Estimator::Dense {
            let missed = marks::missed(&evaluation.scenes, options.preset);
            ensure!(
                missed.is_empty(),
                "marks are missed:\n{}",
                missed.join("\n")
            );
        }
        println!("\nEvery bound holds.");
    }
    Ok(())
}

/// Prints the ablation, and writes it as a page of its own if one is named.
fn ablate_dense(data: &Path, options: &Options) -> anyhow::Result<()> {
    let scenes = dense_scenes(data, &options.scene)?;
    let progress = progress(options.quiet);
    let table = ablation::table(&scenes, options.preset.params(), |variant| {
        progress.set_message(variant.to_owned());
        progress.inc(1);
    })?;
    progress.finish_and_clear();
    let names = scenes.iter().map(|(scene, _)| &*scene.description.name);
    let names: Vec<&str> = names.collect();
    let machine = Machine::this();
    let page = format!(
        "# What each ingredient is worth\n\nWritten by `cargo xtask eval-middlebury --estimator dense \
         --ablate`; edits by hand are lost.\n\n- date: {}\n- machine: {}\n- preset: {}\n- scenes: \
         {}\n\nOne ingredient of the dense estimator is exchanged or left out at a time; the \
         parameters of the others stay. Errors over visible pixels (and all pixels), a value \
         everywhere.\n\n{table}",
        date::today(),
        machine.cpu,
        options.preset.name(),
        names.join(", "),
    );
    println!("{page}");
    if let Some(path) = &options.results {
        write_file(path, page.as_bytes())?;
    }
    Ok(())
}

/// The data folder that is named, or that the environment names.
pub(crate) fn data_folder(named: Option<&Path>) -> anyhow::Result<PathBuf> {
    named
        .map(Path::to_owned)
        .or_else(data_folder::of_environment)
        .with_context(|| {
            format!(
                "no data folder: name it with --data DIR or the variable {}.\n\
                 It holds scenes as stereo/SET/SCENE, each with scene.toml, left.png, right.png \
                 and disp_left.png or disp_left.pfm. Middlebury's pairs and truths can be \
                 downloaded from https://vision.middlebury.edu/stereo/data/; --download --from URL \
                 of eval-middlebury fetches them from a copy of such a folder",
                data_folder::VARIABLE
            )
        })
}

fn fetch(data: &Path, base: &str, options: &Options) -> anyhow::Result<()> {
    let manifest = Manifest::of_repository().context("fixtures/evaluation-data.toml")?;
    let listed: Vec<&str> = manifest.scenes.iter().map(|scene| &*scene.name).collect();
    if let Some(unknown) = options
        .scene
        .iter()
        .find(|name| !listed.contains(&&***name))
    {
        bail!(
            "no scene {unknown} can be downloaded; there are {}",
            listed.join(", ")
        );
    }
    let wanted = manifest
        .scenes
        .iter()
        .filter(|scene| options.wants(&scene.name));
    let wanted: Vec<&ListedScene> = wanted.collect();
    let progress = progress(options.quiet);
    let Downloaded { fetched, kept } =
        download::download(&wanted, data, base, &progress, download::with_curl)?;
    println!("{fetched} files fetched, {kept} were there; every checksum is right.");
    Ok(())
}

/// Evaluates the scenes that are wanted, in the order of their paths.
fn scores(data: &Path, options: &Options) -> anyhow::Result<Vec<Score>> {
    let scenes = dense_scenes(data, &options.scene)?;
    let progress = progress(options.quiet);
    progress.set_length(scenes.len() as u64);
    let mut scores = Vec::new();
    for (scene, truth) in scenes {
        progress.set_message(scene.description.name.clone());
        let score = score(&scene, &truth, options)
            .with_context(|| format!("scene {}", scene.description.name))?;
        scores.push(score);
        progress.inc(1);
    }
    progress.finish_and_clear();
    Ok(scores)
}

/// The rectified scenes that are wanted and have dense truth, with their truth.
pub(crate) fn dense_scenes(
    data: &Path,
    wanted: &[String],
) -> anyhow::Result<Vec<(StereoScene, Array2<f32>)>> {
    let mut found = Vec::new();
    for scene in scene_folder::stereo_scenes(data)? {
        if scene.description.rectified
            && let Some(truth) = scene.truth()?
        {
            found.push((scene, truth));
        }
    }
    let names: Vec<String> = found
        .iter()
        .map(|(scene, _)| scene.description.name.clone())
        .collect();
    if let Some(missing) = wanted.iter().find(|name| !names.contains(name)) {
        bail!(
            "no scene {missing} with dense truth below {}; there are {}.\n\
             A scene is a folder stereo/SET/{missing} with scene.toml beside left.png, right.png \
             and disp_left.png or disp_left.pfm. Middlebury's pairs and truths can be downloaded \
             from https://vision.middlebury.edu/stereo/data/",
            data.display(),
            names.join(", ")
        );
    }
    found.retain(|(scene, _)| wanted.is_empty() || wanted.contains(&scene.description.name));
    if found.is_empty() {
        bail!("no scene below {} has dense truth", data.display());
    }
    Ok(found)
}

fn score(scene: &StereoScene, truth: &Array2<f32>, options: &Options) -> anyhow::Result<Score> {
    let pair = scene.pair()?;
    let left = pair.left.rgb().to_owned();
    let masks = Masks::of(scene, truth.view(), left.view())?;
    let search = search_of(truth.view())?;
    let start = Instant::now();
    let field = options
        .estimator
        .look(options.preset, options.matching(), &pair, search)?;
    let took = start.elapsed();
    if let Some(folder) = &options.pictures {
        let name = &scene.description.name;
        error_picture::write(folder, name, left.view(), truth.view(), &field)?;
    }
    Ok(Score::of(
        &scene.description,
        &field,
        truth.view(),
        &masks,
        took,
    ))
}

/// Runs the paper's Table 1 again, prints it and writes its page.
fn table_1(data: &Path, options: &Options) -> anyhow::Result<()> {
    let scenes = in_order(dense_scenes(data, &options.scene)?)?;
    let progress = progress(options.quiet);
    progress.set_length(scenes.len() as u64);
    let mut run = Table1Run {
        schema: Table1Run::SCHEMA,
        date: date::today(),
        machine: Machine::this(),
        scenes: Vec::new(),
    };
    for (scene, truth) in scenes {
        let name = scene.description.name.clone();
        progress.set_message(name.clone());
        let scene = SceneRun::of(&scene, &truth).with_context(|| format!("scene {name}"))?;
        run.scenes.push(scene);
        progress.inc(1);
    }
    progress.finish_and_clear();
    println!(
        "Table 1, textured pixels (density)\n{}\nTable 1, visible pixels (density)\n{}\n\
         Table 1, textured pixels that every family calls valid\n{}",
        table_1_page::side_by_side(&run.scenes, |row| row.textured),
        table_1_page::side_by_side(&run.scenes, |row| row.visible),
        table_1_page::side_by_side(&run.scenes, |row| row.common),
    );
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&run)?)?;
    }
    let docs = || Some(docs_folder()?.join("table-1.md"));
    if let Some(path) = options.results.clone().or_else(docs) {
        write_file(&path, table_1_page::table_1_page(&run).as_bytes())?;
    }
    Ok(())
}

/// Matches with each ingredient off in turn, prints the means and writes the page.
fn ablate_vector(data: &Path, options: &Options) -> anyhow::Result<()> {
    let scenes = dense_scenes(data, &options.scene)?;
    let progress = progress(options.quiet);
    progress.set_length(scenes.len() as u64);
    let mut run = AblationRun {
        schema: AblationRun::SCHEMA,
        date: date::today(),
        machine: Machine::this(),
        scenes: Vec::new(),
    };
    for (scene, truth) in scenes {
        let name = scene.description.name.clone();
        progress.set_message(name.clone());
        let scene = AblatedScene::of(&scene, &truth).with_context(|| format!("scene {name}"))?;
        run.scenes.push(scene);
        progress.inc(1);
    }
    progress.finish_and_clear();
    println!("Means over the scenes, px\n{}", run.table());
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&run)?)?;
    }
    let docs = || {
        let all = options.scene.is_empty();
        all.then(docs_folder)
            .flatten()
            .map(|docs| docs.join("ablation.md"))
    };
    if let Some(path) = options.results.clone().or_else(docs) {
        write_file(&path, run.page().as_bytes())?;
    }
    Ok(())
}

/// The scenes of Table 1 in its order; all of them must be there.
fn in_order(
    mut scenes: Vec<(StereoScene, Array2<f32>)>,
) -> anyhow::Result<Vec<(StereoScene, Array2<f32>)>> {
    let found = table_1::SCENES.map(|name| {
        let place = scenes
            .iter()
            .position(|(scene, _)| scene.description.name == name);
        place
            .map(|place| scenes.swap_remove(place))
            .with_context(|| format!("Table 1 needs the scene {name}, and the data has none"))
    });
    found.into_iter().collect()
}

/// The scenes of Table 1 that are evaluated, once more over textured pixels in every way that has a mark;
/// none but beside the vector pyramid's default.
fn textured(data: &Path, options: &Options) -> anyhow::Result<Vec<Textured>> {
    if options.estimator == Estimator::Dense || options.has_own_matching() {
        return Ok(Vec::new());
    }
    let scenes = table_1::SCENES.into_iter();
    let mut found = Vec::new();
    for name in scenes.filter(|scene| options.wants(scene)) {
        for (scene, truth) in dense_scenes(data, &[name.to_owned()])? {
            found.extend(Textured::of(&scene, &truth).with_context(|| format!("scene {name}"))?);
        }
    }
    Ok(found)
}

fn print(evaluation: &Evaluation, options: &Options) {
    let scores = &evaluation.scenes;
    for score in scores {
        println!("{}, px\n{}", score.scene, score_tables::of_scene(score));
    }
    println!("Visible pixels, px\n{}", score_tables::of_all(scores));
    if options.estimator == Estimator::Dense
        && let Some(table) = marks::table(scores, options.preset)
    {
        println!("The marks, best guess everywhere\n{table}");
    }
    if options.sparsification {
        let table = score_tables::of_sparsification(scores);
        println!(
            "Area under the sparsification curve: bad-1 % among the most confident, averaged over \
             all numbers of them; visible pixels\n{table}"
        );
    }
    if let Some(table) = score_tables::beside_table_1(scores) {
        println!("The paper's Table 1 (density of ours)\n{table}");
    }
    if let Some(table) = textured_marks::table(&evaluation.textured) {
        println!("Valid, textured: mean / std, signed mean, px (density)\n{table}");
    }
}

fn write(evaluation: &Evaluation, options: &Options) -> anyhow::Result<()> {
    if let Some(path) = &options.json {
        let json = serde_json::to_vec_pretty(evaluation)?;
        write_file(path, &json)?;
    }
    let docs = || {
        // A page of some scenes is no replacement for the page of all, nor that of other
        // parameters or of another estimator, which compare-opencv writes.
        let all = options.scene.is_empty()
            && options.estimator == Estimator::Vector
            && !options.has_own_matching();
        all.then(docs_folder)
            .flatten()
            .map(|docs| docs.join("results.md"))
    };
    if let Some(path) = options.results.clone().or_else(docs) {
        write_file(&path, results_page(evaluation).as_bytes())?;
        if let (None, Some(docs)) = (&options.results, docs_folder()) {
            scan_in_results::refresh(&docs)?;
        }
    }
    Ok(())
}

/// Writes a file whole or not at all, and makes its folder if there is none.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    if let Some(folder) = path.parent() {
        std::fs::create_dir_all(folder)
            .with_context(|| format!("the folder {} cannot be made", folder.display()))?;
    }
    stereo_formats::replace(path, bytes)
        .with_context(|| format!("{} cannot be written", path.display()))
}

/// A bar on standard error; nothing at all if that is no terminal.
pub(crate) fn progress(quiet: bool) -> ProgressBar {
    let target = if quiet {
        ProgressDrawTarget::hidden()
    } else {
        ProgressDrawTarget::stderr()
    };
    let bar = ProgressBar::with_draw_target(Some(0), target);
    match ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}

/// The command that gives the same numbers again. Folders are one machine's own and left out.
fn command(options: &Options) -> String {
    let mut command = "cargo xtask eval-middlebury".to_owned();
    if options.estimator != Estimator::Vector {
        command += " --estimator ";
        command += options.estimator.name();
    }
    if options.estimator == Estimator::Dense {
        command += " --preset ";
        command += options.preset.name();
    }
    if options.published {
        command += " --published";
    }
    if options.rows_only {
        command += " --rows-only";
    }
    if let Some(energy) = options.energy_threshold {
        command += &format!(" --energy-threshold {energy:e}");
    }
    if let Some(tau) = options.singularity_tau {
        command += &format!(" --singularity-tau {tau}");
    }
    for scene in &options.scene {
        command += " --scene ";
        command += scene;
    }
    command
}

impl Options {
    /// Whether the vector pyramid's parameters are other than the default.
    fn has_own_matching(&self) -> bool {
        self.matching() != MatchParams::default()
    }

    /// The parameters of the vector pyramid.
    fn matching(&self) -> MatchParams {
        let steps = if self.published {
            MatchParams::as_published()
        } else {
            MatchParams::default()
        };
        MatchParams {
            rows_only: self.rows_only,
            energy_threshold: self.energy_threshold.unwrap_or(steps.energy_threshold),
            singularity_tau: self.singularity_tau,
            ..steps
        }
    }

    fn wants(&self, scene: &str) -> bool {
        if self.table1 {
            return table_1::SCENES.contains(&scene);
        }
        self.scene.is_empty() || self.scene.iter().any(|wanted| wanted == scene)
    }
}
