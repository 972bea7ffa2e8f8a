//! A folder with a memory in it, and looks to be remembered.
#![allow(dead_code, reason = "each test file uses a part of it")]

use std::fs;
use std::path::PathBuf;

use serde_json::json;
use tempfile::TempDir;

use crate::command::{Said, dorsal};

/// A desk, as its memory's folder.
pub(crate) struct Desk {
    folder: TempDir,
}

impl Desk {
    /// A desk with an empty memory.
    pub(crate) fn new() -> Self {
        let desk = Self::without_memory();
        assert_eq!(desk.memory(&["init"]).code, Some(0));
        desk
    }

    pub(crate) fn without_memory() -> Self {
        Self {
            folder: tempfile::tempdir().expect("a folder"),
        }
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// The bytes of the memory.
    pub(crate) fn bytes(&self) -> String {
        fs::read_to_string(self.path("memory.json")).expect("a memory")
    }

    /// Runs `dorsal memory` on the memory of the desk; a word that begins with `@` is the name of a
    /// file of the folder.
    pub(crate) fn memory(&self, words: &[&str]) -> Said {
        let named = |word: &&str| {
            let name = word.strip_prefix('@');
            name.map_or_else(|| PathBuf::from(word), |name| self.path(name))
        };
        dorsal(
            ["memory", "--memory", "@memory.json"]
                .iter()
                .chain(words)
                .map(named),
        )
    }

    /// Writes a `scene.json` with these objects, `(name, right, ahead)` in metres, 30 cm below the
    /// eyes.
    pub(crate) fn scene(&self, name: &str, objects: &[(&str, f64, f64)]) {
        let objects = objects.iter().map(|&(name, x, z): &(&str, f64, f64)| {
            json!({
                "name": name, "position_m": [x, 0.3, z],
                "distance_m": x.hypot(z), "distance_sigma_m": 0.01,
                "bearing_rad": z.atan2(x), "bearing_sigma_rad": 0.005, "radius_m": 0.04,
            })
        });
        let scene = json!({
            "schema": "dorsal-scene/1",
            "objects": objects.collect::<Vec<_>>(),
        });
        fs::write(self.path(name), scene.to_string()).expect("a scene");
    }

    /// Remembers a box, a screen to its right and a cup to its left, seen in two looks.
    pub(crate) fn seen(&self) {
        let objects = [
            ("cd_box", -0.10, 0.80),
            ("pc_screen", 0.32, 0.80),
            ("cup", -0.60, 0.90),
        ];
        self.scene("scene.json", &objects);
        for time in ["1000", "2000"] {
            let said = self.memory(&["add", "@scene.json", "--time", time]);
            assert_eq!(said.code, Some(0), "{}", said.err);
        }
    }
}
