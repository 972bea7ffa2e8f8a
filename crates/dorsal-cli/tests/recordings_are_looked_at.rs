//! `dorsal bag`: a recording that the independent package rosbags has written is paired, looked at and
//! written; what is wrong with a recording is said with its place.
mod command;
mod python;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use command::{Said, dorsal};
use serde_json::Value;

fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/bags")
}

fn bag(file: &Path, topics: [&str; 2], further: &[&str]) -> Said {
    let file = file.to_str().expect("a name");
    let fixed = ["bag", file, "--left", topics[0], "--right", topics[1]];
    dorsal(fixed.iter().chain(further))
}

const MONO: [&str; 2] = ["/left/image_raw", "/right/image_raw"];
const CAMERAS: [&str; 3] = ["--info", "/left/camera_info", "/right/camera_info"];

fn lines(text: &str) -> Vec<Value> {
    let lines = text.lines();
    lines
        .map(|line| serde_json::from_str(line).expect("a line of JSON"))
        .collect()
}

/// The wall is 1.2 m away, at 4 px.
fn sees_the_wall(line: &Value) {
    let near = |name: &str, wanted: f64, by: f64| {
        let value = line[name].as_f64().expect("a number");
        assert!((value - wanted).abs() < by, "{name} is {value}: {line}");
    };
    // The texture is a sum of waves, which the phase finds to a hundredth of a pixel.
    near("median_disparity_px", 4.0, 0.02);
    near("median_depth_m", 1.2, 0.006);
    assert!(line["density"].as_f64() > Some(0.8), "{line}");
}

#[test]
fn pairs_are_those_that_both_eyes_took() {
    let said = bag(&fixtures().join("pair.mcap"), MONO, &[]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    // Frame 2 has no right picture and frame 4 no left one; the cameras lie beside the pictures.
    let lines = lines(&said.out);
    let times: Vec<u64> = lines
        .iter()
        .filter_map(|line| line["time_ns"].as_u64())
        .collect();
    let start = 1_700_000_000_000_000_000;
    assert_eq!(times, [0, 1, 3, 5].map(|frame| start + frame * 100_000_000));
    lines.iter().for_each(sees_the_wall);
    assert_eq!(lines[3]["dropped"], 2);
    assert!(
        said.err
            .contains("4 pairs, 4 looks; 1 left and 1 right without a partner"),
        "{}",
        said.err
    );

    // Right stamps come up to 2 ms late: a tolerance of half a millisecond leaves two pairs.
    let said = bag(&fixtures().join("pair.mcap"), MONO, &["--tolerance", "0.5"]);
    assert_eq!(said.out.lines().count(), 2, "{}", said.err);
    let said = bag(&fixtures().join("pair.mcap"), MONO, &["--every", "3"]);
    assert_eq!(said.out.lines().count(), 2, "{}", said.err);
    let said = bag(&fixtures().join("pair.mcap"), MONO, &["--looks", "1"]);
    assert_eq!((said.code, said.out.lines().count()), (Some(0), 1));
}

#[test]
fn every_encoding_shows_the_same_wall() {
    for topics in [
        ["/rgb/left", "/rgb/right"],
        ["/deep/left", "/deep/right"],
        ["/png/left", "/png/right"],
    ] {
        let said = bag(&fixtures().join("pair.mcap"), topics, &CAMERAS);
        assert_eq!(said.code, Some(0), "{topics:?}: {}", said.err);
        let lines = lines(&said.out);
        assert_eq!(lines.len(), 1);
        sees_the_wall(&lines[0]);
    }
}

#[test]
fn the_outputs_are_those_of_a_look() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("looks");
    let file = |name: &str| {
        folder
            .path()
            .join(name)
            .to_str()
            .expect("a name")
            .to_owned()
    };
    let (mcap, jsonl) = (file("log.mcap"), file("looks.jsonl"));
    let out_text = out.to_str().expect("a name");
    let into = [
        "--mcap", &mcap, "--jsonl", &jsonl, "--out", out_text, "--quiet",
    ];
    let said = bag(&fixtures().join("pair.mcap"), MONO, &into);
    assert_eq!((said.code, &*said.out, &*said.err), (Some(0), "", ""));
    assert_eq!(lines(&fs::read_to_string(&jsonl).expect("lines")).len(), 4);
    for look in ["000001", "000004"] {
        for name in ["disparity.pfm", "depth.pfm", "look.json", "index.html"] {
            assert!(out.join(look).join(name).is_file(), "{look}/{name}");
        }
    }
    let log = fs::read(&mcap).expect("a log");
    let summary = mcap::Summary::read(&log).expect("MCAP").expect("a summary");
    let statistics = summary.stats.expect("statistics");
    let count = |topic: &str| {
        let channel = summary
            .channels
            .values()
            .find(|channel| channel.topic == topic);
        channel.map_or(0, |channel| statistics.channel_message_counts[&channel.id])
    };
    for topic in [
        "/left/image",
        "/right/camera_info",
        "/depth",
        "/points",
        "/scene",
    ] {
        assert_eq!(count(topic), 4, "{topic}");
    }
    assert!(!Path::new(&format!("{mcap}.part")).exists());
}

#[test]
fn what_is_wrong_is_said() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    let whole = fs::read(fixtures().join("pair.mcap")).expect("the fixture");

    // A recording that was cut off gives what came before.
    fs::write(path("cut.mcap"), &whole[..whole.len() * 4 / 5]).expect("a file");
    let jsonl = path("cut.jsonl");
    let said = bag(
        &path("cut.mcap"),
        MONO,
        &["--jsonl", jsonl.to_str().expect("a name")],
    );
    assert_eq!(said.code, Some(1));
    assert!(
        said.err.contains("the recording was cut off"),
        "{}",
        said.err
    );
    assert!(!lines(&fs::read_to_string(jsonl).expect("lines")).is_empty());

    let mut damaged = whole.clone();
    // The length of the first record, by its highest byte.
    damaged[16] = 0xff;
    fs::write(path("damaged.mcap"), damaged).expect("a file");
    fs::write(path("text.mcap"), "no bag").expect("a file");
    let good = fixtures().join("pair.mcap");
    let cases: [(&Path, [&str; 2], &[&str], &str); 8] = [
        (
            &path("damaged.mcap"),
            MONO,
            &[],
            "it is damaged before byte",
        ),
        (&path("text.mcap"), MONO, &[], "it is no MCAP file"),
        (&path("none.mcap"), MONO, &[], "cannot be opened"),
        (
            folder.path(),
            MONO,
            &[],
            "is a folder; give the .mcap file in it",
        ),
        (
            &good,
            ["/left/image", "/right/image_raw"],
            &[],
            "no message on /left/image; its topics are /bayer/left",
        ),
        (
            &good,
            MONO,
            &["--info", "/left/camera", "/right/camera_info"],
            "has no camera on /left/camera",
        ),
        (
            &good,
            ["/bayer/left", "/bayer/right"],
            &[],
            "its encoding is bayer_rggb8, and read are mono8",
        ),
        (
            &good,
            ["/left/camera_info", "/right/camera_info"],
            &[],
            "it is a sensor_msgs/msg/CameraInfo",
        ),
    ];
    for (file, topics, further, words) in cases {
        let said = bag(file, topics, further);
        assert_eq!(said.code, Some(1), "{words}: {}", said.err);
        assert!(said.err.contains(words), "{words}: {}", said.err);
        assert_eq!(said.out, "", "{words}");
    }
    for (topics, further) in [
        (MONO, &["--tolerance", "-1"][..]),
        (["/left/image_raw"; 2], &[]),
    ] {
        assert_eq!(bag(&good, topics, further).code, Some(2), "{topics:?}");
    }
}

#[test]
fn a_recording_that_rosbags_writes_now_is_read() {
    let Some(python) = python::with("rosbags.rosbag2, numpy") else {
        return;
    };
    let folder = tempfile::tempdir().expect("a folder");
    let fresh = folder.path().join("fresh.mcap");
    let made = Command::new(python)
        .arg(fixtures().join("make_bag.py"))
        .arg(&fresh)
        .output()
        .expect("Python runs");
    assert!(
        made.status.success(),
        "{}",
        String::from_utf8_lossy(&made.stderr)
    );
    let said = bag(&fresh, MONO, &[]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert_eq!(lines(&said.out).len(), 4);
}
