use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, ensure};

/// Instructions by the function that they stand in, what was inlined counting for where it went.
pub(super) type Instructions = BTreeMap<String, u64>;

/// Whether valgrind is there.
pub(super) fn is_there() -> bool {
    let asked = Command::new("valgrind")
        .arg("--version")
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    asked.is_ok_and(|status| status.success())
}

/// The instructions of a frame of this contestant before the scene in a folder, when everything is
/// planned: those of four frames less those of two, halved.
pub(super) fn of_a_frame(name: &str, scene: &Path) -> anyhow::Result<Instructions> {
    let (two, four) = (of_frames(name, scene, 2)?, of_frames(name, scene, 4)?);
    let of_one = four.into_iter().map(|(function, instructions)| {
        let before = two.get(&function).copied().unwrap_or(0);
        (function, instructions.saturating_sub(before) / 2)
    });
    Ok(of_one
        .filter(|(_, instructions)| *instructions > 0)
        .collect())
}

/// Those of a whole process that runs so many frames.
fn of_frames(name: &str, scene: &Path, frames: u16) -> anyhow::Result<Instructions> {
    let own = std::env::current_exe().context("this program does not know its place")?;
    let out = scene.join("callgrind.out");
    let mut valgrind = Command::new("valgrind");
    valgrind
        .args(["--tool=callgrind", "--quiet"])
        .arg(format!("--callgrind-out-file={}", out.display()))
        .arg(own)
        .args(["bench-frames", name])
        .arg("--scene")
        .arg(scene)
        .args(["--frames", &frames.to_string()]);
    let status = valgrind.status().context("valgrind cannot be started")?;
    ensure!(status.success(), "valgrind failed on {name}; see above");
    let text = std::fs::read_to_string(&out)
        .with_context(|| format!("{} cannot be read", out.display()))?;
    parse(&text).with_context(|| format!("valgrind wrote no instructions of {name}"))
}

/// Reads the instructions of each function itself, without those it calls.
///
/// A line `fn=(ID) NAME` begins a function, the name being given the first time only; lines of a place and a
/// number are its instructions; the one after a line `calls=` belongs to what is called. `None` if there are none.
fn parse(text: &str) -> Option<Instructions> {
    let mut names: BTreeMap<&str, &str> = BTreeMap::new();
    let mut found = Instructions::new();
    let (mut function, mut is_call) = ("", false);
    for line in text.lines() {
        let named = ["fn=", "cfn="]
            .iter()
            .find_map(|key| line.strip_prefix(key));
        if let Some(named) = named {
            let (id, name) = named.split_once(' ').unwrap_or((named, ""));
            if !name.is_empty() {
                names.insert(id, name);
            }
            if line.starts_with("fn=") {
                function = id;
            }
        } else if line.starts_with("calls=") {
            is_call = true;
        } else if line.starts_with(|first: char| first.is_ascii_digit() || "+-*".contains(first)) {
            let cost = line
                .split(' ')
                .nth(1)
                .and_then(|cost| cost.parse::<u64>().ok());
            if let (Some(cost), false) = (cost, is_call) {
                *found.entry(function.to_owned()).or_default() += cost;
            }
            is_call = false;
        }
    }
    let mut by_name = Instructions::new();
    for (id, instructions) in found {
        let name = names.get(id.as_str()).copied().unwrap_or("unknown");
        *by_name.entry(name.to_owned()).or_default() += instructions;
    }
    (!by_name.is_empty()).then_some(by_name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_instructions_are_read_and_those_of_calls_are_not() {
        let text = "events: Ir\nfl=(1) a.rs\nfn=(1) main\n16 400\ncfn=(2) filter\ncalls=3 20\n\
                    16 9000\n+1 5\n\nfn=(2)\n20 8000\n* 1000\n\ntotals: 9405\n";
        let found = parse(text).unwrap();
        assert_eq!(found["main"], 405);
        assert_eq!(found["filter"], 9000);
        assert!(parse("events: Ir\n").is_none());
    }
}
