//! What a folder keeps: everything acknowledged, wherever the process ended.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use std::fs;
use std::path::Path;

use allocentric_qsr::DepthReference;
use common_ground::{BadJournal, Durability, Journal, Report, SharedMap, shared_params};

fn open_for(folder: &Path, durability: Durability) -> Result<Journal, BadJournal> {
    let reference = DepthReference::robot_120();
    Journal::open(folder, &reference, shared_params(), durability)
}

fn open(folder: &Path) -> Result<Journal, BadJournal> {
    open_for(folder, Durability::Process)
}

fn report(robot: &str, seq: u64) -> Report {
    let text = format!(
        r#"{{"robot": "{robot}", "run": 7, "seq": {seq}, "line": {{"look": {{"time_ms": {seq},
        "pose": {{"x_m": 0, "z_m": 0, "heading_rad": 0}}, "view": null, "seen": [
        {{"object": "cup {seq}", "distance_m": 0.7, "bearing_rad": 1.5,
        "sigma_distance_m": 0.01, "sigma_bearing_rad": 0.005}}]}}}}}}"#
    );
    serde_json::from_str(&text).unwrap()
}

/// The map of the first reports, taken without a folder.
fn map_of(reports: &[Report]) -> SharedMap {
    let mut map = SharedMap::new(&DepthReference::robot_120(), shared_params()).unwrap();
    for report in reports {
        map.take(report);
    }
    map
}

/// The journal cut at any byte opens as the map of the whole lines before the cut, and goes on from there.
#[test]
fn a_journal_cut_anywhere_keeps_every_whole_line() {
    let folder = tempfile::tempdir().unwrap();
    let pairs = (1..4).flat_map(|seq| [report("a", seq), report("b", seq)]);
    let reports: Vec<Report> = pairs.collect();
    let mut journal = open(folder.path()).unwrap();
    for one in &reports {
        assert!(journal.take(one).unwrap().is_taken());
    }
    drop(journal);
    let path = folder.path().join("journal-0.jsonl");
    let whole = fs::read(&path).unwrap();
    for cut in 0..=whole.len() {
        fs::write(&path, &whole[..cut]).unwrap();
        let lines = whole[..cut].iter().filter(|byte| **byte == b'\n').count();
        let mut journal = open(folder.path()).unwrap();
        assert_eq!(*journal.map(), map_of(&reports[..lines]), "cut at {cut}");
        // The robots send again what was not acknowledged; what was is not taken twice.
        journal.take_all(&reports).unwrap();
        assert_eq!(*journal.map(), map_of(&reports));
    }
}

#[test]
fn a_snapshot_at_any_moment_keeps_the_map() {
    let folder = tempfile::tempdir().unwrap();
    let reports: Vec<Report> = (1..6).map(|seq| report("a", seq)).collect();
    let mut journal = open(folder.path()).unwrap();
    for (k, one) in reports.iter().enumerate() {
        journal.take(one).unwrap();
        journal.snapshot().unwrap();
        assert_eq!(*journal.map(), map_of(&reports[..=k]));
    }
    drop(journal);
    // A snapshot that was not finished, an older journal that was not removed, and the next one begun too early.
    fs::write(folder.path().join("snapshot.part"), "half of a sn").unwrap();
    fs::write(folder.path().join("journal-1.jsonl"), "older\n").unwrap();
    fs::write(folder.path().join("journal-6.jsonl"), "").unwrap();
    let journal = open(folder.path()).unwrap();
    assert_eq!(*journal.map(), map_of(&reports));
    assert!(!folder.path().join("journal-1.jsonl").exists());
}

#[test]
fn what_is_wrong_is_named_and_nothing_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let mut journal = open(folder.path()).unwrap();
    journal.take(&report("a", 1)).unwrap();
    assert!(matches!(open(folder.path()), Err(BadJournal::Held(_))));
    journal.snapshot().unwrap();
    journal.take(&report("a", 2)).unwrap();
    drop(journal);
    let drs1 = DepthReference::drs1();
    let other = Journal::open(folder.path(), &drs1, shared_params(), Durability::Process);
    assert!(matches!(other, Err(BadJournal::Params(_))));
    let path = folder.path().join("journal-1.jsonl");
    let text = fs::read_to_string(&path).unwrap() + "this is no report\n";
    fs::write(&path, &text).unwrap();
    let wrong = open(folder.path()).unwrap_err().to_string();
    assert!(wrong.contains("line 2"), "{wrong}");
    assert_eq!(fs::read_to_string(&path).unwrap(), text);
    let snapshot = folder.path().join("snapshot-1.json");
    fs::write(&snapshot, "{").unwrap();
    assert!(matches!(open(folder.path()), Err(BadJournal::Snapshot(..))));
    assert!(path.exists() && snapshot.exists());
}

#[test]
fn on_the_disk_it_is_the_same_map() {
    let folder = tempfile::tempdir().unwrap();
    let mut journal = open_for(folder.path(), Durability::Machine).unwrap();
    journal.take(&report("a", 1)).unwrap();
    drop(journal);
    assert_eq!(
        *open(folder.path()).unwrap().map(),
        map_of(&[report("a", 1)])
    );
}
