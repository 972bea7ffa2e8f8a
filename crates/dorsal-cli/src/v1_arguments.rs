use std::path::PathBuf;

use clap::{Args, ValueEnum};
use dorsal::v1_gabor::{
    BadParams, Family, FilterBank, GaborParams, MonogenicBank, MonogenicParams, Size,
    SteerableOrder, SteerableParams,
};
use serde::Serialize;

use crate::threads::Threads;

/// What `dorsal v1` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct V1Arguments {
    /// The picture: PNG, PNM, JPEG or TIFF
    pub(crate) image: PathBuf,

    /// Folder for the results; it is made if need be, and files of the same name are replaced
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// The filters
    #[arg(long, value_enum, default_value = "gabor")]
    pub(crate) family: FamilyName,

    /// Orientations, 4 to 32 [default: 8]; sqf has one a pixel and takes none
    #[arg(long, value_name = "N")]
    orientations: Option<usize>,

    /// Scales, each half the size of the one before [default: 6, or as many as the picture carries]
    #[arg(long, value_name = "N")]
    scales: Option<usize>,

    /// Frequency of the largest gain, in radians a pixel of each scale [default: pi / 2]
    #[arg(long, value_name = "RAD_PER_PX", allow_negative_numbers = true)]
    peak_frequency: Option<f32>,

    /// Octaves between the frequencies of half gain [default: 1]; s2 (1.76) and s4 (1.22) have
    /// their own
    #[arg(long, value_name = "OCTAVES", allow_negative_numbers = true)]
    bandwidth: Option<f32>,

    /// Width of a filter in pixels, odd [default: 11]; sqf is made in the Fourier domain and has
    /// none
    #[arg(long, value_name = "N", value_parser = taps)]
    taps: Option<usize>,

    #[command(flatten)]
    pub(crate) threads: Threads,

    /// Say nothing on standard error: no progress, no notes
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// A family of band-pass filters, by the name that the paper's Table 1 has for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "snake_case")]
pub(crate) enum FamilyName {
    /// Gabor filters, the paper's choice
    Gabor,
    /// Steerable quadrature pairs of second order (Freeman & Adelson)
    S2,
    /// Steerable quadrature pairs of fourth order
    S4,
    /// Spherical quadrature filters (Felsberg & Sommer): one orientation a pixel
    Sqf,
}

/// A bank of one of the families.
#[derive(Clone, Debug)]
pub(crate) enum Bank {
    /// Oriented filters.
    Oriented(Box<FilterBank>),
    /// Spherical ones.
    Spherical(MonogenicBank),
}

const EXAMPLES: &str = "\
Files written (S: the scale, 0 the finest; Q: the orientation, whose wave vector points along
Q * 180 / N degrees, 0 along x and 90 down):
  index.html                 all of it to look at: one page, no network
  v1.json                    family, parameters, sizes, files, times
  scaleS_responses.npy       complex64 (orientation, y, x); phase grows along the wave vector
  scaleS_orientationQ.png    phase as hue (0, a bright line, red), amplitude as brightness
  scaleS_responses.png       all orientations on one sheet, over their angles in degrees
  scaleS_energy.npy, .png    float32 (y, x): sum of |response|^2; the picture shows its log10
  scaleS_dominant.npy, .png  float32 (2, y, x): angle in radians [0, pi), strength 0 to 1; NaN
                             none; twice the angle as hue, the strength as brightness
  scaleS_frequency.npy, .png float32 (orientation, 2, y, x): phase gradient along x and y in
                             rad/px of the scale; the picture shows the part along the wave vector,
                             grey near singularities
  scaleS_singular.npy, .png  bool (orientation, y, x): where a phase means nothing (tau 1.25)
  congruency.npy, .png       float32 (y, x), 0 to 1: phase congruency over all scales: edges, lines
                             (two scales or more; noise T = 0.01)
with --family sqf
  scaleS_monogenic.npy       float32 (3, y, x): even part, Riesz parts along x and y
  scaleS_monogenic.png       the three side by side, positive red, negative blue green
  scaleS_local.npy           float32 (3, y, x): amplitude, phase [0, pi], orientation [0, pi) or NaN
  scaleS_phase.png           phase as hue, amplitude as brightness
  scaleS_orientation.png     twice the orientation as hue, length of the Riesz parts as brightness

Examples:
  dorsal v1 left.png --out out
  dorsal v1 left.png --out out --family s4 --scales 3 --orientations 12
  dorsal v1 left.png --out out --peak-frequency 1.2 --bandwidth 1.2 --taps 13
  python3 -c \"import numpy; print(numpy.load('out/scale0_responses.npy').shape)\"";

impl V1Arguments {
    /// What no single argument has wrong, but several of them together: those that a family does
    /// not have, and combinations of which no filter can be made, whatever the picture.
    pub(crate) fn conflict(&self) -> Option<String> {
        let given = |given: bool, argument: &'static str, why: &str| {
            given.then(|| format!("{argument} is not for this family: {why}"))
        };
        let superfluous = match self.family {
            FamilyName::Gabor => None,
            FamilyName::S2 | FamilyName::S4 => given(
                self.bandwidth.is_some(),
                "--bandwidth",
                "the order of a derivative has its own, 1.76 octaves for s2 and 1.22 for s4",
            ),
            FamilyName::Sqf => given(
                self.orientations.is_some(),
                "--orientations",
                "sqf finds one local orientation a pixel",
            )
            .or_else(|| {
                given(
                    self.taps.is_some(),
                    "--taps",
                    "sqf is made in the Fourier domain",
                )
            }),
        };
        // Larger than any picture that is read, so that only the filters are judged.
        let any_picture = Size {
            width: 1 << 20,
            height: 1 << 20,
        };
        superfluous.or_else(|| match self.bank(any_picture) {
            // How many scales there are, the picture decides.
            Ok(_) | Err(BadParams::TooManyScales { .. }) => None,
            Err(reason) => Some(reason.to_string()),
        })
    }

    /// The bank for pictures of one size. Scales that were asked for must be there; those of the
    /// default are as many as the picture carries.
    pub(crate) fn bank(&self, size: Size) -> Result<Bank, BadParams> {
        let gabor = GaborParams::default();
        let gabor = GaborParams {
            orientations: self.orientations.unwrap_or(gabor.orientations),
            scales: self.scales.unwrap_or(gabor.scales),
            peak_frequency: self.peak_frequency.unwrap_or(gabor.peak_frequency),
            bandwidth: self.bandwidth.unwrap_or(gabor.bandwidth),
            radius: self.taps.map_or(gabor.radius, |taps| taps / 2),
        };
        let steerable = |order| SteerableParams {
            order,
            orientations: gabor.orientations,
            scales: gabor.scales,
            peak_frequency: gabor.peak_frequency,
            radius: gabor.radius,
        };
        let oriented = |family: Family| {
            let family = match self.scales {
                Some(_) => family,
                None => family.fitted_to(size),
            };
            FilterBank::plan(family, size).map(|bank| Bank::Oriented(Box::new(bank)))
        };
        match self.family {
            FamilyName::Gabor => oriented(gabor.into()),
            FamilyName::S2 => oriented(steerable(SteerableOrder::Second).into()),
            FamilyName::S4 => oriented(steerable(SteerableOrder::Fourth).into()),
            FamilyName::Sqf => {
                let params = MonogenicParams {
                    scales: gabor.scales,
                    peak_frequency: gabor.peak_frequency,
                    bandwidth: gabor.bandwidth,
                };
                let params = match self.scales {
                    Some(_) => params,
                    None => params.fitted_to(size),
                };
                MonogenicBank::plan(params, size).map(Bank::Spherical)
            }
        }
    }
}

fn taps(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(taps @ 3..=255) if taps % 2 == 1 => Ok(taps),
        _ => Err("an odd number from 3 to 255 is needed: a filter has a middle".to_owned()),
    }
}
