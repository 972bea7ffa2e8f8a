//! A Python with the packages that a test needs, if this machine has one.
#![allow(
    dead_code,
    clippy::print_stderr,
    reason = "each test file uses a part of it, and one that cannot be run says so"
)]

use std::process::Command;

/// A Python that imports these packages: the one that `DORSAL_PYTHON` names, or `python3`. Without one the
/// test says that it was not run, and what it needs.
pub(crate) fn with(packages: &str) -> Option<String> {
    let python = std::env::var("DORSAL_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let tried = Command::new(&python)
        .args(["-c", &format!("import {packages}")])
        .output();
    if tried.is_ok_and(|tried| tried.status.success()) {
        return Some(python);
    }
    eprintln!(
        "NOT TESTED: {python} has not all of: {packages}; install them (pip install mcap \
         mcap-protobuf-support rosbags numpy) and name the Python with DORSAL_PYTHON"
    );
    None
}
