//! The `dorsal` command: depth and relations from an image pair.
//!
//! The levels do the work; here are the people's side of it: arguments, files, pictures, clocks.
mod arguments;
mod bag;
mod bag_arguments;
mod base64;
mod batch;
mod batch_page;
mod calibrate;
mod calibrate_arguments;
mod completions;
mod compose;
mod compose_arguments;
mod console;
mod demo;
mod demo_arguments;
mod demo_scan;
mod demo_scene;
mod drift_record;
mod facts;
mod flow;
mod flow_arguments;
mod flow_record;
mod interruption;
mod label_picture;
mod live;
mod live_arguments;
mod look;
mod look_arguments;
mod look_files;
mod look_options;
mod look_record;
mod look_room;
mod look_stream;
mod memory;
mod memory_add;
mod memory_arguments;
mod memory_changes;
mod memory_file;
mod memory_show;
mod memory_watch;
mod motorcycle;
mod network;
mod network_arguments;
mod object_table;
mod objects;
mod outputs;
mod pair_list;
mod plan;
mod pose_argument;
mod reference_system;
mod relation_table;
mod report;
mod rig;
mod rig_arguments;
mod rig_file;
mod room;
mod scan_arguments;
mod scan_record;
mod scan_step;
mod scene_file;
mod scene_record;
mod searched;
mod segment_record;
mod sight;
mod sight_log;
mod stream_arguments;
mod tables;
mod tables_arguments;
mod text_table;
mod threads;
mod times;
mod true_object;
mod v1;
mod v1_arguments;
mod v1_files;
mod v1_record;
mod verdict;
mod wrong_call;

use std::io::{self, Write as _};
use std::process::ExitCode;

use crate::arguments::{Arguments, Command};
use crate::wrong_call::WrongCall;

fn main() -> ExitCode {
    let arguments = Arguments::of_process();
    let mut out = io::stdout().lock();
    let done = match &arguments.command {
        Command::Look(look) => look::look(look, &mut out),
        Command::Bag(arguments) => bag::bag(arguments, &mut out),
        Command::Live(arguments) => live::live(arguments, &mut out),
        Command::Calibrate(arguments) => calibrate::calibrate(arguments, &mut out),
        Command::Demo(demo) => demo::demo(demo, &mut out),
        Command::Flow(arguments) => flow::flow(arguments, &mut out),
        Command::Rig(arguments) => rig::rig(arguments, &mut out),
        Command::V1(arguments) => v1::v1(arguments, &mut out),
        Command::Tables(tables) => tables::tables(tables, &mut out),
        Command::Compose(compose) => compose::compose(compose, &mut out),
        Command::Network(network) => network::network(network, &mut out),
        Command::Memory(memory) => memory::memory(memory, &mut out),
        Command::Completions(arguments) => completions::completions(arguments, &mut out),
        Command::Man(arguments) => completions::man(arguments, &mut out),
    }
    .and_then(|()| Ok(out.flush()?));
    match done {
        Err(error) if !is_broken_pipe(&error) => {
            // If standard error is closed too, the exit code still says it.
            let _ = writeln!(io::stderr(), "dorsal: {error:#}");
            if error.is::<WrongCall>() {
                ExitCode::from(2)
            } else {
                ExitCode::FAILURE
            }
        }
        _ => ExitCode::SUCCESS,
    }
}

/// Whether whoever reads standard output has had enough, as `head` has: no failure of ours.
fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error
        .downcast_ref::<io::Error>()
        .is_some_and(|error| error.kind() == io::ErrorKind::BrokenPipe)
}
