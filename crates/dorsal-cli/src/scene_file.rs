use std::fs;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, ensure};
use dorsal::allocentric_qsr::{ObjectId, Observation, Sighting};
use serde::Deserialize;

/// What a memory takes from a `scene.json`: the objects with their places; the relations it works
/// out again.
#[derive(Debug, Deserialize)]
pub(crate) struct SceneFile {
    schema: String,
    objects: Vec<SeenObject>,
}

/// An object of a scene, in the observer frame.
#[derive(Debug, Deserialize)]
struct SeenObject {
    name: ObjectId,
    /// Right, down, forward.
    position_m: [f64; 3],
    distance_m: f64,
    distance_sigma_m: f64,
    bearing_rad: f64,
    bearing_sigma_rad: f64,
    /// Scenes of an earlier version do not say; a point then.
    #[serde(default)]
    radius_m: f64,
}

impl SceneFile {
    /// Where the scene is: a file, or the one of this name in a folder.
    pub(crate) fn path(given: &Path) -> PathBuf {
        if given.is_dir() {
            given.join("scene.json")
        } else {
            given.to_owned()
        }
    }

    /// Reads a scene.
    pub(crate) fn read(path: &Path) -> anyhow::Result<Self> {
        let text = fs::read_to_string(path).with_context(|| {
            format!(
                "{} cannot be read; a look with --rig and --labels writes a scene.json",
                path.display()
            )
        })?;
        let scene: Self = serde_json::from_str(&text)
            .with_context(|| format!("{} is no scene.json of `dorsal look`", path.display()))?;
        ensure!(
            scene.schema == "dorsal-scene/1",
            "{} has schema `{}`; this command reads `dorsal-scene/1`",
            path.display(),
            scene.schema
        );
        Ok(scene)
    }

    /// The objects as sightings; the ground lies so far below the eyes.
    pub(crate) fn observations(self, eyes_above_ground_m: f64) -> Vec<Observation> {
        let observation = |object: SeenObject| Observation {
            // The casts saturate, and what is no number becomes zero: neither is a reason.
            radius_mm: (object.radius_m * 1e3).round() as u32,
            height_mm: ((eyes_above_ground_m - object.position_m[1]) * 1e3).round() as i32,
            sighting: Sighting {
                object: object.name,
                distance_m: object.distance_m,
                bearing_rad: object.bearing_rad,
                sigma_distance_m: object.distance_sigma_m,
                sigma_bearing_rad: object.bearing_sigma_rad,
            },
        };
        self.objects.into_iter().map(observation).collect()
    }
}
