use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};

use anyhow::{Context, ensure};

/// Instructions by function; what was inlined counts for where it went.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Instructions {
    /// Those of a function itself.
    pub(super) own: BTreeMap<String, u64>,
    /// With those of all that it calls. Too many of one that calls itself.
    pub(super) with_calls: BTreeMap<String, u64>,
}

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
/// planned: those of two frames less those of one.
pub(super) fn of_a_frame(name: &str, scene: &Path) -> anyhow::Result<Instructions> {
    let (one, two) = (of_frames(name, scene, 1)?, of_frames(name, scene, 2)?);
    Ok(Instructions {
        own: less(two.own, &one.own),
        with_calls: less(two.with_calls, &one.with_calls),
    })
}

/// What is left of each.
fn less(of: BTreeMap<String, u64>, taken: &BTreeMap<String, u64>) -> BTreeMap<String, u64> {
    let rest = of.into_iter().map(|(function, instructions)| {
        let taken = taken.get(&function).copied().unwrap_or(0);
        (function, instructions.saturating_sub(taken))
    });
    rest.filter(|(_, instructions)| *instructions > 0).collect()
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

/// Reads the instructions of each function.
///
/// A line `fn=(ID) NAME` begins a function, the name being given the first time only; lines of a place and a
/// number are its instructions; the one after a line `calls=` is what the function of the line `cfn=` took
/// with all that it calls. `None` if there are none.
fn parse(text: &str) -> Option<Instructions> {
    let mut names: BTreeMap<&str, &str> = BTreeMap::new();
    let (mut own, mut called) = (BTreeMap::new(), BTreeMap::new());
    let (mut function, mut callee, mut is_call) = ("", "", false);
    for line in text.lines() {
        if let Some((key @ ("fn" | "cfn"), named)) = line.split_once('=') {
            let (id, name) = named.split_once(' ').unwrap_or((named, ""));
            if !name.is_empty() {
                names.insert(id, name);
            }
            *(if key == "fn" {
                &mut function
            } else {
                &mut callee
            }) = id;
        } else if line.starts_with("calls=") {
            is_call = true;
        } else if line.starts_with(|first: char| first.is_ascii_digit() || "+-*".contains(first)) {
            let cost = line.split(' ').nth(1).and_then(|cost| cost.parse().ok());
            let cost: u64 = cost.unwrap_or(0);
            if is_call {
                *called.entry(callee).or_default() += cost;
            } else {
                *own.entry(function).or_default() += cost;
            }
            is_call = false;
        }
    }
    // A name may stand in several files, under several numbers.
    let by_name = |by_id: BTreeMap<&str, u64>| {
        let mut by_name = BTreeMap::new();
        for (id, instructions) in by_id {
            let name = names.get(id).copied().unwrap_or("unknown");
            *by_name.entry(name.to_owned()).or_default() += instructions;
        }
        by_name
    };
    (!own.is_empty()).then(|| Instructions {
        own: by_name(own),
        with_calls: by_name(called),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn own_instructions_are_read_and_those_of_calls_are_not() {
        let text = "events: Ir\nfl=(1) a.rs\nfn=(1) main\n16 400\ncfn=(2) filter\ncalls=3 20\n\
                    16 9000\n+1 5\n\nfn=(2)\n20 8000\n* 1000\n\ntotals: 9405\n";
        let found = parse(text).unwrap();
        assert_eq!((found.own["main"], found.own["filter"]), (405, 9000));
        assert_eq!(found.with_calls["filter"], 9000);
        assert!(parse("events: Ir\n").is_none());
    }
}
