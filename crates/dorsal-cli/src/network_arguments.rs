use std::path::PathBuf;

use clap::{Args, Subcommand};

use crate::memory_arguments::Form;

/// What `dorsal network` is asked to do.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES, subcommand_required = true, arg_required_else_help = true)]
pub(crate) struct NetworkArguments {
    #[command(subcommand)]
    pub(crate) command: NetworkCommand,
}

#[derive(Debug, Subcommand)]
pub(crate) enum NetworkCommand {
    /// Closes a network of facts: refutes it with a proof, or prints what follows
    Check(CheckArguments),
    /// Writes a network and its calculus in the text form of the constraint solver GQR
    Export(ExportArguments),
}

#[derive(Debug, Args)]
#[command(after_help = FILE_HELP)]
pub(crate) struct CheckArguments {
    /// The facts, one a line
    pub(crate) file: PathBuf,

    /// The distance classes: drs1, drs2, robot-150, robot-120 or a TOML file
    #[arg(long, value_name = "SYSTEM", default_value = "robot-120")]
    pub(crate) system: String,

    /// Say why the distance of two objects is what it is
    #[arg(long, num_args = 2, value_names = ["A", "B"])]
    pub(crate) explain: Option<Vec<String>>,

    #[command(flatten)]
    pub(crate) form: Form,
}

#[derive(Debug, Args)]
#[command(after_help = FILE_HELP)]
pub(crate) struct ExportArguments {
    /// The facts, one a line
    pub(crate) file: PathBuf,

    /// The distance classes: drs1, drs2, robot-150, robot-120 or a TOML file
    #[arg(long, value_name = "SYSTEM", default_value = "robot-120")]
    pub(crate) system: String,

    /// Folder for SYSTEM.spec, SYSTEM.comp, SYSTEM.conv and network.csp; it is made if need be
    #[arg(long, value_name = "DIR")]
    pub(crate) out: PathBuf,
}

const EXAMPLES: &str = "\
Examples:
  dorsal network check facts.txt
  dorsal network check facts.txt --explain lamp box
  dorsal network export facts.txt --out gqr

Exit codes: 0 not refuted, 1 inconsistent (the proof is printed) or a broken file, 2 wrong arguments.
Not refuted is less than consistent: no triangle contradicts another.";

const FILE_HELP: &str = "\
A file of facts has one fact a line; what follows a # is a comment:
  # The desk.
  cup within vc of box
  lamp within c,n of cup
  lamp left of cup seen from box
Where directions are told, distances and directions are closed together; GQR takes distances only.

Examples:
  dorsal network check facts.txt --system drs2
  dorsal network export facts.txt --out gqr";
