use std::path::{Path, PathBuf};

use clap::Args;

use crate::look_options::LookOptions;
use crate::threads::Threads;

/// What `dorsal look` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct LookArguments {
    /// What the left eye sees, the reference: PNG, PNM, JPEG or TIFF; or, alone, a folder or a list of
    /// pairs
    #[arg(value_name = "LEFT|FOLDER|LIST")]
    pub(crate) left: PathBuf,

    /// What the right eye sees, of the same size
    pub(crate) right: Option<PathBuf>,

    /// Folder for the results; it is made if need be, and files of the same name are replaced
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    #[command(flatten)]
    pub(crate) options: LookOptions,

    /// The objects in the left image: a PNG whose samples are labels, or a TOML of outlines;
    /// needs --rig. The vector pyramid then gives more pixels, each a little less sure
    #[arg(
        long,
        value_name = "LABELS",
        requires = "rig",
        conflicts_with = "segment"
    )]
    pub(crate) labels: Option<PathBuf>,

    /// The names of the labels of a PNG: a TOML table "names" with lines such as 1 = "cup"; a TOML
    /// of outlines has its own
    #[arg(long, value_name = "NAMES.toml", requires = "labels")]
    pub(crate) names: Option<PathBuf>,

    /// Log the look in MCAP, for Foxglove or the Rerun viewer
    #[arg(long, value_name = "FILE")]
    pub(crate) mcap: Option<PathBuf>,

    /// Look again at pairs of a folder or a list whose results are there
    #[arg(long)]
    pub(crate) again: bool,

    #[command(flatten)]
    pub(crate) threads: Threads,

    /// Say nothing on standard error: no progress, no notes
    #[arg(long)]
    pub(crate) quiet: bool,
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
                  depth and objects carry; +inf unknown
  validity.png    255 valid, 200 inconsistent, 150 occluded, 100 out of view, 50 incoherent,
                  25 singular, 0 no energy
  look.json       parameters, densities, times
  index.html      all of it to look at: one page, no network
  with --rig      depth.pfm (metres), depth.png (colours over a scale in metres), depth_mm.png
                  (16 bits, millimetres, 0 unknown), cloud.ply (points with the direction their
                  surface faces, one standard deviation of depth, and colour)
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
  dorsal look left.png right.png --out out --rig rig.toml --mcap look.mcap
  dorsal look pairs/ --out out --rig rig.toml
  dorsal look pairs.txt --out out --threads 4

Many pairs: a folder holds left/ and right/ with files of the same names, or pictures side by side
whose names differ in left and right, l and r, im0 and im1, or folders with such a pair each. A list
(.txt, .csv, .tsv) has a pair a line: LEFT, RIGHT and, if you like, a NAME, split by tabs, commas or
spaces, seen from the list's folder; # begins a comment. Each pair gets a folder in --out, which
appears when all of it is written; a folder that is there already, of the same pictures and options, is
kept. So a batch that was cut off goes on where it was when the same command is given again.
summary.json and index.html tell of all pairs.

A rig.toml reads:
  baseline_m = 0.27
  vergence_deg = 15.0
  [left]
  focal_px = 887.0
  principal_point_px = [511.5, 383.5]";

impl LookArguments {
    /// What no single argument has wrong, but two of them together.
    pub(crate) fn conflict(&self) -> Option<String> {
        if self.right.is_none() {
            let given = [
                (
                    self.labels.is_some(),
                    "--labels belong to one picture; find objects with --segment",
                ),
                (
                    self.mcap.is_some(),
                    "--mcap logs one look; dorsal bag and dorsal live log many",
                ),
            ];
            if let Some((_, why)) = given.iter().find(|(given, _)| *given) {
                return Some(format!("many pairs are looked at, and {why}"));
            }
        } else if self.again {
            return Some(
                "--again is for a folder or a list of pairs; one pair is always looked at"
                    .to_owned(),
            );
        }
        let outlines = self.labels.as_deref().is_some_and(is_toml);
        if outlines && self.names.is_some() {
            return Some(
                "a TOML file of outlines given with --labels names its objects itself; \
                 leave --names out"
                    .to_owned(),
            );
        }
        self.options.conflict()
    }
}

/// Whether a label file is a TOML of outlines rather than a PNG.
pub(crate) fn is_toml(path: &Path) -> bool {
    path.extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("toml"))
}
