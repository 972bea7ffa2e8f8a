use clap::{Args, ValueEnum};
use dorsal::allocentric_qsr::Mode;

/// Which composition `dorsal compose` works out.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct ComposeArguments {
    /// The first distance, and after `@` the labels that go with it
    #[arg(value_name = "CLASSES[@LABELS]")]
    pub(crate) first: String,

    /// The second distance, and after `@` the labels that go with it
    #[arg(value_name = "CLASSES[@LABELS]")]
    pub(crate) second: String,

    /// The distance classes: drs1, drs2, robot-150, robot-120 or a TOML file
    #[arg(long, value_name = "SYSTEM", default_value = "robot-120")]
    pub(crate) system: String,

    /// Which two distances are composed
    #[arg(long, value_enum)]
    pub(crate) case: CompositionCase,

    /// The calculus; the published one knows no labels
    #[arg(long, value_enum, default_value = "sound")]
    pub(crate) mode: ComposeMode,

    /// What |ab| may be: CASE 4 needs it to say anything
    #[arg(long, value_name = "CLASSES")]
    pub(crate) base: Option<String>,

    /// The form of the answer
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: crate::memory_arguments::Format,
}

/// The cases of Figure 2, and the step of Figure 3.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum CompositionCase {
    /// |bc| and |cd| give |bd|
    #[value(name = "1")]
    One,
    /// |ac| and |cd| give |ad|
    #[value(name = "2")]
    Two,
    /// |bc| and |bd| give |cd|
    #[value(name = "3")]
    Three,
    /// |ac| and |bd| give |ad|, over a known base |ab|
    #[value(name = "4")]
    Four,
    /// From an observer to what lies between two objects (Figure 3)
    Ego,
}

/// The calculus that answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ComposeMode {
    /// The paper's answer
    Published,
    /// Every place that some configuration has
    Sound,
}

impl From<ComposeMode> for Mode {
    fn from(mode: ComposeMode) -> Self {
        match mode {
            ComposeMode::Published => Self::Published,
            ComposeMode::Sound => Self::Sound,
        }
    }
}

const EXAMPLES: &str = "\
CLASSES and LABELS are joined by commas; without labels any may hold.
  1    c at b and d at c, the labels against the ways from a to b and from b to c
  2    the same labels, the distances from a to c and from c to d
  3    |bc|, and |bd| with the label of d at c: gives |cd|
  4    |ac| with the label of c at b, and |bd| with the label of d at c, over --base |ab|
  ego  |sI| and |sJ|, with the second the label of J for the observer s against the way to I:
       gives the place of J at I

Examples:
  dorsal compose --case 1 vc c
  dorsal compose --case 1 c@fl c@fl
      Two steps to the front left.
  dorsal compose --case ego n n@fl
      Two objects at 100 to 120 cm, the second to the left of the first.
  dorsal compose --case 3 fd fd --system drs2 --mode published";
