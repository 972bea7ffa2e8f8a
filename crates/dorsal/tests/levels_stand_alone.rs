//! Each level is a crate of its own: a program outside the workspace that depends on one level by
//! path, and on nothing else of the project, builds and runs.
use std::path::{Path, PathBuf};
use std::process::Command;

/// Builds and runs a program that depends on `level` and on `others` from the registry.
fn build_alone(level: &str, others: &str, program: &str) {
    let workspace = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let scratch = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let home = scratch.join(format!("alone-{level}"));
    std::fs::create_dir_all(home.join("src")).expect("the target folder can be written");
    let path = workspace.join("crates").join(level);
    // The same profiles too: they stand at the end of the workspace's manifest.
    let manifest = std::fs::read_to_string(workspace.join("Cargo.toml")).expect("a manifest");
    let profiles = &manifest[manifest
        .find("[profile")
        .expect("the workspace sets profiles")..];
    let manifest = format!(
        "[package]\nname = \"alone-{level}\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n\
         [dependencies]\n{level} = {{ path = {path:?} }}\n{others}\n\n[workspace]\n\n{profiles}"
    );
    std::fs::write(home.join("Cargo.toml"), manifest).expect("the manifest can be written");
    std::fs::write(home.join("src/main.rs"), program).expect("the program can be written");
    // The same versions as here, so that nothing is fetched and little is built again.
    std::fs::copy(workspace.join("Cargo.lock"), home.join("Cargo.lock")).expect("a lock file");
    let mut cargo = Command::new(env!("CARGO"));
    cargo.args(["run", "--offline", "--quiet", "--manifest-path"]);
    cargo
        .arg(home.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(scratch.join(".."));
    if !cfg!(debug_assertions) {
        cargo.arg("--release");
    }
    let output = cargo.output().expect("cargo can be started");
    let stderr = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success(),
        "{level} does not stand alone:\n{stderr}"
    );
    assert!(
        !output.stdout.is_empty(),
        "the program on {level} printed nothing"
    );
}

#[test]
fn v1_gabor() {
    build_alone(
        "v1-gabor",
        "ndarray = \"0.17\"",
        include_str!("alone/v1_gabor.rs"),
    );
}

#[test]
fn disparity_pyramid() {
    let others = "ndarray = \"0.17\"";
    build_alone(
        "disparity-pyramid",
        others,
        include_str!("alone/disparity_pyramid.rs"),
    );
}

#[test]
fn egocentric_depth() {
    build_alone(
        "egocentric-depth",
        "",
        include_str!("alone/egocentric_depth.rs"),
    );
}

#[test]
fn allocentric_qsr() {
    build_alone(
        "allocentric-qsr",
        "",
        include_str!("alone/allocentric_qsr.rs"),
    );
}
