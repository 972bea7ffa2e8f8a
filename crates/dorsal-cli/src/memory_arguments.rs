use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};
use dorsal::allocentric_qsr::{Policy, Query};

use crate::pose_argument::{PoseArgument, PoseError};

/// What `dorsal memory` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, subcommand_required = true, arg_required_else_help = true)]
pub(crate) struct MemoryArguments {
    /// The file of the memory
    #[arg(
        long,
        global = true,
        value_name = "FILE",
        default_value = "memory.json"
    )]
    pub(crate) memory: PathBuf,

    #[command(subcommand)]
    pub(crate) command: MemoryCommand,
}

#[derive(Debug, Subcommand)]
pub(crate) enum MemoryCommand {
    /// Makes the file of an empty memory
    Init(InitArguments),
    /// Takes in a look: the scene.json that `dorsal look` or `dorsal demo` writes
    Add(AddArguments),
    /// Answers a question
    Ask(AskArguments),
    /// Says why the distance of one object from another is what it is, down to looks and facts
    Explain(ExplainArguments),
    /// Takes in a told fact, unless it contradicts what is known
    Tell(FactArguments),
    /// Takes a told fact back
    Retract(FactArguments),
    /// Shows all that is remembered
    Show(ShowArguments),
    /// Says what became different
    Diff(DiffArguments),
    /// Takes JSON lines from standard input and answers each with one on standard output
    Watch(WatchArguments),
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dorsal memory init
  dorsal memory init --memory arm.json --system arm.toml --policy follow")]
pub(crate) struct InitArguments {
    /// The distance classes: drs1, drs2, robot-150, robot-120 or a TOML file
    #[arg(long, value_name = "SYSTEM", default_value = "robot-120")]
    pub(crate) system: String,

    /// What to do with a look that contradicts the memory
    #[arg(long, value_enum, default_value = "refuse")]
    pub(crate) policy: PolicyArgument,

    /// Replace a memory that exists
    #[arg(long)]
    pub(crate) force: bool,
}

/// What to do with what contradicts the memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PolicyArgument {
    /// Refuse it with its reasons; the memory stays as it was
    Refuse,
    /// Seeing is believing: what is seen elsewhere has moved, and a fact it refutes is retracted
    Follow,
}

impl From<PolicyArgument> for Policy {
    fn from(policy: PolicyArgument) -> Self {
        match policy {
            PolicyArgument::Refuse => Self::Refuse,
            PolicyArgument::Follow => Self::Follow,
        }
    }
}

#[derive(Debug, Args)]
#[command(after_help = ADD_HELP)]
pub(crate) struct AddArguments {
    /// The scene.json of a look, or the folder that holds it
    pub(crate) scene: PathBuf,

    /// Where the observer stands: metres right and forward of the origin of the map and degrees
    /// turned to the left, as X,Z,HEADING [default: where it stood in the last look]
    #[arg(
        long,
        value_name = "X,Z,DEG",
        allow_hyphen_values = true,
        conflicts_with = "lost"
    )]
    pub(crate) pose: Option<PoseArgument>,

    /// One standard error of the pose: metres along each axis and degrees, as METRES,DEG
    #[arg(long, value_name = "M,DEG", requires = "pose")]
    pub(crate) pose_sigma: Option<PoseError>,

    /// The observer does not know where it is: a new map frame opens
    #[arg(long)]
    pub(crate) lost: bool,

    /// When the look was taken, in milliseconds [default: the time since 1970]
    #[arg(long, value_name = "MS")]
    pub(crate) time: Option<u64>,

    /// How far below the eyes the ground lies on which the objects stand, in metres; heights are
    /// counted from it, so every look of one memory needs it, or none [default: 0]
    #[arg(long, value_name = "M", value_parser = height)]
    pub(crate) eyes_height: Option<f64>,

    /// The cameras of the look: its depth map then says what the look shows of places where it
    /// reports nothing
    #[arg(long, value_name = "RIG.toml", requires = "eyes_height")]
    pub(crate) rig: Option<PathBuf>,

    /// The depth map [default: depth.pfm beside the scene]
    #[arg(long, value_name = "DEPTH.pfm", requires = "rig")]
    pub(crate) depth: Option<PathBuf>,

    /// Say what would become different, and leave the memory as it is
    #[arg(long)]
    pub(crate) dry_run: bool,

    #[command(flatten)]
    pub(crate) form: Form,
}

#[derive(Debug, Args)]
#[command(after_help = ASK_HELP)]
pub(crate) struct AskArguments {
    /// The question, in quotes
    #[arg(value_name = "QUERY")]
    pub(crate) query: Query,

    #[command(flatten)]
    pub(crate) form: Form,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Example:
  dorsal memory explain lamp cd_box
      Why the lamp is at its distance from the box: a tree down to looks and told facts.")]
pub(crate) struct ExplainArguments {
    /// The object that is placed
    pub(crate) of: String,

    /// The object it is placed from
    pub(crate) from: String,

    #[command(flatten)]
    pub(crate) form: Form,
}

#[derive(Debug, Args)]
#[command(after_help = FACT_HELP)]
pub(crate) struct FactArguments {
    /// The fact, in quotes
    #[arg(value_name = "FACT")]
    pub(crate) fact: String,

    #[command(flatten)]
    pub(crate) form: Form,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  dorsal memory show
  dorsal memory show --format dot | dot -Tsvg > memory.svg")]
pub(crate) struct ShowArguments {
    /// The form: a table, the memory file as it is, or a graph for Graphviz
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: ShowForm,
}

/// The form of a memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ShowForm {
    /// Tables for people
    Text,
    /// The snapshot, schema dorsal-memory/1
    Json,
    /// A graph for Graphviz
    Dot,
}

#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  cp memory.json before.json
  dorsal memory add out/room && dorsal memory diff before.json
  dorsal memory diff --from 1000 --to 5000")]
pub(crate) struct DiffArguments {
    /// An earlier state of the memory, with which it is compared
    #[arg(value_name = "BEFORE.json", required_unless_present = "from")]
    pub(crate) before: Option<PathBuf>,

    /// Tell the changes from this time on instead, in milliseconds
    #[arg(long, value_name = "MS", conflicts_with = "before")]
    pub(crate) from: Option<u64>,

    /// ... up to this time
    #[arg(long, value_name = "MS", requires = "from")]
    pub(crate) to: Option<u64>,

    #[command(flatten)]
    pub(crate) form: Form,
}

#[derive(Debug, Args)]
#[command(after_help = WATCH_HELP)]
pub(crate) struct WatchArguments {}

/// The form of an answer.
#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct Form {
    /// The form of the answer
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: Format,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Lines for people
    Text,
    /// One line of JSON
    Json,
}

const EXAMPLES: &str = "\
The memory is one file, memory.json unless --memory names another. It is replaced whole or not at
all; whoever changes it holds FILE.lock meanwhile.

Examples:
  dorsal memory init
  dorsal memory add out/room/scene.json
  dorsal memory add out/mine --pose 0.2,-0.1,30
  dorsal memory ask \"relation cup from box seen from robot\"
  dorsal memory tell \"lamp within vc of cup\"
  dorsal memory explain lamp box
  dorsal memory show
  dorsal memory watch < looks.jsonl

Exit codes: 0 success, 1 failure (no such memory, a contradiction, an object that is not known),
2 wrong arguments or words. What is refused leaves the memory as it was.";

const ADD_HELP: &str = "\
The map frame has its origin where the observer stood first: x to the right, z forward.

Examples:
  dorsal demo --out out
  dorsal memory init && dorsal memory add out/room
      The first look: the observer stands at the origin.
  dorsal memory add out/second --pose 0.3,0,-20 --pose-sigma 0.01,0.5
      It has gone 30 cm to the right and turned 20 degrees to the right, not quite surely.
  dorsal memory add out/third --rig rig.toml --eyes-height 0.6
      What is remembered in free space of the depth map counts as missing.";

const ASK_HELP: &str = "\
Questions:
  relation A from B [seen from C]         where A is at B
  within CLASSES of X [and CONDITION]..   which objects are at such a distance from X
  LABELS of X [seen from C] [and ..]      which objects bear such a label at X
  between A and B                         which objects lie between A and B
  reachable A [within METRES] [radius M]  whether an arm of 1 m gets to A
  free_path from A to B [radius METRES]   whether the straight way is free
  last_seen A                             when A was seen last
  where A                                 where A is for the robot, in metres
  explain A from B                        why the distance of A from B is what it is
`robot` is the robot; CLASSES and LABELS are joined by commas; `front`, `back`, `left` and `right`
are half the plane each; a name with blanks stands in double quotes.

Examples:
  dorsal memory ask \"relation pc_screen from cd_box seen from robot\"
  dorsal memory ask \"within c of robot and right of cup\"
  dorsal memory ask \"free_path from robot to cup radius 0.1\" --format json";

const FACT_HELP: &str = "\
A fact reads: A within CLASSES of B. The classes are labels or names of the memory's reference
system, joined by commas; an object need not have been seen.

Examples:
  dorsal memory tell \"lamp within vc of pc_screen\"
  dorsal memory tell \"lamp within close,nearby of cup\"
  dorsal memory retract \"lamp within vc of pc_screen\"";

const WATCH_HELP: &str = "\
Each line in is a look, a question, or a fact told or taken back; each line out is the answer:
{\"changes\": [..]}, {\"answer\": {..}} or {\"refused\": \"why\"}. What a line changes is in the file before
its answer is written, so a memory that is killed has lost nothing that was answered. A refused line
changes nothing and ends nothing.

Lines in:
  {\"look\": {\"time_ms\": 40, \"pose\": {\"x_m\": 0, \"z_m\": 0, \"heading_rad\": 0},
    \"seen\": [{\"object\": \"cup\", \"distance_m\": 0.8, \"bearing_rad\": 1.6,
              \"sigma_distance_m\": 0.01, \"sigma_bearing_rad\": 0.005}],
    \"view\": {\"half_rad\": 0.5, \"reach_m\": 2.5}}}
      (on one line; without \"pose\" the robot is lost, without \"view\" what is not seen says nothing)
  {\"ask\": \"within c of robot\"}
  {\"tell\": \"lamp within vc of cup\"}
  {\"retract\": \"lamp within vc of cup\"}

Examples:
  dorsal memory init && robot | dorsal memory watch > answers.jsonl
  echo '{\"ask\": \"within vc,c of robot\"}' | dorsal memory watch";

fn height(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(metres) if (0.0..=1000.0).contains(&metres) => Ok(metres),
        _ => Err("metres from 0 to 1000 are needed".to_owned()),
    }
}
