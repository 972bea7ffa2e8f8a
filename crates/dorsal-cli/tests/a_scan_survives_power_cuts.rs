//! A scan that is killed at any moment loses no look that it has acknowledged, and leaves no file that
//! cannot be read.
mod command;
mod small_room;

use std::fs;
use std::io::{BufRead as _, BufReader};
use std::process::{Command, Stdio};
use std::time::Duration;

use dorsal::allocentric_qsr::SceneMemory;
use small_room::SmallRoom;

/// How many power cuts. A hundred were taken once by hand; the suite takes a few.
const CUTS: u64 = 6;

#[test]
fn nothing_acknowledged_is_lost() {
    let room = SmallRoom::new();
    let memory = room.path("memory.json");
    let arguments = room.scan(&[
        "--fixations",
        "200",
        "--still",
        "--memory",
        memory.to_str().expect("a name"),
    ]);
    let cuts = std::env::var("DORSAL_POWER_CUTS").ok();
    let cuts = cuts.and_then(|cuts| cuts.parse().ok()).unwrap_or(CUTS);
    let mut looks = 0;
    for cut in 0..cuts {
        let mut child = Command::new(env!("CARGO_BIN_EXE_dorsal"))
            .args(&arguments)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("the command runs");
        let out = BufReader::new(child.stdout.take().expect("a pipe"));
        // A look that the memory refused says so in its line, and changes nothing.
        let is_kept = |line: &String| line.starts_with("look") && !line.contains("not remembered");
        let mut lines = out.lines().map_while(Result::ok);
        let mut acknowledged = 0;
        // The cut comes some time after the first line or the second.
        let wanted = 1 + cut % 2;
        while acknowledged < wanted {
            let line = lines.next().expect("the scan goes on");
            acknowledged += u64::from(is_kept(&line));
        }
        std::thread::sleep(Duration::from_millis(cut * 7919 % 263));
        child.kill().expect("it is killed");
        child.wait().expect("it has ended");
        // What was said before the end counts as acknowledged too.
        acknowledged += lines.filter(is_kept).count() as u64;
        let text = fs::read_to_string(&memory).expect("the memory is there");
        let kept = SceneMemory::from_json(&text).expect("it can be read");
        assert!(
            kept.looks() >= looks + acknowledged,
            "cut {cut}: {} looks kept, {looks} and {acknowledged} acknowledged",
            kept.looks()
        );
        assert!(!room.path("out/index.html").exists(), "no half a result");
        looks = kept.looks();
        assert!(!room.path("out/index.html").exists(), "no half a result");
    }
}
