use std::fs::{self, File, OpenOptions};
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use allocentric_qsr::{BadMemoryParams, DepthReference, MemoryParams};

use crate::shared_record::BadSharedMap;
use crate::{Receipt, Report, SharedMap};

/// How many reports at the least go into one journal before the map is written as a snapshot and a new journal begun.
const REPORTS_TO_SNAPSHOT: u64 = 10_000;

/// And how many of each robot in the mean: a snapshot takes the longer the more robots there are, and reports wait for
/// it, so that it must not come the more often too. At 10 Hz this is one in ten seconds.
const REPORTS_A_ROBOT: u64 = 100;

/// What the acknowledged outlives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Durability {
    /// The end of the process, by SIGKILL too: a report is handed to the operating system before it is acknowledged.
    #[default]
    Process,
    /// The end of the machine too: a report is on the disk before it is acknowledged ([`File::sync_data`]), which
    /// costs a disk's flush each time.
    Machine,
}

/// A shared map kept in a folder: what it has acknowledged outlives the process.
///
/// The folder holds `snapshot-N.json`, the map as it was when journal N began (none for the first), and
/// `journal-N.jsonl`, each report since, one a line, in the order they were taken. A snapshot is written beside the
/// old one, flushed to the disk and renamed, and only then are older files removed: whatever moment the process ends
/// at, the newest snapshot and its journal are the map. A last line without its end was never acknowledged; it
/// is cut off.
///
/// One process at a time may hold a folder; the file `lock` is locked while it does.
#[derive(Debug)]
pub struct Journal {
    folder: PathBuf,
    durability: Durability,
    map: SharedMap,
    generation: u64,
    lines: File,
    /// Up to where the journal holds whole lines.
    bytes: u64,
    reports: u64,
    _lock: File,
}

/// Why a folder gives no map, or takes no report.
#[derive(Debug, thiserror::Error)]
pub enum BadJournal {
    /// A file cannot be read or written.
    #[error("{0}: {1}")]
    File(PathBuf, #[source] io::Error),
    /// Another process holds the folder.
    #[error("{0} is held by another process; one map process writes a folder")]
    Held(PathBuf),
    /// The snapshot is no map.
    #[error("{0}: {1}")]
    Snapshot(PathBuf, #[source] BadSharedMap),
    /// A line of the journal is no report.
    #[error("{0}, line {1}: {2}")]
    Line(PathBuf, usize, String),
    /// The snapshot was made with another reference system or other parameters.
    #[error(
        "{0} was made with another distance system or other parameters; name those, or another folder"
    )]
    Params(PathBuf),
    /// The parameters cannot be.
    #[error(transparent)]
    BadParams(#[from] BadMemoryParams),
}

impl Journal {
    /// Opens the map of a folder, which is made if it is not there, by reading the newest snapshot and replaying its
    /// journal.
    ///
    /// # Errors
    /// [`BadJournal`] says which file is wrong and how; nothing is removed then.
    pub fn open(
        folder: &Path,
        reference: &DepthReference,
        params: MemoryParams,
        durability: Durability,
    ) -> Result<Self, BadJournal> {
        let at = |path: &Path| {
            let path = path.to_owned();
            move |error| BadJournal::File(path, error)
        };
        fs::create_dir_all(folder).map_err(at(folder))?;
        let lock_path = folder.join("lock");
        let lock = File::create(&lock_path).map_err(at(&lock_path))?;
        lock.try_lock()
            .map_err(|_| BadJournal::Held(folder.to_owned()))?;
        let generation = newest(folder).map_err(at(folder))?;
        let mut map = SharedMap::new(reference, params)?;
        if generation > 0 {
            let path = snapshot(folder, generation);
            let text = fs::read_to_string(&path).map_err(at(&path))?;
            let read = SharedMap::from_json(&text)
                .map_err(|error| BadJournal::Snapshot(path.clone(), error))?;
            if read.reference != *reference || read.params != params {
                return Err(BadJournal::Params(path));
            }
            map = read;
        }
        let path = journal(folder, generation);
        let mut options = OpenOptions::new();
        let options = options.create(true).read(true).append(true);
        let lines = options.open(&path).map_err(at(&path))?;
        let text = fs::read(&path).map_err(at(&path))?;
        let whole = text.iter().rposition(|byte| *byte == b'\n');
        let bytes = whole.map_or(0, |last| last + 1);
        let mut reports = 0;
        for line in text[..bytes].split_inclusive(|byte| *byte == b'\n') {
            reports += 1;
            let report: Report = serde_json::from_slice(line).map_err(|error| {
                BadJournal::Line(path.clone(), reports as usize, error.to_string())
            })?;
            map.take(&report);
        }
        lines.set_len(bytes as u64).map_err(at(&path))?;
        let opened = Self {
            folder: folder.to_owned(),
            durability,
            map,
            generation,
            lines,
            bytes: bytes as u64,
            reports,
            _lock: lock,
        };
        opened.sync_folder()?;
        opened.remove_older()?;
        Ok(opened)
    }

    /// The map.
    #[must_use]
    pub const fn map(&self) -> &SharedMap {
        &self.map
    }

    /// Writes a report down and takes it in; what the receipt says has happened for good, in the sense of the
    /// [`Durability`].
    ///
    /// # Errors
    /// [`BadJournal::File`] if it cannot be written: then it is not in the map, and no receipt says so.
    pub fn take(&mut self, report: &Report) -> Result<Receipt, BadJournal> {
        let mut receipts = self.take_all(std::slice::from_ref(report))?;
        Ok(receipts.remove(0))
    }

    /// As [`Journal::take`], several at once, with one write and one flush for all.
    ///
    /// # Errors
    /// As [`Journal::take`]; none of them is in the map then.
    ///
    /// # Panics
    /// Never: a report has a form in JSON.
    pub fn take_all(&mut self, reports: &[Report]) -> Result<Vec<Receipt>, BadJournal> {
        let mut lines = Vec::new();
        for report in reports {
            serde_json::to_writer(&mut lines, report).expect("a report has a form in JSON");
            lines.push(b'\n');
        }
        let written = self.lines.write_all(&lines).and_then(|()| self.flush());
        if let Err(error) = written {
            let path = journal(&self.folder, self.generation);
            // A part of a line must not stand before the next one.
            let cut = self.lines.set_len(self.bytes);
            return Err(BadJournal::File(path, cut.err().unwrap_or(error)));
        }
        self.bytes += lines.len() as u64;
        self.reports += reports.len() as u64;
        let receipts = reports.iter().map(|report| self.map.take(report)).collect();
        let robots = self.map.robots().count() as u64;
        if self.reports >= REPORTS_TO_SNAPSHOT.max(REPORTS_A_ROBOT * robots) {
            self.snapshot()?;
        }
        Ok(receipts)
    }

    /// Writes the map as a snapshot and begins a new journal.
    ///
    /// # Errors
    /// [`BadJournal::File`] if it cannot be written; the old snapshot and its journal stand then, and go on.
    pub fn snapshot(&mut self) -> Result<(), BadJournal> {
        let next = self.generation + 1;
        let (path, lines_path) = (snapshot(&self.folder, next), journal(&self.folder, next));
        let beside = self.folder.join("snapshot.part");
        let at = |path: &Path| {
            let path = path.to_owned();
            move |error| BadJournal::File(path, error)
        };
        // The journal first: once the snapshot bears its name, the journal beside it is the one that is read.
        let lines = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&lines_path)
            .map_err(at(&lines_path))?;
        lines.set_len(0).map_err(at(&lines_path))?;
        let mut file = File::create(&beside).map_err(at(&beside))?;
        file.write_all(self.map.to_json().as_bytes())
            .and_then(|()| file.write_all(b"\n"))
            .and_then(|()| file.sync_all())
            .map_err(at(&beside))?;
        fs::rename(&beside, &path).map_err(at(&path))?;
        self.generation = next;
        self.lines = lines;
        self.bytes = 0;
        self.reports = 0;
        self.sync_folder()?;
        self.remove_older()
    }

    fn flush(&self) -> io::Result<()> {
        match self.durability {
            Durability::Process => Ok(()),
            Durability::Machine => self.lines.sync_data(),
        }
    }

    /// Puts the names of the folder's files on the disk: a file that is flushed and whose name is not is lost with
    /// the machine.
    fn sync_folder(&self) -> Result<(), BadJournal> {
        // Only a folder of a Unix system opens as a file.
        if cfg!(unix) {
            let synced = File::open(&self.folder).and_then(|folder| folder.sync_all());
            synced.map_err(|error| BadJournal::File(self.folder.clone(), error))?;
        }
        Ok(())
    }

    fn remove_older(&self) -> Result<(), BadJournal> {
        let failed = |error| BadJournal::File(self.folder.clone(), error);
        for entry in fs::read_dir(&self.folder).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if generation_of(&path).is_some_and(|generation| generation < self.generation) {
                fs::remove_file(&path).map_err(|error| BadJournal::File(path, error))?;
            }
        }
        Ok(())
    }
}

fn snapshot(folder: &Path, generation: u64) -> PathBuf {
    folder.join(format!("snapshot-{generation}.json"))
}

fn journal(folder: &Path, generation: u64) -> PathBuf {
    folder.join(format!("journal-{generation}.jsonl"))
}

/// The generation of the newest snapshot, 0 if there is none.
fn newest(folder: &Path) -> io::Result<u64> {
    let mut newest = 0;
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.extension().is_some_and(|end| end == "json") {
            newest = newest.max(generation_of(&path).unwrap_or(0));
        }
    }
    Ok(newest)
}

/// The generation in the name of a snapshot or a journal.
fn generation_of(path: &Path) -> Option<u64> {
    let name = path.file_name()?.to_str()?;
    let number = name
        .strip_prefix("snapshot-")
        .and_then(|rest| rest.strip_suffix(".json"));
    let number = number.or_else(|| name.strip_prefix("journal-")?.strip_suffix(".jsonl"));
    number?.parse().ok()
}
