//! Files that are missing, broken or of the wrong size end with exit code 1, and are named.
mod command;

use std::fs;

use command::{Pair, Said, dorsal};
use dorsal::egocentric_depth::LabelImage;
use dorsal::v1_gabor::LumaImage;
use ndarray::Array2;
use stereo_formats::{label_png, picture};

#[track_caller]
fn failed(said: &Said, helpful: &[&str]) {
    assert_eq!(said.code, Some(1), "{}", said.err);
    assert_eq!(said.out, "");
    for word in helpful {
        assert!(said.err.contains(word), "no '{word}' in: {}", said.err);
    }
}

#[test]
fn a_missing_picture() {
    let pair = Pair::new();
    fs::remove_file(pair.path("right.png")).expect("removed");
    failed(&pair.look(&[]), &["right.png", "cannot be opened"]);
    assert!(!pair.path("out").exists());
}

#[test]
fn a_truncated_picture() {
    let pair = Pair::new();
    let bytes = fs::read(pair.path("left.png")).expect("a picture");
    fs::write(pair.path("left.png"), &bytes[..bytes.len() / 2]).expect("half a picture");
    failed(&pair.look(&[]), &["left.png"]);
}

#[test]
fn pictures_of_two_sizes() {
    let pair = Pair::new();
    let small = LumaImage::new(Array2::zeros((20, 30))).expect("an image");
    picture::write_luma(pair.path("right.png"), &small).expect("a PNG");
    failed(&pair.look(&[]), &["right.png", "30 x 20", "160 x 120"]);
}

#[test]
fn labels_of_another_size() {
    let pair = Pair::new();
    let labels = LabelImage::new(Array2::ones((20, 30)));
    label_png::write(pair.path("labels.png"), &labels).expect("a PNG");
    let said = pair.look(&["--rig", "@rig.toml", "--labels", "@labels.png"]);
    failed(&said, &["labels.png", "30 x 20", "160 x 120"]);
}

#[test]
fn names_that_name_nothing() {
    let pair = Pair::new();
    let labels = LabelImage::new(Array2::ones((120, 160)));
    label_png::write(pair.path("labels.png"), &labels).expect("a PNG");
    fs::write(pair.path("names.toml"), "[names]\n2 = \"cup\"\n").expect("names");
    let said = pair.look(&[
        "--rig",
        "@rig.toml",
        "--labels",
        "@labels.png",
        "--names",
        "@names.toml",
    ]);
    failed(&said, &["names.toml", "'cup'"]);
}

#[test]
fn a_rig_that_is_none() {
    let pair = Pair::new();
    fs::write(pair.path("rig.toml"), "baseline_m = -1\n").expect("a file");
    failed(&pair.look(&["--rig", "@rig.toml"]), &["rig.toml"]);
}

#[test]
fn a_system_that_is_none() {
    let pair = Pair::new();
    failed(
        &pair.look(&["--system", "drs3"]),
        &["drs3", "drs1, drs2, robot-150, robot-120"],
    );
}

#[test]
fn a_folder_that_cannot_be() {
    let pair = Pair::new();
    fs::write(pair.path("out"), "a file stands here").expect("a file");
    failed(&pair.look(&[]), &["out", "is a file"]);
    assert_eq!(
        fs::read_to_string(pair.path("out")).expect("the file"),
        "a file stands here"
    );
}

/// A folder in the place of one of the results refuses it, whoever runs the test.
#[test]
fn a_result_that_cannot_be_written() {
    let pair = Pair::new();
    fs::create_dir_all(pair.path("out/disparity.pfm/inside")).expect("folders");
    failed(&pair.look(&[]), &["disparity.pfm", "cannot be written"]);
    assert!(pair.path("out/disparity.pfm/inside").exists());
}

#[test]
fn what_stands_in_the_folder_outlives_a_failure() {
    let pair = Pair::new();
    fs::create_dir(pair.path("out")).expect("a folder");
    fs::write(pair.path("out/disparity.pfm"), "mine").expect("a file");
    fs::write(pair.path("left.png"), "no picture").expect("a file");
    failed(&pair.look(&[]), &["left.png"]);
    assert_eq!(
        fs::read_to_string(pair.path("out/disparity.pfm")).expect("the file"),
        "mine"
    );
}

#[test]
fn the_demo_needs_a_folder_too() {
    let pair = Pair::new();
    fs::write(pair.path("out"), "").expect("a file");
    let said = dorsal([
        "demo".as_ref(),
        "--out".as_ref(),
        pair.path("out").as_os_str(),
    ]);
    failed(&said, &["is a file"]);
}
