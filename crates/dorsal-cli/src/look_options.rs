use std::path::PathBuf;

use clap::{Args, ValueEnum};
use dorsal::allocentric_qsr::QualifyParams;
use dorsal::disparity_pyramid::{DenseParams, MatchParams, SearchRange};
use dorsal::egocentric_depth::{LocateParams, SegmentParams, StereoRig};
use dorsal::v1_gabor::{GaborParams, Size};
use dorsal::{DenseLook, Range, Rows, Search};
use stereo_formats::rig_toml::SizedRig;

use crate::objects::Objects;
use crate::plan::Plan;
use crate::reference_system::reference_system;
use crate::rig_file::{read_rig, rig_of_pictures};

/// How to look at a pair, whether it comes from two files, a folder, a bag or a stream.
#[derive(Clone, Debug, Args)]
pub(crate) struct LookOptions {
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

    /// The two cameras: rig.toml, Middlebury's calib.txt, Kalibr's camchain, OpenCV's YAML or XML, or a folder
    /// of ROS's left.yaml and right.yaml; gives depth in metres (see dorsal rig convert)
    #[arg(long, value_name = "RIG.toml", required_if_eq("rectify", "rig"))]
    pub(crate) rig: Option<PathBuf>,

    /// Take depth with the rig as this look says it is: the right eye's slip, which every look with
    /// --rig prints, is corrected, and the rig is written to rig.fixed.toml
    #[arg(long, requires = "rig", conflicts_with = "rows_only")]
    pub(crate) recalibrate: bool,

    /// Find the objects without labels: what stands on a table or on the ground; they are called object-1,
    /// object-2, ... from left to right; needs --rig
    #[arg(long, requires = "rig")]
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

    /// Unhear what lies near a phase singularity of either eye, at 1.25 strictly, at 1.75 leniently;
    /// without it every response above the threshold is heard
    #[arg(long, value_name = "TAU", value_parser = tau)]
    pub(crate) singularity_tau: Option<f32>,
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

impl LookOptions {
    /// Where the vector pyramid searches. What is said of it holds; the paper's steps begin at zero,
    /// and so does what prepares the dense estimator.
    fn range(&self) -> Range {
        let said = self.scales.is_some() || self.zero_disparity.is_some();
        if said || self.published || self.estimator == Estimator::Dense {
            return Range::Given;
        }
        self.range.range()
    }

    /// What no single option has wrong, but two of them together.
    pub(crate) fn conflict(&self) -> Option<String> {
        if let (MostDisparity::Px(most), Some(least)) = (self.max_disparity, self.min_disparity)
            && least > most
        {
            return Some(format!(
                "no disparity lies between --min-disparity {least} and --max-disparity {most}"
            ));
        }
        (self.recalibrate && self.estimator == Estimator::Dense).then(|| {
            "--recalibrate needs vertical disparities, which the dense estimator does not see; \
             look with --estimator vector, or calibrate first"
                .to_owned()
        })
    }

    /// The rig that is given, if one is.
    pub(crate) fn rig(&self) -> anyhow::Result<Option<SizedRig>> {
        self.rig.as_deref().map(read_rig).transpose()
    }

    /// How to look at pictures of a size with these eyes at these objects, as far as they are known.
    pub(crate) fn plan(
        &self,
        size: Size,
        rig: Option<SizedRig>,
        objects: Option<Objects>,
    ) -> anyhow::Result<Plan> {
        let rig = rig.map(|rig| rig_of_pictures(&rig, size)).transpose()?;
        let gabor = GaborParams::default();
        let scales = match self.range() {
            Range::Given => self.scales.unwrap_or(gabor.scales),
            // A coarse look reads the coarsest; the search takes no more than it needs.
            Range::Auto | Range::Wide => gabor.most_scales(size),
        };
        let gabor = GaborParams { scales, ..gabor };
        let steps = if self.published {
            MatchParams::as_published()
        } else if objects.is_some() || self.segment {
            MatchParams::for_objects()
        } else {
            MatchParams::default()
        };
        Ok(Plan {
            estimator: self.estimator(rig.as_ref())?,
            gabor: gabor.fitted_to(size),
            matching: MatchParams {
                energy_threshold: self.energy_threshold.unwrap_or(steps.energy_threshold),
                // The command line speaks the sign of files.
                zero_disparity_px: (0.0 - self.zero_disparity.unwrap_or(0.0), 0.0),
                rows_only: self.rows_only,
                singularity_tau: self.singularity_tau,
                // The look writes it.
                covariance: true,
                ..steps
            },
            rig,
            recalibrate: self.recalibrate,
            objects,
            segmenting: self.segment.then(SegmentParams::default),
            locating: LocateParams::default(),
            reference: reference_system(&self.system)?,
            qualifying: QualifyParams::default(),
        })
    }

    /// The estimator that is asked for; the command line speaks the sign of files.
    fn estimator(&self, rig: Option<&StereoRig>) -> anyhow::Result<dorsal::Estimator> {
        if self.estimator == Estimator::Vector {
            return Ok(dorsal::Estimator::Vector(self.range()));
        }
        let search = match (self.max_disparity, self.min_disparity) {
            (MostDisparity::Auto, least) => Search::Found {
                most_dx: least.map(|least| -least),
            },
            (MostDisparity::Px(most), least) => {
                Search::Given(SearchRange::new(-most, -least.unwrap_or(most.min(0)))?)
            }
        };
        Ok(dorsal::Estimator::Dense(DenseLook {
            params: match self.preset {
                Preset::Fast => DenseParams::fast(),
                Preset::Best => DenseParams::best(),
            },
            search,
            rows: match self.rectify {
                Some(Rectify::None) => Rows::AsTaken,
                Some(Rectify::Auto) => Rows::Aligned,
                Some(Rectify::Rig) => Rows::Rectified,
                None if rig.is_some_and(|rig| !rig.is_rectified()) => Rows::Rectified,
                None => Rows::AsTaken,
            },
        }))
    }
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
