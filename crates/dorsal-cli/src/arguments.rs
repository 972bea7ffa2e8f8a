use clap::{CommandFactory as _, Parser, Subcommand, error::ErrorKind};

use crate::bag_arguments::BagArguments;
use crate::calibrate_arguments::CalibrateArguments;
use crate::completions::{CompletionsArguments, ManArguments};
use crate::compose_arguments::ComposeArguments;
use crate::demo_arguments::DemoArguments;
use crate::flow_arguments::FlowArguments;
use crate::live_arguments::LiveArguments;
use crate::look_arguments::LookArguments;
use crate::memory_arguments::MemoryArguments;
use crate::network_arguments::NetworkArguments;
use crate::rig_arguments::RigArguments;
use crate::tables_arguments::TablesArguments;
use crate::v1_arguments::V1Arguments;

/// What the command is asked to do.
#[derive(Debug, Parser)]
#[command(
    name = "dorsal",
    version,
    about = "From what two eyes see to depth a robot can act on and relations it can reason with",
    long_about = "From what two eyes see to depth a robot can act on and relations it can reason \
                  with.\n\nA stereo pair becomes a disparity field; with a rig it becomes depth in \
                  metres; with labels it becomes objects with places and relations.",
    after_help = EXAMPLES,
    subcommand_required = true,
    arg_required_else_help = true
)]
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Looks at a stereo pair, or at many, and writes what is seen
    Look(LookArguments),
    /// Looks at the pairs of a ROS 2 recording
    Bag(BagArguments),
    /// Looks at a camera's frames as they come
    Live(LiveArguments),
    /// Looks at a real pair and a rendered room, and compares with the truth
    Demo(DemoArguments),
    /// Corrects a rig by what its own eyes see, and says how well that is known
    Calibrate(CalibrateArguments),
    /// Converts rigs between formats, says what they can see, rectifies pairs
    Rig(RigArguments),
    /// Finds how every point moves between two frames of one eye, and writes it
    Flow(FlowArguments),
    /// Filters one picture as primary visual cortex does, and writes what it finds
    V1(V1Arguments),
    /// Prints a composition table of the qualitative calculus
    Tables(TablesArguments),
    /// Composes two relations of the qualitative calculus
    Compose(ComposeArguments),
    /// Closes a network of facts about distances, with proofs
    Network(NetworkArguments),
    /// Remembers looks and facts in a file, and answers questions about them
    Memory(MemoryArguments),
    /// Prints what a shell needs to complete this command's words
    Completions(CompletionsArguments),
    /// Prints the manual page, or writes those of all subcommands
    Man(ManArguments),
}

const EXAMPLES: &str = "\
Examples:
  dorsal demo --out out
      Nothing else is needed: a real pair and a rendered room come with the command.
  dorsal demo scan --out scan
      A head looks about in a rendered room, and remembers: open scan/index.html.
  dorsal look left.png right.png --out out
      Disparity alone.
  dorsal look left.png right.png --out out --rig rig.toml --labels labels.toml
      Depth in metres, and the relations of the labelled objects.
  dorsal look pairs/ --out out --rig rig.toml
      Every pair of a folder; a batch that was cut off goes on.
  dorsal bag walk.mcap --left /left/image_raw --right /right/image_raw --mcap looks.mcap
      A robot's recording, to a log that Foxglove and the Rerun viewer open.
  ffmpeg -i walk.mp4 -f yuv4mpegpipe -pix_fmt yuv420p - | dorsal live --rig rig.toml
      Side-by-side frames as they come; a line of JSON a look.
  dorsal calibrate left.png right.png --rig rig.toml --out rig.fixed.toml
      The right eye's pose, corrected from the images themselves.
  dorsal flow frame1.png frame2.png --out out
      Optic flow between two moments of one eye.
  dorsal v1 left.png --out out
      What the first level knows of one picture: responses, orientations, edges.
  dorsal tables --system drs1 --case 1
      Table 2 of the paper.
  dorsal memory init && dorsal memory add out/room && dorsal memory ask \"within c of robot\"
      What is near the robot, seen or remembered.

Exit codes: 0 success, 1 failure (a broken file, a bound that does not hold), 2 wrong arguments.";

impl Arguments {
    /// The arguments of this process; wrong ones end it with a message and exit code 2, as
    /// `--help` and `--version` end it with 0.
    pub(crate) fn of_process() -> Self {
        let arguments = Self::parse();
        if let Some((subcommand, conflict)) = arguments.command.conflict() {
            let mut command = Self::command();
            // The subcommand gives the usage line that belongs to the message.
            command.build();
            let error = match command.find_subcommand_mut(subcommand) {
                Some(subcommand) => subcommand.error(ErrorKind::ArgumentConflict, conflict),
                None => command.error(ErrorKind::ArgumentConflict, conflict),
            };
            error.exit();
        }
        arguments
    }
}

impl Command {
    /// What no single argument has wrong but several together, with the name of the subcommand.
    fn conflict(&self) -> Option<(&'static str, String)> {
        match self {
            Self::Look(look) => Some(("look", look.conflict()?)),
            Self::V1(v1) => Some(("v1", v1.conflict()?)),
            Self::Bag(bag) => Some(("bag", bag.options.conflict()?)),
            Self::Live(live) => Some(("live", live.options.conflict()?)),
            Self::Demo(_)
            | Self::Calibrate(_)
            | Self::Rig(_)
            | Self::Tables(_)
            | Self::Compose(_)
            | Self::Network(_)
            | Self::Flow(_)
            | Self::Memory(_)
            | Self::Completions(_)
            | Self::Man(_) => None,
        }
    }
}
