use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use dorsal::v1_gabor::Size;

use crate::look_options::scales;

/// What `dorsal rig` is asked to do.
#[derive(Debug, Args)]
#[command(
    after_help = "\
Examples:
  dorsal rig check rig.toml
  dorsal rig convert left.yaml right.yaml --out rig.toml
  dorsal rig rectify left.png right.png --rig rig.toml --out rectified",
    subcommand_required = true,
    arg_required_else_help = true
)]
pub(crate) struct RigArguments {
    #[command(subcommand)]
    pub(crate) task: RigTask,
}

#[derive(Debug, Subcommand)]
pub(crate) enum RigTask {
    /// Writes a rig in another format
    Convert(ConvertArguments),
    /// Says what a rig can see: nearest and farthest depth, and depth errors
    Check(CheckArguments),
    /// Makes a pair as it was taken into one whose rows correspond
    Rectify(RectifyArguments),
}

/// The files of a rig, of any format.
#[derive(Debug, Args)]
pub(crate) struct RigFiles {
    /// The rig: rig.toml, Middlebury's calib.txt, Kalibr's camchain.yaml, OpenCV's YAML or XML (one file,
    /// or intrinsics and extrinsics), or ROS camera_info YAML (left, then right, or the folder that
    /// holds left.yaml and right.yaml)
    #[arg(required = true, num_args = 1..=2, value_name = "RIG")]
    pub(crate) rig: Vec<PathBuf>,

    /// Length of a unit of OpenCV's translation in metres, such as 0.025 where it counts chessboard
    /// squares of 25 mm
    #[arg(
        long,
        value_name = "M",
        default_value_t = 1.0,
        value_parser = positive,
        allow_negative_numbers = true
    )]
    pub(crate) unit_m: f64,

    /// Size of the pictures, where the rig does not say it
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<Size>,
}

/// What `dorsal rig convert` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = CONVERT)]
pub(crate) struct ConvertArguments {
    #[command(flatten)]
    pub(crate) files: RigFiles,

    /// The file to write; for ROS a folder, which gets left.yaml and right.yaml
    #[arg(long, value_name = "PATH")]
    pub(crate) out: PathBuf,

    /// Its format
    #[arg(long, value_enum, default_value = "rig")]
    pub(crate) to: RigFormat,
}

/// A format of rigs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum RigFormat {
    /// Our own rig.toml, which holds everything
    Rig,
    /// ROS camera_info, a YAML file for each eye
    Ros,
    /// OpenCV FileStorage in YAML: M1 D1 M2 D2 R T
    OpencvYaml,
    /// The same in XML
    OpencvXml,
    /// Kalibr's camchain.yaml
    Kalibr,
    /// Middlebury's calib.txt, for parallel pinholes
    Middlebury,
}

/// What `dorsal rig check` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = CHECK)]
pub(crate) struct CheckArguments {
    #[command(flatten)]
    pub(crate) files: RigFiles,

    /// Scales of the pyramid [default: 3 to 8, a line each]
    #[arg(long, value_name = "N", value_parser = scales)]
    pub(crate) scales: Option<usize>,

    /// Disparity from which the search starts, x_left - x_right in pixels
    #[arg(
        long,
        value_name = "PX",
        default_value_t = 0.0,
        allow_negative_numbers = true
    )]
    pub(crate) zero_disparity: f64,

    /// Error of a disparity in pixels
    #[arg(
        long,
        value_name = "PX",
        default_value_t = 0.25,
        value_parser = positive,
        allow_negative_numbers = true
    )]
    pub(crate) disparity_sigma: f64,

    /// Print it as JSON
    #[arg(long)]
    pub(crate) json: bool,
}

/// What `dorsal rig rectify` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = RECTIFY)]
pub(crate) struct RectifyArguments {
    /// What the left eye sees, as it was taken
    pub(crate) left: PathBuf,

    /// What the right eye sees
    pub(crate) right: PathBuf,

    /// The rig
    #[arg(long, value_name = "RIG.toml")]
    pub(crate) rig: PathBuf,

    /// Folder for left.png, right.png, rig.toml and the maps
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

const CONVERT: &str = "\
What a format has no place for is left out, and said: only rig.toml holds the tilt of the head and what
is uncertain of it.

Examples:
  dorsal rig convert left.yaml right.yaml --out rig.toml
  dorsal rig convert intrinsics.yml extrinsics.yml --unit-m 0.025 --out rig.toml
  dorsal rig convert rig.toml --to ros --out calibration --size 640x480
  dorsal rig convert camchain.yaml --to opencv-xml --out stereo.xml";

const CHECK: &str = "\
Depths are those straight ahead. A dash is a depth that one eye's picture does not show, or a search that
reaches none.

Examples:
  dorsal rig check rig.toml
  dorsal rig check camchain.yaml --scales 6 --zero-disparity 40
  dorsal rig check intrinsics.yml extrinsics.yml --unit-m 0.025 --size 640x480
  dorsal rig check rig.toml --json";

const RECTIFY: &str = "\
Files written:
  left.png, right.png   the pair as parallel pinholes would have taken it
  rig.toml              the rig it then belongs to
  map_{left,right}_{x,y}.npy
                        for each pixel the place of the picture as it was taken that it shows, as
                        cv2.remap takes it; NaN where nothing does

Examples:
  dorsal rig rectify left.png right.png --rig rig.toml --out rectified
  dorsal look rectified/left.png rectified/right.png --rig rectified/rig.toml --out out --estimator dense";

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(number) if number > 0.0 && number <= f64::MAX => Ok(number),
        _ => Err("a positive, finite number is needed".to_owned()),
    }
}

fn size(text: &str) -> Result<Size, String> {
    let sides = text.split_once(['x', 'X']).and_then(|(width, height)| {
        Some(Size {
            width: width.parse().ok().filter(|&side| side > 0)?,
            height: height.parse().ok().filter(|&side| side > 0)?,
        })
    });
    sides.ok_or_else(|| "a size such as 640x480 is needed".to_owned())
}
