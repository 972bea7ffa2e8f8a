//! Every block of commands in docs/tutorial.md, run in its order in one folder.
#![allow(clippy::print_stderr, reason = "a test that cannot be run says so")]

use std::fs;
use std::path::Path;
use std::process::Command;

/// A block of commands, where it begins, and what it needs beside this command.
struct Block {
    line: usize,
    needs: Option<String>,
    commands: String,
}

fn blocks(text: &str) -> Vec<Block> {
    let mut found = Vec::new();
    let mut open: Option<Block> = None;
    for (number, line) in (1..).zip(text.lines()) {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(kind)) if kind.starts_with("sh") => {
                let needs = kind.strip_prefix("sh needs ").map(str::to_owned);
                open = Some(Block {
                    line: number,
                    needs,
                    commands: String::new(),
                });
            }
            (Some(_), Some(_)) => found.extend(open.take()),
            (Some(block), None) => {
                block.commands.push_str(line);
                block.commands.push('\n');
            }
            (None, _) => {}
        }
    }
    found
}

#[test]
fn every_command_does_what_is_said() {
    let house = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = fs::read_to_string(house.join("docs/tutorial.md")).expect("the tutorial");
    let folder = tempfile::tempdir().expect("a folder");
    fs::copy(
        house.join("fixtures/bags/pair.mcap"),
        folder.path().join("walk.mcap"),
    )
    .expect("a recording");
    let command = Path::new(env!("CARGO_BIN_EXE_dorsal"));
    let path = std::env::var("PATH").unwrap_or_default();
    let path = format!("{}:{path}", command.parent().expect("a folder").display());
    let blocks = blocks(&text);
    assert!(
        blocks.len() >= 10,
        "only {} blocks were found",
        blocks.len()
    );
    for block in &blocks {
        if let Some(needs) = &block.needs
            && Command::new(needs).arg("-version").output().is_err()
        {
            eprintln!(
                "NOT TESTED: docs/tutorial.md line {} needs {needs}",
                block.line
            );
            continue;
        }
        let said = Command::new("sh")
            .args(["-e", "-c", &block.commands])
            .current_dir(folder.path())
            .env("PATH", &path)
            .output()
            .expect("a shell");
        assert!(
            said.status.success(),
            "line {}:\n{}\n{}{}",
            block.line,
            block.commands,
            String::from_utf8_lossy(&said.stdout),
            String::from_utf8_lossy(&said.stderr)
        );
    }
    // What the text points at is there.
    for name in [
        "out/motorcycle/index.html",
        "scan/index.html",
        "first/validity.png",
        "mine/depth.png",
        "mine/cloud.ply",
        "objects/labels.png",
        "looks/index.html",
        "looks.mcap",
        "looks.jsonl",
        "man1/dorsal.1",
    ] {
        assert!(folder.path().join(name).is_file(), "{name}");
    }
}
