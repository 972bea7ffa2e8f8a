use std::collections::BTreeMap;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::time::Duration;

use anyhow::Context;
use clap::Args;
use disparity_pyramid::{
    DenseMatcher, DenseParams, DenseWorkspace, DisparityField, EyeView, MatchParams, SearchRange,
    VectorMatcher,
};
use egocentric_depth::StereoRig;
use indicatif::ProgressBar;
use serde::Serialize;
use stereo_scenes::{Exposure, Gaze, Room, render};
use v1_gabor::{BankWorkspace, Binocular, FilterBank, GaborParams, LumaImage, Size, V1Responses};

use crate::bench_page::bench_page;
use crate::clocked::{Clocked, clocked};
use crate::date;
use crate::docs_folder::docs_folder;
use crate::eval_middlebury::{progress, write_file};
use crate::machine::Machine;
use crate::opencv_clock::{MATCHERS, OpencvClock};
use crate::python_environment;
use crate::whole_look::WholeLook;

/// Disparities that the dense estimators search, ours and others.
const SHIFTS: usize = 128;

/// Time the levels on a rendered pair, with OpenCV's matchers in turn
///
/// Renders the project's own room at each size and runs every contestant once a round, so that what
/// else the machine does meets all of them alike; the medians of the rounds stand. A contestant's time
/// goes from the images to the field: for the vector pyramid with both banks. With --peers OpenCV's
/// SGBM, its three-way mode, BM (all with 128 disparities) and DIS run in the same rounds, in a
/// Python of their own (see compare-opencv). A whole look goes on from both fields to depths, objects and
/// relations. Some contestants run on two threads too. Writes docs/performance.md if all sizes run with --peers.
#[derive(Args, Debug)]
#[command(after_help = "\
Examples:
  cargo xtask bench
  cargo xtask bench --size 1024x768 --peers --json out/bench.json
  cargo xtask bench --size 640x480 --threads 2 --rounds 21")]
pub(crate) struct Options {
    /// Size of the images; may be given more than once. Without it 384x288, 640x480, 1024x768 and
    /// 1920x1080
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Vec<Size>,
    /// Rounds, each with one run of every contestant
    #[arg(long, value_name = "N", default_value_t = 7, value_parser = clap::value_parser!(u16).range(1..))]
    rounds: u16,
    /// Threads of every contestant
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..))]
    threads: u16,
    /// Run OpenCV's matchers too
    #[arg(long)]
    peers: bool,
    /// A Python that has numpy and OpenCV already; nothing is installed then
    #[arg(long, value_name = "PATH", requires = "peers")]
    python: Option<PathBuf>,
    /// Write every number to this file, as JSON
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// What was measured.
#[derive(Debug, Serialize)]
pub(crate) struct Report {
    schema: &'static str,
    pub(crate) date: String,
    pub(crate) machine: Machine,
    pub(crate) command: String,
    pub(crate) threads: u16,
    pub(crate) rounds: u16,
    /// OpenCV's version, if it ran.
    pub(crate) opencv: Option<String>,
    pub(crate) sizes: Vec<AtSize>,
    /// How many times faster than OpenCV's SGBM, by CPU medians (with peers only; `vector_vs_sgbm` is the
    /// pyramid without its look back, `vector_default_vs_sgbm` with it), and whole looks a second by the
    /// median wall time on two threads, at the size that comes nearest to 1024 x 768.
    pub(crate) ratios: BTreeMap<&'static str, f64>,
}

/// The contestants at one size.
#[derive(Debug, Serialize)]
pub(crate) struct AtSize {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) contestants: Vec<Contestant>,
    /// The same on two threads, for those that are asked.
    pub(crate) two_threads: Vec<TwoThreads>,
}

/// One contestant on one thread and on two, in the same rounds.
#[derive(Debug, Serialize)]
pub(crate) struct TwoThreads {
    pub(crate) name: &'static str,
    /// Median wall time.
    pub(crate) wall_ms: f64,
    /// The median over the rounds of the wall time on as many threads as all contestants have over this one.
    pub(crate) times_faster: f64,
}

/// One contestant's medians.
#[derive(Debug, Serialize)]
pub(crate) struct Contestant {
    pub(crate) name: &'static str,
    pub(crate) cpu_ms: f64,
    pub(crate) least_cpu_ms: f64,
    pub(crate) wall_ms: f64,
    pub(crate) cpu_ns_a_pixel: f64,
}

/// Ours, and what they are called.
const RESPONSES: &str = "responses of both eyes";
const VECTOR: &str = "vector pyramid";
const NO_LOOK_BACK: &str = "vector pyramid, no look back";
const ONE_WARP: &str = "vector pyramid, one warp";
const DENSE_FAST: &str = "dense, fast";
const DENSE_FULL: &str = "dense, fast, whole range";
const DENSE_BEST: &str = "dense, best";
const DENSE_VERGED: &str = "dense, fast, verged pair";
const LOOK: &str = "whole look";

const OURS: [&str; 9] = [
    RESPONSES,
    VECTOR,
    NO_LOOK_BACK,
    ONE_WARP,
    DENSE_FAST,
    DENSE_FULL,
    DENSE_BEST,
    DENSE_VERGED,
    LOOK,
];

/// Those that run on two threads too.
const ON_TWO: [&str; 4] = [VECTOR, NO_LOOK_BACK, DENSE_FAST, LOOK];

/// OpenCV's matchers that search along rows, as the dense estimator does.
const ALONG_ROWS: [&str; 3] = ["SGBM", "3WAY", "BM"];

/// Distance of the parallel eyes at a width of 1024 pixels, in metres: the room's things then lie
/// within the [`SHIFTS`] that are searched. At other widths the eyes move, and the shifts stay.
const PARALLEL_BASELINE_M: f64 = 0.065;

/// Runs the task.
pub(crate) fn run(options: &Options) -> anyhow::Result<()> {
    let all = options.size.is_empty();
    let sizes = if all {
        let sizes = [(384, 288), (640, 480), (1024, 768), (1920, 1080)];
        sizes.map(|(width, height)| Size { width, height }).to_vec()
    } else {
        options.size.clone()
    };
    let python = match (&options.python, options.peers) {
        (_, false) => None,
        (Some(python), true) => Some(python.clone()),
        (None, true) => {
            let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent();
            let root = root.context("the task stands in the repository")?;
            Some(python_environment::ready(&root.join("target"))?)
        }
    };
    let mut report = Report {
        schema: "dorsal-bench-1",
        date: date::today(),
        machine: Machine::this(),
        command: command(options),
        threads: options.threads,
        rounds: options.rounds,
        opencv: None,
        sizes: Vec::new(),
        ratios: BTreeMap::new(),
    };
    let bar = progress(false);
    bar.set_length(sizes.len() as u64 * u64::from(options.rounds));
    for &size in &sizes {
        let (at_size, version) = at_size(size, python.as_deref(), options, &bar)?;
        report.sizes.push(at_size);
        report.opencv = version;
    }
    bar.finish_and_clear();
    report.ratios = ratios(&report.sizes);
    println!("{}", bench_page(&report));
    if let Some(path) = &options.json {
        write_file(path, &serde_json::to_vec_pretty(&report)?)?;
    }
    if all
        && options.peers
        && let Some(docs) = docs_folder()
    {
        write_file(&docs.join("performance.md"), bench_page(&report).as_bytes())?;
    }
    Ok(())
}

fn at_size(
    size: Size,
    python: Option<&Path>,
    options: &Options,
    bar: &ProgressBar,
) -> anyhow::Result<(AtSize, Option<String>)> {
    let room = Room::demo();
    let gaze = room.head().resized(size).fixate(room.fixation_m())?;
    let verged = render(&room, &gaze, Exposure::default())?.images;
    let gaze = parallel_gaze(&room, size)?;
    let view = render(&room, &gaze, Exposure::default())?;
    let parallel = view.images.clone();
    let start = |images: &Binocular<LumaImage>| match python {
        None => Ok(None),
        Some(python) => start_peers(python, images, usize::from(options.threads)).map(Some),
    };
    let mut peers = start(&verged)?;
    let mut along_rows = start(&parallel)?;
    let threads = rayon::ThreadPoolBuilder::new()
        .num_threads(usize::from(options.threads))
        .build()?;
    let two = rayon::ThreadPoolBuilder::new().num_threads(2).build()?;
    let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size)?;
    let look = WholeLook::plan(&room, &gaze, view, bank.clone());
    let mut ours = threads.install(|| Ours::plan(bank, look, verged, parallel))?;
    let mut on_two = ON_TWO.map(|name| (name, Vec::new(), Vec::new()));
    let mut runs: Vec<(&'static str, Vec<Clocked>)> = OURS.map(|name| (name, Vec::new())).to_vec();
    if peers.is_some() {
        runs.extend(MATCHERS.map(|name| (name, Vec::new())));
    }
    // The first round fills buffers and caches and does not count.
    for round in 0..=options.rounds {
        for (name, runs) in &mut runs {
            let clock = if ALONG_ROWS.contains(name) {
                &mut along_rows
            } else {
                &mut peers
            };
            let took = match clock {
                Some(peers) if MATCHERS.contains(name) => peers.run(name)?,
                _ => {
                    let (done, took) = clocked(|| threads.install(|| ours.run(name)));
                    done?;
                    took
                }
            };
            if round > 0 {
                runs.push(took);
            }
        }
        for (name, walls, gains) in &mut on_two {
            let mut wall = |pool: &rayon::ThreadPool| {
                let (done, took) = clocked(|| pool.install(|| ours.run(name)));
                done.map(|()| took.wall.as_secs_f64() * 1e3)
            };
            // One after the other, so that both meet the same machine.
            let (alone, both) = (wall(&threads)?, wall(&two)?);
            if round > 0 {
                walls.push(both);
                gains.push(alone / both);
            }
        }
        if round > 0 {
            bar.inc(1);
        }
    }
    let contestants = runs
        .into_iter()
        .map(|(name, runs)| Contestant::new(name, &runs, size));
    let at_size = AtSize {
        width: size.width,
        height: size.height,
        contestants: contestants.collect(),
        two_threads: on_two
            .into_iter()
            .map(|(name, walls, gains)| TwoThreads {
                name,
                wall_ms: median(walls),
                times_faster: median(gains),
            })
            .collect(),
    };
    Ok((at_size, peers.map(|peers| peers.version.clone())))
}

/// Parallel eyes at the head's place, tilted toward what it fixates.
fn parallel_gaze(room: &Room, size: Size) -> anyhow::Result<Gaze> {
    let head = room.head().resized(size);
    let ([_, y, z], [_, to_y, to_z]) = (head.position_m, room.fixation_m());
    let eyes = Binocular {
        left: head.intrinsics(),
        right: head.intrinsics(),
    };
    let baseline_m = PARALLEL_BASELINE_M * 1024.0 / size.width as f64;
    let rig = StereoRig::parallel(eyes, baseline_m)?.tilted((to_z - z).atan2(to_y - y))?;
    Ok(Gaze::new(head.position_m, head.heading_rad, size, rig)?)
}

/// OpenCV's matchers, ready for these pictures.
fn start_peers(
    python: &Path,
    images: &Binocular<LumaImage>,
    threads: usize,
) -> anyhow::Result<OpencvClock> {
    let folder = tempfile::tempdir().context("there is no room for the pictures")?;
    let paths = write_pair(images, folder.path())?;
    // The script has read the pictures when it has started.
    OpencvClock::start(python, (&paths.left, &paths.right), SHIFTS, threads)
}

/// The dense estimator, with what it keeps from frame to frame.
struct DenseStream {
    matcher: DenseMatcher,
    workspace: DenseWorkspace,
    field: DisparityField,
}

impl DenseStream {
    fn plan(params: DenseParams, size: Size) -> anyhow::Result<Self> {
        Ok(Self {
            matcher: DenseMatcher::plan(params, size)?,
            workspace: DenseWorkspace::new(),
            field: DisparityField::default(),
        })
    }
}

/// What runs of ours need, planned once as for a stream of frames.
struct Ours {
    images: Binocular<LumaImage>,
    /// The same room by parallel eyes: the dense estimator's pair.
    parallel: Binocular<LumaImage>,
    bank: FilterBank,
    workspace: BankWorkspace,
    responses: Binocular<V1Responses>,
    /// One for each setting.
    vector: BTreeMap<&'static str, VectorMatcher>,
    field: DisparityField,
    dense: BTreeMap<&'static str, DenseStream>,
    search: SearchRange,
    look: WholeLook,
}

impl Ours {
    fn plan(
        bank: FilterBank,
        look: WholeLook,
        images: Binocular<LumaImage>,
        parallel: Binocular<LumaImage>,
    ) -> anyhow::Result<Self> {
        let size = bank.size();
        let params = MatchParams::default();
        let settings = [
            (VECTOR, params),
            (
                NO_LOOK_BACK,
                MatchParams {
                    left_right_px: None,
                    ..params
                },
            ),
            (ONE_WARP, MatchParams::one_warp()),
        ];
        let vector = settings
            .into_iter()
            .map(|(name, params)| Ok((name, VectorMatcher::plan(bank.clone(), params)?)));
        let fast = DenseParams::fast();
        let whole = DenseParams {
            narrow_px: None,
            ..fast
        };
        let dense = [
            (DENSE_FAST, fast),
            (DENSE_FULL, whole),
            (DENSE_BEST, DenseParams::best()),
            (DENSE_VERGED, fast),
        ];
        let dense = dense
            .into_iter()
            .map(|(name, params)| Ok((name, DenseStream::plan(params, size)?)));
        Ok(Self {
            parallel,
            dense: dense.collect::<anyhow::Result<_>>()?,
            vector: vector.collect::<anyhow::Result<_>>()?,
            workspace: bank.workspace(),
            responses: Binocular {
                left: bank.silence(),
                right: bank.silence(),
            },
            bank,
            field: DisparityField::default(),
            search: SearchRange::new(1 - SHIFTS as i32, 0)?,
            look,
            images,
        })
    }

    /// One run of the contestant of this name.
    fn run(&mut self, name: &str) -> anyhow::Result<()> {
        if let Some(matcher) = self.vector.get_mut(name) {
            matcher.estimate_into(&self.images, &mut self.field)?;
            black_box(&self.field);
            return Ok(());
        }
        if name == RESPONSES {
            return self.respond();
        }
        if name == LOOK {
            return self.look.look();
        }
        let pair = if name == DENSE_VERGED {
            &self.images
        } else {
            &self.parallel
        };
        let views = pair.as_ref().map(EyeView::grey);
        let stream = self
            .dense
            .get_mut(name)
            .with_context(|| format!("nobody is called {name}"))?;
        let DenseStream {
            matcher,
            workspace,
            field,
        } = stream;
        matcher.estimate_into(&views, self.search, workspace, field)?;
        black_box(field);
        Ok(())
    }

    fn respond(&mut self) -> anyhow::Result<()> {
        let Self {
            images,
            bank,
            workspace,
            responses,
            ..
        } = self;
        bank.respond_into(&images.left, workspace, &mut responses.left)?;
        bank.respond_into(&images.right, workspace, &mut responses.right)?;
        Ok(())
    }
}

impl Contestant {
    fn new(name: &'static str, runs: &[Clocked], size: Size) -> Self {
        let sorted = |of: fn(&Clocked) -> Duration| {
            let mut times: Vec<f64> = runs.iter().map(|run| of(run).as_secs_f64() * 1e3).collect();
            times.sort_by(f64::total_cmp);
            times
        };
        let (cpu, wall) = (sorted(|run| run.cpu), sorted(|run| run.wall));
        let middle = runs.len() / 2;
        Self {
            name,
            cpu_ms: cpu[middle],
            least_cpu_ms: cpu[0],
            wall_ms: wall[middle],
            cpu_ns_a_pixel: cpu[middle] * 1e6 / size.area() as f64,
        }
    }
}

/// Both pictures as files that OpenCV reads.
fn write_pair(images: &Binocular<LumaImage>, folder: &Path) -> anyhow::Result<Binocular<PathBuf>> {
    let write = |image: &LumaImage, name: &str| -> anyhow::Result<PathBuf> {
        let Size { width, height } = image.size();
        let grey = image.plane().mapv(|luma| (255.0 * luma).round() as u8);
        let path = folder.join(name);
        let mut bytes = format!("P5\n{width} {height}\n255\n").into_bytes();
        bytes.extend(grey.iter());
        write_file(&path, &bytes)?;
        Ok(path)
    };
    Ok(Binocular {
        left: write(&images.left, "left.pgm")?,
        right: write(&images.right, "right.pgm")?,
    })
}

/// The middle one of some numbers, of two the larger; NaN of none.
fn median(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    numbers.get(numbers.len() / 2).copied().unwrap_or(f64::NAN)
}

/// How many times faster than SGBM ours are, and how often a second a whole look is done.
fn ratios(sizes: &[AtSize]) -> BTreeMap<&'static str, f64> {
    let nearest = sizes.iter().min_by_key(|at| {
        let area = at.width * at.height;
        area.abs_diff(1024 * 768)
    });
    let cpu = |name: &str| {
        let found = nearest?.contestants.iter().find(|one| one.name == name)?;
        Some(found.cpu_ms)
    };
    let names = [
        ("vector_vs_sgbm", NO_LOOK_BACK),
        ("vector_default_vs_sgbm", VECTOR),
        ("vector_one_warp_vs_sgbm", ONE_WARP),
        ("dense_fast_vs_sgbm", DENSE_FAST),
        ("dense_best_vs_sgbm", DENSE_BEST),
    ];
    let ratio = |(key, name)| Some((key, cpu("SGBM")? / cpu(name)?));
    let looks = nearest.and_then(|at| at.two_threads.iter().find(|one| one.name == LOOK));
    let looks = looks.map(|look| ("looks_per_second", 1e3 / look.wall_ms));
    names.into_iter().filter_map(ratio).chain(looks).collect()
}

/// The command that measures the same again.
fn command(options: &Options) -> String {
    let mut command = "cargo xtask bench".to_owned();
    for size in &options.size {
        command += &format!(" --size {}x{}", size.width, size.height);
    }
    if options.peers {
        command += " --peers";
    }
    command + &format!(" --threads {} --rounds {}", options.threads, options.rounds)
}

/// A size as the command line gives it.
fn size(text: &str) -> Result<Size, String> {
    let wrong = || format!("{text:?} is no size; write width x height, such as 1024x768");
    let (width, height) = text.split_once('x').ok_or_else(wrong)?;
    let number = |text: &str| {
        text.parse::<usize>()
            .ok()
            .filter(|n| (32..=8192).contains(n))
    };
    match (number(width), number(height)) {
        (Some(width), Some(height)) => Ok(Size { width, height }),
        _ => Err(format!("{}; each from 32 to 8192", wrong())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_refused() {
        assert_eq!(
            size("1024x768"),
            Ok(Size {
                width: 1024,
                height: 768
            })
        );
        for wrong in ["", "1024", "1024x", "x768", "0x768", "1024x-1", "9000x768"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    /// Ours run, each a round, and no ratio is claimed without a peer.
    #[test]
    fn a_small_bench_runs() {
        let options = Options {
            size: Vec::new(),
            rounds: 1,
            threads: 1,
            peers: false,
            python: None,
            json: None,
        };
        let size = Size {
            width: 160,
            height: 120,
        };
        let (at_size, version) = at_size(size, None, &options, &ProgressBar::hidden()).unwrap();
        assert_eq!(at_size.contestants.len(), OURS.len());
        assert!(at_size.contestants.iter().all(|one| one.wall_ms > 0.0));
        assert_eq!(at_size.two_threads.len(), ON_TWO.len());
        assert!(at_size.two_threads.iter().all(|one| one.times_faster > 0.0));
        let ratios = ratios(&[at_size]);
        assert!(version.is_none() && ratios.keys().eq(["looks_per_second"].iter()));
    }
}
