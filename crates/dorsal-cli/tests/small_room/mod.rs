//! The built-in room of the scan with pictures so small that a look takes no time.
#![allow(dead_code, reason = "each test file uses a part of it")]

use std::fs;
use std::path::PathBuf;

use tempfile::TempDir;

/// A folder with `room.toml`.
pub(crate) struct SmallRoom {
    folder: TempDir,
}

impl SmallRoom {
    pub(crate) fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let text = include_str!("../../../stereo-scenes/rooms/scan.toml");
        let small = text.replace("size_px = [640, 480]", "size_px = [160, 120]");
        assert_ne!(text, small, "the room says how large its pictures are");
        fs::write(folder.path().join("room.toml"), small).expect("a file");
        Self { folder }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The arguments of a scan of this room.
    pub(crate) fn scan(&self, more: &[&str]) -> Vec<String> {
        let path = |name| self.path(name).display().to_string();
        let mut all = vec!["demo".to_owned(), "scan".to_owned(), "--quiet".to_owned()];
        all.extend(["--room".to_owned(), path("room.toml")]);
        all.extend(["--out".to_owned(), path("out")]);
        all.extend(more.iter().map(|&word| word.to_owned()));
        all
    }
}
