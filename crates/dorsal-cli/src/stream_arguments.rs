use std::path::PathBuf;

use clap::Args;

/// Where the looks of a stream go.
#[derive(Debug, Args)]
pub(crate) struct StreamArguments {
    /// Log every look in MCAP, for Foxglove or the Rerun viewer; the file takes its name when it is whole,
    /// and is FILE.part until then
    #[arg(long, value_name = "FILE")]
    pub(crate) mcap: Option<PathBuf>,

    /// Write a line of JSON a look to this file; - is standard output, which is where the lines go if
    /// nothing else is asked for
    #[arg(long, value_name = "FILE|-")]
    pub(crate) jsonl: Option<PathBuf>,

    /// Write the files of dorsal look, a folder a look
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// End after so many looks
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    pub(crate) looks: Option<u64>,
}
