//! The project's own tasks, run as `cargo xtask TASK`.

// The project's tasks talk to people.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command line prints its results and its errors"
)]

mod ablation;
mod bounds;
mod compare_opencv;
mod comparison;
mod continuous;
mod cpu_clock;
mod data_folder;
mod date;
mod dense_results_page;
mod download;
mod error_picture;
mod estimator;
mod eval_middlebury;
mod evaluation;
mod machine;
mod manifest;
mod markdown_table;
mod marks;
mod masks;
mod metrics;
mod opencv;
mod python_environment;
mod results_page;
mod score;
mod score_tables;
mod sha256;
mod sparsification;
mod table_1;
mod textured;
mod visible;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// The project's own tasks.
///
/// Exit codes: 0 done, 1 failed, 2 called in a wrong way.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask")]
struct Tasks {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    EvalMiddlebury(eval_middlebury::Options),
    #[command(name = "compare-opencv")]
    CompareOpencv(compare_opencv::Options),
}

fn main() -> ExitCode {
    let Tasks { task } = Tasks::parse();
    let done = match task {
        Task::EvalMiddlebury(options) => eval_middlebury::run(&options),
        Task::CompareOpencv(options) => compare_opencv::run(&options),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("error: {error:#}");
            ExitCode::FAILURE
        }
    }
}

#[cfg(test)]
mod tests {
    use clap::CommandFactory;

    use super::*;

    #[test]
    fn the_command_line_holds_together() {
        Tasks::command().debug_assert();
    }
}
