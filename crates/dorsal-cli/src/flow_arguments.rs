use std::path::PathBuf;

use clap::Args;

use crate::look_options::{energy, scales};
use crate::threads::Threads;

/// What `dorsal flow` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct FlowArguments {
    /// The earlier frame, the reference: PNG, PNM, JPEG or TIFF
    pub(crate) prev: PathBuf,

    /// The later frame, of the same eye and the same size
    pub(crate) next: PathBuf,

    /// Folder for the results; it is made if need be, and files of the same name are replaced
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// Write the best guess where the flow is unknown
    #[arg(long)]
    pub(crate) dense: bool,

    /// Scales of the pyramid, fewer where the frames are too small: N find motions of up to
    /// 0.75 * 2^N px; fewer err less where motion is slow
    #[arg(long, value_name = "N", default_value_t = DEFAULT_SCALES, value_parser = scales)]
    pub(crate) scales: usize,

    /// Least energy an orientation needs to be heard [default: 1e-7]; 1e-6 hears strong texture only
    #[arg(long, value_name = "X", value_parser = energy)]
    pub(crate) energy_threshold: Option<f32>,

    #[command(flatten)]
    pub(crate) threads: Threads,

    /// Say nothing on standard error: no progress, no notes
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// Motions of up to 24 px.
const DEFAULT_SCALES: usize = 5;

const EXAMPLES: &str = "\
Files written:
  flow.flo         Middlebury's format, float pairs (u, v) in pixels: PREV (x, y) is seen at
                   NEXT (x + u, y + v), x right, y down; 1e10 unknown
  flow.png         direction as hue, speed as strength, over a wheel of the colours with the
                   speed at its rim in pixels; white stands still, grey is unknown
  confidence.pfm   0 to 1
  confidence.png   the same in colours over a scale bar
  validity.png     255 valid, 200 inconsistent, 150 occluded, 100 out of view, 50 incoherent,
                   25 singular, 0 no energy
  flow.json        parameters, densities, speeds, times
  index.html       all of it to look at: one page, no network

Examples:
  dorsal flow frame1.png frame2.png --out out
  dorsal flow frame1.png frame2.png --out out --dense --scales 6";
