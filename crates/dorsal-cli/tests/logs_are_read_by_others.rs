//! A log of a look is read by the independent Python package mcap, message by message.
mod command;
mod python;

use std::fs;
use std::process::Command;

use command::Pair;

/// Decodes every message and says what matters of it.
const READ: &str = r#"
import json, sys, struct
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory
said = {}
with open(sys.argv[1], "rb") as log:
    for schema, channel, message, decoded in make_reader(log, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
        assert message.log_time == 0
        said.setdefault(channel.topic, []).append((schema.name, decoded))
kinds = {topic: messages[0][0] for topic, messages in said.items()}
depth = said["/depth"][0][1]
metres = struct.unpack(f"<{depth.width * depth.height}f", depth.data)
known = sorted(m for m in metres if m == m)
points = said["/points"][0][1]
camera = said["/left/camera_info"][0][1]
frames = {m.child_frame_id: (m.parent_frame_id, m.translation.x) for _, m in said["/tf"]}
print(json.dumps({
    "kinds": kinds, "size": [depth.width, depth.height], "encoding": depth.encoding,
    "median_m": known[len(known) // 2], "known": len(known),
    "points": len(points.data) // points.point_stride, "fields": [f.name for f in points.fields],
    "focal": camera.K[0], "frames": frames, "png": said["/right/image"][0][1].data[:4].hex(),
}))
"#;

fn logged() -> (Pair, std::path::PathBuf) {
    let pair = Pair::new();
    let said = pair.look(&["--rig", "@rig.toml", "--mcap", "@look.mcap"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let log = pair.path("look.mcap");
    (pair, log)
}

#[test]
fn python_reads_a_look() {
    let (_pair, log) = logged();
    let Some(python) = python::with("mcap.reader, mcap_protobuf.decoder") else {
        return;
    };
    let read = Command::new(python).args(["-c", READ]).arg(&log).output();
    let read = read.expect("Python runs");
    assert!(
        read.status.success(),
        "{}",
        String::from_utf8_lossy(&read.stderr)
    );
    let said: serde_json::Value = serde_json::from_slice(&read.stdout).expect("JSON");
    assert_eq!(said["kinds"]["/left/image"], "foxglove.CompressedImage");
    assert_eq!(said["kinds"]["/points"], "foxglove.PointCloud");
    assert_eq!(said["kinds"]["/scene"], "foxglove.SceneUpdate");
    assert_eq!(
        said["size"],
        serde_json::json!([command::WIDTH, command::HEIGHT])
    );
    assert_eq!(said["encoding"], "32FC1");
    let median_m = said["median_m"].as_f64().expect("metres");
    assert!((median_m - 2.0).abs() < 0.02, "{said}");
    assert_eq!(said["known"], said["points"]);
    assert_eq!(said["focal"], 120.0);
    assert_eq!(
        said["frames"]["left_eye"],
        serde_json::json!(["observer", -0.05])
    );
    assert_eq!(said["frames"]["observer"][0], "world");
    assert_eq!(said["png"], "89504e47");
}

#[test]
fn a_log_is_whole_and_its_own_crate_reads_it() {
    let (_pair, log) = logged();
    let bytes = fs::read(log).expect("a log");
    let messages: Vec<mcap::Message<'_>> = mcap::MessageStream::new(&bytes)
        .expect("MCAP")
        .collect::<Result<_, _>>()
        .expect("whole messages");
    let count = |topic: &str| messages.iter().filter(|m| m.channel.topic == topic).count();
    for topic in [
        "/left/image",
        "/right/image",
        "/left/camera_info",
        "/right/camera_info",
        "/depth",
        "/points",
        "/scene",
    ] {
        assert_eq!(count(topic), 1, "{topic}");
    }
    assert_eq!(count("/tf"), 3);
    for message in &messages {
        let schema = message.channel.schema.as_ref().expect("a schema");
        assert_eq!(schema.encoding, "protobuf");
        assert!(schema.name.starts_with("foxglove."), "{}", schema.name);
    }
}

#[test]
fn a_log_that_cannot_be_written_is_a_failure() {
    let pair = Pair::new();
    let said = pair.look(&["--mcap", "@no/such/folder/look.mcap"]);
    assert_eq!(said.code, Some(1));
    assert!(
        said.err.contains("look.mcap cannot be written"),
        "{}",
        said.err
    );
}
