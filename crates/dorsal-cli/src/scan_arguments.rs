use std::path::PathBuf;

use clap::Args;

use crate::threads::Threads;

/// What `dorsal demo scan` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ScanArguments {
    /// Folder for the results; it is made if need be
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,

    /// The room, in TOML; without it, a long table that comes with the command
    #[arg(long, value_name = "ROOM.toml")]
    pub(crate) room: Option<PathBuf>,

    /// How often the head fixates
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub(crate) fixations: u16,

    /// Chooses noise, errors and what is moved
    #[arg(long, value_name = "N", default_value_t = 2)]
    pub(crate) seed: u64,

    /// A head without errors: exact encoders, no slip, pinholes; the cameras stay noisy
    #[arg(long)]
    pub(crate) exact: bool,

    /// Nothing is moved between the looks
    #[arg(long)]
    pub(crate) still: bool,

    /// Keep the memory in this file, and go on with what it holds; every look is on disk before its
    /// line is printed
    #[arg(long, value_name = "FILE")]
    pub(crate) memory: Option<PathBuf>,

    /// Log every look in MCAP, for Foxglove or the Rerun viewer
    #[arg(long, value_name = "FILE")]
    pub(crate) mcap: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) threads: Threads,

    /// Say nothing on standard error: no progress, no notes
    #[arg(long)]
    pub(crate) quiet: bool,
}

const EXAMPLES: &str = "\
The head looks at what is least known: the fixation that shows most ground that no look has
measured. When all is known, at what is least sure: the object whose place has the largest standard error,
which counts 2 cm more for every look since it was seen. Half way somebody moves one object. After
the N fixations three more go where things were not seen for longest: what six looks have not shown is no longer
vouched for, neither an object in its place nor ground that was free. Up to three looks go along the way
that is asked for. The last look is that of the paper's Figure 12: at one object, with the one to its right out of view.

Cameras have noise (a hundredth of white) and eight bits, lenses differ from their calibration,
encoders err by a twentieth of a degree, and the right eye has slipped by half a degree about two
axes: every look finds that out from its own two pictures.

Files written:
  index.html      all of it to look at: one page, no network
  scan.json       looks, places beside the truth, score, questions and answers
  memory.json     the memory, as dorsal memory reads it; memory.dot, its graph
  look_NN_left.png, look_NN_right.png, look_NN_rig.toml
                  what each look took, and its corrected rig, as dorsal look takes them

The command fails with exit code 1 if a way is called clear that is not, if more relations lack the
truth than three standard errors allow, or if Figure 12's question is answered wrongly.

Examples:
  dorsal demo scan --out scan
  dorsal demo scan --out scan --mcap scan.mcap
  dorsal demo scan --out scan --room room.toml --fixations 6
  dorsal demo scan --out scan --memory memory.json && dorsal memory ask --memory memory.json \"within c of robot\"";
