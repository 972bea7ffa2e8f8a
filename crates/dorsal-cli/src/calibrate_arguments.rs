use std::path::PathBuf;

use clap::Args;

use crate::look_options::{RangeChoice, degrees};
use crate::threads::Threads;

/// What `dorsal calibrate` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct CalibrateArguments {
    /// What the left eye sees, as it was taken: PNG, PNM, JPEG or TIFF
    pub(crate) left: PathBuf,

    /// What the right eye sees, of the same size
    pub(crate) right: PathBuf,

    /// The rig as it is thought to be: rig.toml, or any format of one file that dorsal rig reads
    #[arg(long, value_name = "RIG.toml")]
    pub(crate) rig: PathBuf,

    /// The rig as the images say it is; an existing file is replaced
    #[arg(long, value_name = "FIXED.toml")]
    pub(crate) out: PathBuf,

    /// One standard deviation of the rig's vergence, as its encoders have it, in degrees [default: the
    /// rig's own sigma of yaw, else 1]
    #[arg(long, value_name = "DEG", value_parser = degrees)]
    pub(crate) yaw_sigma: Option<f64>,

    /// One standard deviation of where the right eye sits, down and forward, in baselines [default: the
    /// rig's own sigma, else 0.01]
    #[arg(long, value_name = "SHARE", value_parser = degrees)]
    pub(crate) slip_sigma: Option<f64>,

    /// The rig was calibrated, and its eyes have since turned but not moved, as a knock or a slack gear
    /// turns them: nothing is expected of pitch, yaw and roll, and the centres sit where they should to a
    /// thousandth of the baseline
    #[arg(long, conflicts_with_all = ["yaw_sigma", "slip_sigma"])]
    pub(crate) turned: bool,

    /// Where the vector pyramid searches
    #[arg(long, value_enum, default_value = "auto")]
    pub(crate) range: RangeChoice,

    /// Print the correction as JSON
    #[arg(long)]
    pub(crate) json: bool,

    #[command(flatten)]
    pub(crate) threads: Threads,

    /// Say nothing on standard error: no progress, no notes
    #[arg(long)]
    pub(crate) quiet: bool,
}

const EXAMPLES: &str = "\
Finds how the right eye has slipped from where the rig has it, from the vertical component of the
disparities: pitch, yaw, roll, and how far down and forward it sits. Images fix pitch and roll to
hundredths of a degree and yaw to some tenths; what they do not tell stays as expected, and the length
of the baseline they never tell.

The corrected rig holds one standard error of each number in [sigma]; a look with it carries them to
every depth, and a calibration that starts from it takes them as what is expected.

Examples:
  dorsal calibrate left.png right.png --rig rig.toml --out rig.fixed.toml
  dorsal calibrate left.png right.png --rig rig.toml --out rig.fixed.toml --yaw-sigma 0.2
  dorsal calibrate left.png right.png --rig rig.toml --out rig.fixed.toml --turned
  dorsal calibrate next_left.png next_right.png --rig rig.fixed.toml --out rig.fixed.toml
      Look after look: each starts from what the last one knew.

Exit codes: 0 corrected, 1 the images do not tell where the right eye is, 2 wrong arguments.";
