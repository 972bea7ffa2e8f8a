use clap::{Args, ValueEnum};
use dorsal::v1_gabor::Size;

use crate::look_options::LookOptions;
use crate::stream_arguments::StreamArguments;
use crate::threads::Threads;

/// What `dorsal live` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct LiveArguments {
    /// What comes on standard input: frames with the left eye's picture in their left half and the right
    /// eye's in the right one
    #[arg(long, value_enum, default_value = "y4m")]
    pub(crate) format: Format,

    /// Size of the whole frames of --format gray
    #[arg(long, value_name = "WxH", value_parser = size, required_if_eq("format", "gray"))]
    pub(crate) size: Option<Size>,

    /// Look at every frame, however long that takes; for files, where a camera would not wait
    #[arg(long)]
    pub(crate) every_frame: bool,

    #[command(flatten)]
    pub(crate) into: StreamArguments,

    #[command(flatten)]
    pub(crate) options: LookOptions,

    #[command(flatten)]
    pub(crate) threads: Threads,

    /// Say nothing on standard error: no status, no notes
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// What comes on standard input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// YUV4MPEG2 of eight bits, of which the luma is used
    Y4m,
    /// Grey frames of eight bits, one after another
    Gray,
}

const EXAMPLES: &str = "\
The newest frame is looked at; frames that come meanwhile are dropped and counted, so that what is seen
is never older than one look. Ctrl-C ends the look that is under way, writes everything to its end, and
exits with 0; so does the end of the stream.

Examples:
  ffmpeg -f v4l2 -i /dev/video0 -f yuv4mpegpipe -pix_fmt yuv420p - | dorsal live --rig rig.toml
  ffmpeg -i walk.mp4 -f rawvideo -pix_fmt gray - | dorsal live --format gray --size 1280x480 --mcap walk.mcap
  ffmpeg -i left.mp4 -i right.mp4 -filter_complex hstack -f yuv4mpegpipe -pix_fmt yuv420p - \\
    | dorsal live --every-frame --rig rig.toml --segment --jsonl looks.jsonl";

fn size(text: &str) -> Result<Size, String> {
    let sides = text.split_once(['x', 'X']).and_then(|(width, height)| {
        Some(Size {
            width: width.parse().ok()?,
            height: height.parse().ok()?,
        })
    });
    match sides {
        None => Err("a width and a height such as 1280x480 are needed".to_owned()),
        Some(Size { width, height }) if width == 0 || height == 0 || width % 2 == 1 => {
            Err(format!(
                "a frame of {width} x {height} has no two halves; a side-by-side pair is an even number of pixels wide"
            ))
        }
        Some(size) => Ok(size),
    }
}
