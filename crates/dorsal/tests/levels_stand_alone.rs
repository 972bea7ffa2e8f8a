//! Each level is a crate of its own: a program outside this workspace that depends on one level by
//! path, and on nothing else of the project, builds and runs.
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A level, what its program needs from the registry, and the program.
const PROGRAMS: [(&str, &str, &str); 4] = [
    (
        "v1-gabor",
        "ndarray = \"0.17\"",
        include_str!("alone/v1_gabor.rs"),
    ),
    (
        "disparity-pyramid",
        "ndarray = \"0.17\"",
        include_str!("alone/disparity_pyramid.rs"),
    ),
    (
        "egocentric-depth",
        "",
        include_str!("alone/egocentric_depth.rs"),
    ),
    (
        "allocentric-qsr",
        "",
        include_str!("alone/allocentric_qsr.rs"),
    ),
];

#[test]
fn a_program_on_one_level_builds_and_runs() {
    let project = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let scratch = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("alone");
    for (level, others, program) in PROGRAMS {
        let home = scratch.join(level);
        let path = project.join("crates").join(level);
        write(
            &home.join("Cargo.toml"),
            &format!(
                "[package]\nname = \"alone-on-{level}\"\nversion = \"0.0.0\"\nedition = \"2024\"\n\n\
                 [dependencies]\n{level} = {{ path = {path:?} }}\n{others}\n"
            ),
        );
        write(&home.join("src/main.rs"), program);
    }
    // Four programs in one build, so that what they share is built once, and without optimisation,
    // so that it is built soon.
    write(
        &scratch.join("Cargo.toml"),
        "[workspace]\nresolver = \"3\"\nmembers = [\"*-*\"]\n\n[profile.dev]\ndebug = false\n",
    );
    // The versions of the project itself: nothing is fetched that its own build has not fetched.
    let lock = fs::read(project.join("Cargo.lock")).expect("the project has a lock file");
    fs::write(scratch.join("Cargo.lock"), lock).expect("the target folder can be written");

    let mut build = Command::new(env!("CARGO"));
    build.args(["build", "--offline", "--quiet", "--manifest-path"]);
    build
        .arg(scratch.join("Cargo.toml"))
        .arg("--target-dir")
        .arg(scratch.join("target"));
    let built = build.output().expect("cargo can be started");
    let stderr = String::from_utf8_lossy(&built.stderr);
    assert!(
        built.status.success(),
        "a level does not stand alone:\n{stderr}"
    );

    for (level, ..) in PROGRAMS {
        let program = scratch
            .join("target/debug")
            .join(format!("alone-on-{level}"));
        let ran = Command::new(program)
            .output()
            .expect("the program was built");
        assert!(ran.status.success(), "the program on {level} failed");
        assert!(
            !ran.stdout.is_empty(),
            "the program on {level} printed nothing"
        );
    }
}

fn write(path: &Path, text: &str) {
    let folder = path.parent().expect("a file lies in a folder");
    fs::create_dir_all(folder).expect("the target folder can be written");
    fs::write(path, text).expect("the target folder can be written");
}
