//! `dorsal live`: frames from standard input, looked at as they come; an interruption leaves whole files.
mod command;

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::process::{Child, Command, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// One eye's picture.
const WIDTH: usize = 96;
const HEIGHT: usize = 72;

/// A frame whose halves show one texture 4 px apart.
fn frame(number: usize) -> Vec<u8> {
    let wave = |x: f32, y: f32| {
        (0.9 * x + 0.4 * y).sin() + (0.21 * x).sin() + (0.13 * y).cos() + (0.5 * x - 0.7 * y).cos()
    };
    let mut bytes = Vec::with_capacity(2 * WIDTH * HEIGHT);
    for y in 0..HEIGHT {
        for shift in [0.0, 4.0] {
            bytes.extend((0..WIDTH).map(|x| {
                let x = x as f32 + shift + 0.5 * number as f32;
                (127.0 + 30.0 * wave(x, y as f32)).round() as u8
            }));
        }
    }
    bytes
}

/// The header and so many frames of a Y4M stream.
fn y4m(frames: usize) -> Vec<u8> {
    let mut bytes = format!(
        "YUV4MPEG2 W{} H{HEIGHT} F30:1 Ip A1:1 C420jpeg\n",
        2 * WIDTH
    )
    .into_bytes();
    for number in 0..frames {
        bytes.extend(b"FRAME\n");
        bytes.extend(frame(number));
        bytes.extend(vec![128; WIDTH * HEIGHT]);
    }
    bytes
}

fn live(arguments: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_dorsal"))
        .arg("live")
        .args(arguments)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command runs")
}

/// Gives a stream to the command, to its end.
fn looked(arguments: &[&str], stream: &[u8]) -> (Option<i32>, Vec<Value>, String) {
    let mut child = live(arguments);
    let mut input = child.stdin.take().expect("a pipe");
    let bytes = stream.to_owned();
    let writer = std::thread::spawn(move || {
        // A command that refuses its stream closes the pipe.
        let _ = input.write_all(&bytes);
    });
    let said = child.wait_with_output().expect("it ends");
    writer.join().expect("it was written");
    let out = String::from_utf8(said.stdout).expect("it speaks UTF-8");
    let lines = out
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"));
    (
        said.status.code(),
        lines.collect(),
        String::from_utf8(said.stderr).expect("it speaks UTF-8"),
    )
}

#[test]
fn every_frame_is_looked_at_if_that_is_asked() {
    let (code, lines, err) = looked(&["--every-frame"], &y4m(4));
    assert_eq!(code, Some(0), "{err}");
    assert_eq!(lines.len(), 4, "{err}");
    for (number, line) in (1u64..).zip(&lines) {
        assert_eq!(line["look"], number);
        let d = line["median_disparity_px"].as_f64().expect("a disparity");
        // Eight bits of grey cost less than a tenth of a pixel.
        assert!((d - 4.0).abs() < 0.1, "{line}");
    }
    assert!(err.contains("4 looks, 0 frames dropped"), "{err}");

    let grey: Vec<u8> = (0..2).flat_map(frame).collect();
    let size = format!("{}x{HEIGHT}", 2 * WIDTH);
    let (code, lines, err) = looked(
        &["--format", "gray", "--size", &size, "--every-frame"],
        &grey,
    );
    assert_eq!((code, lines.len()), (Some(0), 2), "{err}");
}

#[test]
fn what_comes_too_fast_is_dropped_and_counted() {
    let (code, lines, err) = looked(&[], &y4m(60));
    assert_eq!(code, Some(0), "{err}");
    let dropped = lines.last().expect("a look")["dropped"]
        .as_u64()
        .expect("a count");
    assert_eq!(lines.len() as u64 + dropped, 60, "{err}");
    assert!(
        err.contains(&format!("{} looks, {dropped} frames dropped", lines.len())),
        "{err}"
    );
}

#[test]
fn what_is_no_stream_is_refused() {
    let whole = y4m(2);
    let cases: [(&[&str], &[u8], &str); 3] = [
        (&[], b"RIFF and so on\n", "YUV4MPEG2"),
        (&[], b"", "YUV4MPEG2"),
        (
            &["--every-frame"],
            &whole[..whole.len() - 7],
            "in the middle of frame 2",
        ),
    ];
    for (arguments, stream, words) in cases {
        let (code, _, err) = looked(arguments, stream);
        assert_eq!(code, Some(1), "{words}: {err}");
        assert!(err.contains(words), "{words}: {err}");
    }
    for arguments in [
        &["--format", "gray"][..],
        &["--size", "12"],
        &["--format", "gray", "--size", "95x10"],
        &["--looks", "0"],
    ] {
        assert_eq!(looked(arguments, b"").0, Some(2), "{arguments:?}");
    }
}

#[test]
fn an_interruption_leaves_everything_whole() {
    let folder = TempDir::new().expect("a folder");
    let path = |name: &str| {
        folder
            .path()
            .join(name)
            .to_str()
            .expect("a name")
            .to_owned()
    };
    let (log, out) = (path("live.mcap"), path("looks"));
    let mut child = live(&["--mcap", &log, "--jsonl", "-", "--out", &out]);
    let mut input = child.stdin.take().expect("a pipe");
    let header = y4m(0);
    let writer = std::thread::spawn(move || {
        let mut number = 0;
        let mut next = header;
        // Frames come for as long as anyone reads them, as from a camera.
        while input.write_all(&next).is_ok() {
            next = [
                b"FRAME\n".to_vec(),
                frame(number),
                vec![128; WIDTH * HEIGHT],
            ]
            .concat();
            number += 1;
        }
    });
    let mut said = BufReader::new(child.stdout.take().expect("a pipe"));
    let mut acknowledged = String::new();
    for _ in 0..3 {
        said.read_line(&mut acknowledged).expect("a line");
    }
    let kill = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(kill.expect("kill runs").success());
    said.read_to_string(&mut acknowledged)
        .expect("the other lines");
    let ended = child.wait_with_output().expect("it ends");
    assert_eq!(
        ended.status.code(),
        Some(0),
        "{}",
        String::from_utf8_lossy(&ended.stderr)
    );
    writer.join().expect("the stream was closed");

    let looks = acknowledged.lines().count();
    for line in acknowledged.lines() {
        let _: Value = serde_json::from_str(line).expect("a whole line");
    }
    assert!(looks >= 3);
    let bytes = fs::read(&log).expect("the log has its name");
    let summary = mcap::Summary::read(&bytes)
        .expect("MCAP")
        .expect("a summary");
    let counts = summary.stats.expect("statistics").channel_message_counts;
    let left = summary
        .channels
        .values()
        .find(|channel| channel.topic == "/left/image");
    assert_eq!(counts[&left.expect("a channel").id], looks as u64);
    assert!(
        folder
            .path()
            .join(format!("looks/{looks:06}/index.html"))
            .is_file()
    );
    assert!(!folder.path().join("live.mcap.part").exists());
}
