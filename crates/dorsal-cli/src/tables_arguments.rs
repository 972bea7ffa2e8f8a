use clap::{Args, ValueEnum};
use dorsal::allocentric_qsr::Case;

/// Which table `dorsal tables` prints, and how.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct TablesArguments {
    /// The distance classes: drs1, drs2, robot-150, robot-120 or a TOML file
    #[arg(long, value_name = "SYSTEM")]
    pub(crate) system: String,

    /// Which two distances are composed: 1 to 4, as in Figure 2 of the paper
    #[arg(long, value_name = "CASE", value_parser = case)]
    pub(crate) case: Case,

    /// The calculus
    #[arg(long, value_enum, default_value = "published")]
    pub(crate) mode: Calculus,

    /// The form of the table
    #[arg(long, value_enum, default_value = "text")]
    pub(crate) format: Format,
}

/// The calculus that fills the cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Calculus {
    /// The paper's answers, cell by cell
    Published,
    /// Every class that some configuration has
    Sound,
    /// The cells where the paper's answer excludes a real configuration, with numbers that show it
    Diff,
}

/// The form of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// Aligned columns
    Text,
    /// A table of GitHub-flavoured Markdown
    Markdown,
    /// An object of system, case, mode, labels, and cells by row and column
    Json,
}

const EXAMPLES: &str = "\
Rows are the first distance of the case, columns the second; a cell holds what the third may be.
  CASE 1  |bc| and |cd| give |bd|
  CASE 2  |ac| and |cd| give |ad|
  CASE 3  |bc| and |bd| give |cd|: from an observer to what lies between two objects
  CASE 4  |ac| and |bd| give nothing about |ad|

Examples:
  dorsal tables --system drs1 --case 1
  dorsal tables --system drs2 --case 3 --mode sound --format markdown
  dorsal tables --system drs2 --case 1 --mode diff
  dorsal tables --system arm.toml --case 1 --format json

A system of your own reads:
  name = \"arm\"
  class = [
    { short = \"in\", name = \"within_reach\", from_mm = 0 },
    { short = \"out\", name = \"out_of_reach\", from_mm = 850 },
  ]";

fn case(text: &str) -> Result<Case, String> {
    text.parse()
        .ok()
        .and_then(Case::numbered)
        .ok_or_else(|| "a case is a number from 1 to 4".to_owned())
}
