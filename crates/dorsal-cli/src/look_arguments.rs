use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use dorsal::Range;

use crate::threads::Threads;

/// What `dorsal look` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct LookArguments {
    /// What the left eye sees, the reference: PNG, PNM, JPEG or TIFF
    pub(crate) left: PathBuf,

    /// What the right eye sees, of the same size
    pub(crate) right: PathBuf,

    /// Folder for the results; it is made if need be, and files of the same name are replaced
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// How disparity is estimated; with --segment densely, if nothing is said, as a table before close eyes
    /// slants too much for the vector pyramid
    #[arg(
        long,
        value_enum,
        default_value = "vector",
        default_value_if("segment", "true", "dense")
    )]
    pub(crate) estimator: Estimator,

    /// How the dense estimator works: best for measurement, fast for robots
    #[arg(long, value_enum, default_value = "best")]
    pub(crate) preset: Preset,

    /// Largest disparity that the dense estimator tries, x_left - x_right in pixels, or auto: what
    /// the vector pyramid sees
    #[arg(long, value_name = "N|auto", default_value = "auto", value_parser = most_disparity, allow_negative_numbers = true)]
    pub(crate) max_disparity: MostDisparity,

    /// Least disparity that the dense estimator tries; negative for what lies beyond the point that
    /// converging eyes fixate [default: 0, or with --max-disparity auto what the pyramid sees]
    #[arg(long, value_name = "N", value_parser = pixels, allow_negative_numbers = true)]
    pub(crate) min_disparity: Option<i32>,

    /// How the rows of both pictures come to correspond before the dense estimator looks [default: rig
    /// if --rig says that they do not, else none]
    #[arg(long, value_enum)]
    pub(crate) rectify: Option<Rectify>,

    /// Write the best guess where the disparity is unknown; depth and objects never rest on
    /// guesses
    #[arg(long)]
    pub(crate) dense: bool,

    /// The two cameras: rig.toml, Middlebury's calib.txt, Kalibr's camchain, OpenCV's YAML or XML; gives
    /// depth in metres (see dorsal rig convert)
    #[arg(long, value_name = "RIG.toml", required_if_eq("rectify", "rig"))]
    pub(crate) rig: Option<PathBuf>,

    /// Take depth with the rig as this look says it is: the right eye's slip, which every look with
    /// --rig prints, is corrected, and the rig is written to rig.fixed.toml
    #[arg(long, requires = "rig", conflicts_with = "rows_only")]
    pub(crate) recalibrate: bool,

    /// The objects in the left image: a PNG whose samples are labels, or a TOML of outlines;
    /// needs --rig. The vector pyramid then gives more pixels, each a little less sure
    #[arg(long, value_name = "LABELS", requires = "rig")]
    pub(crate) labels: Option<PathBuf>,

    /// The names of the labels of a PNG: a TOML table "names" with lines such as 1 = "cup"; a TOML
    /// of outlines has its own
    #[arg(long, value_name = "NAMES.toml", requires = "labels")]
    pub(crate) names: Option<PathBuf>,

    /// Find the objects without labels: what stands on a table or on the ground; they are called object-1,
    /// object-2, ... from left to right; needs --rig
    #[arg(long, requires = "rig", conflicts_with = "labels")]
    pub(crate) segment: bool,

    /// The distance classes: drs1, drs2, robot-150, robot-120 or a TOML file
    #[arg(long, value_name = "SYSTEM", default_value = "robot-120")]
    pub(crate) system: String,

    /// Where the vector pyramid searches, unless --scales or --zero-disparity says it
    #[arg(long, value_enum, default_value = "auto", conflicts_with_all = ["scales", "zero_disparity", "published"])]
    pub(crate) range: RangeChoice,

    /// Scales of the pyramid, fewer where the image is too small: N find shifts of up to
    /// 0.75 * 2^N px from --zero-disparity [default: 6, or what --range finds]
    #[arg(long, value_name = "N", value_parser = scales)]
    pub(crate) scales: Option<usize>,

    /// Least energy an orientation needs to be heard; without it 1e-7, and the paper's 1e-6 with
    /// --published
    #[arg(long, value_name = "X", value_parser = energy)]
    pub(crate) energy_threshold: Option<f32>,

    /// Disparity from which the search starts, x_left - x_right in pixels [default: 0, or what --range
    /// finds]
    #[arg(long, value_name = "PX", value_parser = finite, allow_negative_numbers = true)]
    pub(crate) zero_disparity: Option<f32>,

    /// Match by the paper's own steps, without the robust fit and the look back
    #[arg(long)]
    pub(crate) published: bool,

    /// Search along the rows only, for rectified pairs: the vertical shift is held at 0
    #[arg(long)]
    pub(crate) rows_only: bool,

    /// Stretch filters along the slopes that are found at every scale, in place of the finest alone:
    /// slanted planes come out a little better; a fifth more time
    #[arg(long)]
    pub(crate) slants: bool,

    /// Unhear what lies near a phase singularity of either eye, at 1.25 strictly, at 1.75 leniently;
    /// without it every response above the threshold is heard
    #[arg(long, value_name = "TAU", value_parser = tau)]
    pub(crate) singularity_tau: Option<f32>,

    #[command(flatten)]
    pub(crate) threads: Threads,

    /// Say nothing on standard error: no progress, no notes
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// How disparity is estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Estimator {
    /// The paper's vector pyramid: dx and dy, nothing assumed of the rig
    Vector,
    /// A disparity at every pixel of a rectified pair, dx alone
    Dense,
}

/// Where the vector pyramid searches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RangeChoice {
    /// From 0 with 6 scales: up to 48 px
    Near,
    /// From 0 with 6 scales; if fewer than half of the pixels are valid then, as wide does
    Auto,
    /// Where a coarse look finds what is seen: for pairs far from 0, unrectified or large; it takes
    /// one to ten times as long on top
    Wide,
}

impl RangeChoice {
    pub(crate) const fn range(self) -> Range {
        match self {
            Self::Near => Range::Given,
            Self::Auto => Range::Auto,
            Self::Wide => Range::Wide,
        }
    }
}

/// A parameter set of the dense estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Preset {
    /// For robots: a rougher cost, one aggregation
    Fast,
    /// For measurement: every ingredient
    Best,
}

/// Whether and how rows are aligned first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Rectify {
    /// The pair is rectified
    None,
    /// One line a row, fitted to the vertical disparities that the vector pyramid sees: for a rig whose
    /// calibration is missing or cannot be trusted
    Auto,
    /// By the rig, whatever its attitude and its lenses; the results belong to the left picture as it was
    /// taken, with vertical disparities. --max-disparity counts in the rectified pair
    Rig,
}

/// The far end of the dense estimator's search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MostDisparity {
    /// What the vector pyramid sees.
    Auto,
    /// This, in pixels.
    Px(i32),
}

const EXAMPLES: &str = "\
Files written:
  disparity.pfm   d = x_left - x_right in pixels, nearer is larger; +inf unknown
  disparity.flo   the vectors (dx, dy), right minus left; 1e10 unknown
  disparity.png   d in colours over a scale bar; grey unknown
  confidence.pfm  0 to 1
  sigma_dx.pfm    one standard deviation of dx, and of dy in sigma_dy.pfm, in pixels; +inf
                  unknown (the vector pyramid's alone)
  sigma.pfm       with --rig: one standard deviation of d as real pairs have it, in pixels, which
                  depth and objects carry; +inf unknown (the vector pyramid's alone)
  validity.png    255 valid, 200 inconsistent, 150 occluded, 100 out of view, 50 incoherent,
                  25 singular, 0 no energy
  look.json       parameters, densities, times
  index.html      all of it to look at: one page, no network
  with --rig      depth.pfm (metres), depth.png (colours over a scale in metres), depth_mm.png
                  (16 bits, millimetres, 0 unknown), cloud.ply
  --recalibrate   rig.fixed.toml
  with --labels   scene.json: objects, egocentric and allocentric relations
  with --segment  the same, label_image.png (what --labels takes) and labels.png (a picture of it)

Examples:
  dorsal look left.png right.png --out out --dense
  dorsal look left.png right.png --out out --published --rows-only
  dorsal look left.png right.png --out out --estimator dense --max-disparity 64
  dorsal look left.png right.png --out out --estimator dense --rectify auto
  dorsal look left.png right.png --out out --range wide
  dorsal look left.png right.png --out out --rig rig.toml --scales 7 --zero-disparity 40
  dorsal look left.png right.png --out out --rig rig.toml --recalibrate
  dorsal look left.png right.png --out out --rig rig.toml --estimator dense
  dorsal look left.png right.png --out out --rig rig.toml --labels labels.png --names names.toml
  dorsal look left.png right.png --out out --rig rig.toml --segment

A rig.toml reads:
  baseline_m = 0.27
  vergence_deg = 15.0
  [left]
  focal_px = 887.0
  principal_point_px = [511.5, 383.5]";

impl LookArguments {
    /// Where the vector pyramid searches. What is said of it holds; the paper's steps begin at zero,
    /// and so does what prepares the dense estimator.
    pub(crate) fn range(&self) -> Range {
        let said = self.scales.is_some() || self.zero_disparity.is_some();
        if said || self.published || self.estimator == Estimator::Dense {
            return Range::Given;
        }
        self.range.range()
    }

    /// What no single argument has wrong, but two of them together.
    pub(crate) fn conflict(&self) -> Option<String> {
        if let (MostDisparity::Px(most), Some(least)) = (self.max_disparity, self.min_disparity)
            && least > most
        {
            return Some(format!(
                "no disparity lies between --min-disparity {least} and --max-disparity {most}"
            ));
        }
        let outlines = self.labels.as_deref().is_some_and(is_toml);
        if self.recalibrate && self.estimator == Estimator::Dense {
            return Some(
                "--recalibrate needs vertical disparities, which the dense estimator does not see; \
                 look with --estimator vector, or calibrate first"
                    .to_owned(),
            );
        }
        (outlines && self.names.is_some()).then(|| {
            "a TOML file of outlines given with --labels names its objects itself; \
             leave --names out"
                .to_owned()
        })
    }
}

/// Whether a label file is a TOML of outlines rather than a PNG.
pub(crate) fn is_toml(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}

pub(crate) fn scales(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(scales @ 1..=32) => Ok(scales),
        _ => Err("a whole number from 1 to 32 is needed".to_owned()),
    }
}

fn most_disparity(text: &str) -> Result<MostDisparity, String> {
    if text == "auto" {
        return Ok(MostDisparity::Auto);
    }
    match pixels(text) {
        Ok(px) => Ok(MostDisparity::Px(px)),
        Err(need) => Err(format!("{need}, or auto")),
    }
}

fn pixels(text: &str) -> Result<i32, String> {
    match text.parse() {
        Ok(px @ -8000..=8000) => Ok(px),
        _ => Err("a whole number of pixels from -8000 to 8000 is needed".to_owned()),
    }
}

pub(crate) fn energy(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(energy) if (0.0..=f32::MAX).contains(&energy) => Ok(energy),
        _ => Err("a finite number that is not negative is needed".to_owned()),
    }
}

fn tau(text: &str) -> Result<f32, String> {
    match text.parse() {
        Ok(tau) if tau > 0.0 && tau <= f32::MAX => Ok(tau),
        _ => Err("a positive, finite number is needed".to_owned()),
    }
}

pub(crate) fn degrees(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && number <= 90.0 => Ok(number),
        _ => Err("a positive number of at most 90 is needed".to_owned()),
    }
}

fn finite(text: &str) -> Result<f32, String> {
    text.parse()
        .ok()
        .filter(|number: &f32| number.is_finite())
        .ok_or_else(|| "a finite number of pixels is needed".to_owned())
}
