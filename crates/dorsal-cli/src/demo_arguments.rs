use std::path::PathBuf;

use clap::{Args, Subcommand};

use crate::scan_arguments::ScanArguments;
use crate::threads::Threads;

/// What `dorsal demo` is asked to do.
#[derive(Debug, Args)]
#[command(
    after_help = EXAMPLES,
    args_conflicts_with_subcommands = true,
    subcommand_negates_reqs = true
)]
pub(crate) struct DemoArguments {
    #[command(subcommand)]
    pub(crate) kind: Option<DemoKind>,

    /// Folder for the results: motorcycle and room are made in it
    #[arg(long, value_name = "DIR", required = true)]
    pub(crate) out: Option<PathBuf>,

    /// Log both looks in MCAP, for Foxglove or the Rerun viewer
    #[arg(long, value_name = "FILE")]
    pub(crate) mcap: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) threads: Threads,

    /// Say nothing on standard error: no progress, no notes
    #[arg(long)]
    pub(crate) quiet: bool,
}

/// A demonstration of its own.
#[derive(Debug, Subcommand)]
pub(crate) enum DemoKind {
    /// Lets a head scan a rendered room, and holds the map that grows against the truth
    Scan(ScanArguments),
}

const EXAMPLES: &str = "\
First a real pair (Middlebury 2014 Motorcycle, quarter size), then a rendered room: each is looked
at, and depths and relations are printed next to the true ones. Each folder gets the files of
`dorsal look`, and with them
  left.png, right.png             the pair
  rig.toml                        the cameras
  label_image.png, names.toml     the objects, as --labels and --names take them
  labels.png                      the objects in colours, over the left picture
  true_disparity.pfm, .png        the truth, in the colours of disparity.png

The command fails with exit code 1 if a depth or a relation is not what it promises.

Examples:
  dorsal demo --out out
  dorsal demo --out out --mcap demo.mcap
  dorsal demo scan --out scan";
