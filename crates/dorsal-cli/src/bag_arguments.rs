use std::path::PathBuf;

use clap::Args;

use crate::look_options::LookOptions;
use crate::stream_arguments::StreamArguments;
use crate::threads::Threads;

/// What `dorsal bag` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct BagArguments {
    /// A recording of ROS 2 in MCAP
    #[arg(value_name = "IN.mcap")]
    pub(crate) bag: PathBuf,

    /// The topic of the left eye's pictures: sensor_msgs Image or CompressedImage
    #[arg(long, value_name = "TOPIC")]
    pub(crate) left: String,

    /// The topic of the right eye's pictures
    #[arg(long, value_name = "TOPIC")]
    pub(crate) right: String,

    /// The topics of the two cameras, sensor_msgs CameraInfo: with them, or with --rig, there is depth in
    /// metres [default: camera_info beside the pictures, if it is there]
    #[arg(long, num_args = 2, value_names = ["LEFT_INFO", "RIGHT_INFO"], conflicts_with = "rig")]
    pub(crate) info: Option<Vec<String>>,

    /// The pictures were rectified before they were recorded, so P of their cameras holds; without it,
    /// if "rect" is in the name of the left topic
    #[arg(long)]
    pub(crate) rectified: bool,

    /// How far apart the stamps of a pair may be, in milliseconds
    #[arg(long, value_name = "MS", default_value_t = 5.0, value_parser = milliseconds)]
    pub(crate) tolerance: f64,

    /// Look at every so many-th pair
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) every: u64,

    #[command(flatten)]
    pub(crate) into: StreamArguments,

    #[command(flatten)]
    pub(crate) options: LookOptions,

    #[command(flatten)]
    pub(crate) threads: Threads,

    /// Say nothing on standard error: no progress, no notes
    #[arg(long)]
    pub(crate) quiet: bool,
}

const EXAMPLES: &str = "\
Pictures of both topics are paired by the stamps of their headers; what stays without a partner is
dropped and counted. Encodings: mono8, mono16, rgb8, bgr8, rgba8, bgra8, rgb16, bgr16, and PNG or JPEG in
a CompressedImage. Each look is written before the next begins, so a recording that was cut off gives
every look up to the cut, and then exit code 1.

The recording's own topics are printed if one of those given is not among them.

Examples:
  dorsal bag walk.mcap --left /left/image_raw --right /right/image_raw --mcap looks.mcap
  dorsal bag walk.mcap --left /left/image_rect --right /right/image_rect --segment --jsonl looks.jsonl
  dorsal bag walk.mcap --left /l --right /r --rig rig.toml --out looks --every 10
  dorsal bag walk.mcap --left /l --right /r --info /l_info /r_info --tolerance 20 | head -1";

fn milliseconds(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|number| (0.0..=10_000.0).contains(number))
        .ok_or_else(|| "a number of milliseconds from 0 to 10000 is needed".to_owned())
}
