//! `dorsal look` on many pairs: one that fails stops no other, and a batch that is killed at any moment goes
//! on where it was, with no half a folder under a pair's name.
mod command;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, SystemTime};

use command::{Pair, Said, dorsal};
use serde_json::Value;
use tempfile::TempDir;

/// How many power cuts. A hundred were taken once by hand; the suite takes a few.
const CUTS: u64 = 6;

struct Pairs {
    folder: TempDir,
}

impl Pairs {
    /// A folder with so many pairs of pictures in left/ and right/.
    fn new(pairs: usize) -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let pair = Pair::new();
        for side in ["left", "right"] {
            let inner = folder.path().join("pairs").join(side);
            fs::create_dir_all(&inner).expect("a folder");
            for number in 0..pairs {
                let from = pair.path(&format!("{side}.png"));
                fs::copy(from, inner.join(format!("{number:02}.png"))).expect("a picture");
            }
        }
        Self { folder }
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    fn arguments(&self) -> [PathBuf; 4] {
        [
            "look".into(),
            self.path("pairs"),
            "--out".into(),
            self.path("out"),
        ]
    }

    fn look(&self, further: &[&str]) -> Said {
        dorsal(
            self.arguments()
                .into_iter()
                .chain(further.iter().map(PathBuf::from)),
        )
    }

    /// The finished pairs, each with the time at which its record was written.
    fn finished(&self) -> Vec<(String, SystemTime)> {
        let Ok(entries) = fs::read_dir(self.path("out")) else {
            return Vec::new();
        };
        let mut found = Vec::new();
        for entry in entries {
            let path = entry.expect("an entry").path();
            let name = path
                .file_name()
                .expect("a name")
                .to_string_lossy()
                .into_owned();
            if path.is_dir() && !name.starts_with('.') {
                let written = fs::metadata(path.join("look.json")).and_then(|file| file.modified());
                is_whole(&path);
                found.push((name, written.expect("a record")));
            }
        }
        found.sort();
        found
    }
}

/// Every file that the record names is there and can be read.
fn is_whole(folder: &Path) {
    let text = fs::read(folder.join("look.json")).expect("a record");
    let look: Value = serde_json::from_slice(&text).expect("JSON");
    for name in look["files"].as_array().expect("files") {
        let path = folder.join(name.as_str().expect("a name"));
        let length = fs::metadata(&path).map(|file| file.len());
        assert!(length.is_ok_and(|length| length > 0), "{}", path.display());
    }
    stereo_formats::pfm::read(folder.join("disparity.pfm")).expect("a disparity");
}

#[test]
fn nothing_finished_is_lost() {
    let pairs = Pairs::new(12);
    let cuts = std::env::var("DORSAL_POWER_CUTS").ok();
    let cuts = cuts.and_then(|cuts| cuts.parse().ok()).unwrap_or(CUTS);
    for cut in 0..cuts {
        let mut before = pairs.finished();
        if before.len() == 12 {
            // A long test begins anew.
            fs::remove_dir_all(pairs.path("out")).expect("it goes");
            before.clear();
        }
        let mut child = Command::new(env!("CARGO_BIN_EXE_dorsal"))
            .args(pairs.arguments())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the command runs");
        std::thread::sleep(Duration::from_millis(20 + cut * 7919 % 163));
        child.kill().expect("it is killed");
        child.wait().expect("it has ended");
        let after = pairs.finished();
        for finished in &before {
            assert!(
                after.contains(finished),
                "cut {cut}: {finished:?} is as it was"
            );
        }
    }
    let before = pairs.finished();
    let said = pairs.look(&[]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let words = format!(
        "12 pairs: {} done, {} kept, 0 failed",
        12 - before.len(),
        before.len()
    );
    assert!(said.out.contains(&words), "{words}: {}", said.out);
    let after = pairs.finished();
    assert_eq!(after.len(), 12);
    assert!(before.iter().all(|finished| after.contains(finished)));
    let summary = fs::read_to_string(pairs.path("out/summary.json")).expect("a summary");
    let summary: Value = serde_json::from_str(&summary).expect("JSON");
    assert_eq!(summary["pairs"].as_array().map(Vec::len), Some(12));
    let page = fs::read_to_string(pairs.path("out/index.html")).expect("a page");
    assert!(page.contains("<a href=\"07/index.html\">07</a>"));
}

#[test]
fn one_that_fails_stops_no_other() {
    let pairs = Pairs::new(3);
    fs::write(pairs.path("pairs/right/01.png"), "no picture").expect("a file");
    let said = pairs.look(&[]);
    assert_eq!(said.code, Some(1));
    assert!(
        said.out.contains("3 pairs: 2 done, 0 kept, 1 failed"),
        "{}",
        said.out
    );
    let failures = said
        .out
        .split("failures:")
        .nth(1)
        .expect("a list of failures");
    assert!(
        failures.contains("01: ") && failures.contains("right/01.png"),
        "{failures}"
    );
    assert!(said.err.contains("1 of 3 pairs failed"), "{}", said.err);
    assert!(!pairs.path("out/01").exists());

    // What was wrong is mended; the others are kept.
    fs::copy(
        pairs.path("pairs/right/00.png"),
        pairs.path("pairs/right/01.png"),
    )
    .expect("a picture");
    let said = pairs.look(&[]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(
        said.out.contains("3 pairs: 1 done, 2 kept, 0 failed"),
        "{}",
        said.out
    );

    // Other options do not mix with what is there.
    let said = pairs.look(&["--published"]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("other options"), "{}", said.err);
    let said = pairs.look(&["--published", "--again"]);
    assert!(
        said.out.contains("3 pairs: 3 done, 0 kept, 0 failed"),
        "{}",
        said.out
    );
}

#[test]
fn a_list_names_its_pairs() {
    let pairs = Pairs::new(2);
    let list = pairs.path("list.txt");
    fs::write(
        &list,
        "# two\npairs/left/00.png pairs/right/00.png first\npairs/left/01.png pairs/right/01.png\n",
    )
    .expect("a list");
    let out = pairs.path("listed");
    let said = dorsal([
        "look".as_ref(),
        list.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(out.join("first/disparity.pfm").is_file());
    assert!(out.join("0002_01/disparity.pfm").is_file());

    fs::write(&list, "alone.png\n").expect("a list");
    let said = dorsal([
        "look".as_ref(),
        list.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("line 1 has 1 words"), "{}", said.err);
    let single = pairs.path("pairs/left/00.png");
    let said = dorsal([
        "look".as_ref(),
        single.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("needs the right eye's"), "{}", said.err);
}
