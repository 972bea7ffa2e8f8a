//! The project's own tasks, run as `cargo xtask TASK`.

// The project's tasks talk to people.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    reason = "a command line prints its results and its errors"
)]

mod ablation;
mod alteration;
mod altered_truth;
mod bank_pictures;
mod bench;
mod bounds;
mod calculus_pictures;
mod calculus_results;
mod calibrate_confidence;
mod calibration_run;
mod camera_noise;
mod check_soundness;
mod clocked;
mod compare_opencv;
mod comparison;
mod confidence_run;
mod continuous;
mod counting_allocator;
mod curve_svg;
mod data_folder;
mod dataflow;
mod date;
mod dense_results_page;
mod dense_robustness_marks;
mod dense_robustness_page;
mod dense_robustness_run;
mod depth_run;
mod docs_folder;
mod download;
mod error_picture;
mod estimator;
mod eval_calibration;
mod eval_dense_robustness;
mod eval_depth;
mod eval_flow;
mod eval_middlebury;
mod eval_robustness;
mod eval_rooms;
mod eval_scan;
mod eval_segment;
mod eval_vergent;
mod evaluation;
mod export_gqr;
mod flow_errors;
mod flow_page;
mod flow_run;
mod homography;
mod label_sheet;
mod lot;
mod machine;
mod manifest;
mod markdown_table;
mod marks;
mod masks;
mod metrics;
mod opencv;
mod opencv_clock;
mod opencv_peer;
mod phase_statistics;
mod point_errors;
mod population_pictures;
mod pyramid_ablation;
mod pyramid_ablation_run;
mod python_environment;
mod resample;
mod results_page;
mod rig_signs;
mod robustness_marks;
mod robustness_page;
mod robustness_run;
mod robustness_series;
mod room_run;
mod scan_in_results;
mod scan_run;
mod score;
mod score_tables;
mod segment_run;
mod sha256;
mod soak_looks;
mod soak_memory;
mod sparsification;
mod table_1;
mod table_1_page;
mod table_1_row;
mod table_1_run;
mod textured;
mod textured_marks;
mod vergent_run;
mod visible;
mod wheel;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

/// The bench tells what its contestants ask of it.
#[global_allocator]
static ALLOCATOR: counting_allocator::CountingAllocator = counting_allocator::CountingAllocator;

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
    BankPictures(bank_pictures::Options),
    Bench(bench::Options),
    #[command(hide = true)]
    BenchFrames(bench::frames::Options),
    EvalCalibration(eval_calibration::Options),
    EvalDenseRobustness(eval_dense_robustness::Options),
    EvalDepth(eval_depth::Options),
    EvalFlow(eval_flow::Options),
    EvalMiddlebury(eval_middlebury::Options),
    CheckSoundness(check_soundness::Options),
    SoakLooks(soak_looks::Options),
    SoakMemory(soak_memory::Options),
    ExportGqr(export_gqr::Options),
    CalibrateConfidence(calibrate_confidence::Options),
    CalculusPictures(calculus_pictures::Options),
    CalculusResults(calculus_results::Options),
    #[command(name = "compare-opencv")]
    CompareOpencv(compare_opencv::Options),
    EvalRobustness(eval_robustness::Options),
    EvalRooms(eval_rooms::Options),
    EvalSegment(eval_segment::Options),
    EvalScan(eval_scan::Options),
    EvalVergent(eval_vergent::Options),
    PopulationPictures(population_pictures::Options),
    Wheel(wheel::Options),
    Dataflow(dataflow::Options),
}

fn main() -> ExitCode {
    let Tasks { task } = Tasks::parse();
    let done = match task {
        Task::Bench(options) => bench::run(&options),
        Task::BenchFrames(options) => bench::frames::run(&options),
        Task::BankPictures(options) => bank_pictures::run(&options),
        Task::EvalCalibration(options) => eval_calibration::run(&options),
        Task::EvalDenseRobustness(options) => eval_dense_robustness::run(&options),
        Task::EvalDepth(options) => eval_depth::run(&options),
        Task::EvalFlow(options) => eval_flow::run(&options),
        Task::EvalMiddlebury(options) => eval_middlebury::run(&options),
        Task::CheckSoundness(options) => check_soundness::run(&options),
        Task::SoakLooks(options) => soak_looks::run(&options),
        Task::SoakMemory(options) => soak_memory::run(&options),
        Task::ExportGqr(options) => export_gqr::run(&options),
        Task::CalibrateConfidence(options) => calibrate_confidence::run(&options),
        Task::CalculusPictures(options) => calculus_pictures::run(&options),
        Task::CalculusResults(options) => calculus_results::run(&options),
        Task::CompareOpencv(options) => compare_opencv::run(&options),
        Task::EvalRobustness(options) => eval_robustness::run(&options),
        Task::EvalRooms(options) => eval_rooms::run(&options),
        Task::EvalSegment(options) => eval_segment::run(&options),
        Task::EvalScan(options) => eval_scan::run(&options),
        Task::EvalVergent(options) => eval_vergent::run(&options),
        Task::PopulationPictures(options) => population_pictures::run(&options),
        Task::Wheel(options) => wheel::run_task(&options),
        Task::Dataflow(options) => dataflow::run_task(&options),
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
