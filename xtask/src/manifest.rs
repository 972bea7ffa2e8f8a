use serde::{Deserialize, Deserializer};

use crate::sha256::Sha256;

/// The files of the evaluation data that can be fetched, scene by scene.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    /// The scenes.
    #[serde(rename = "scene")]
    pub(crate) scenes: Vec<ListedScene>,
}

/// The files of one scene.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ListedScene {
    /// Its name, as in its `scene.toml`.
    pub(crate) name: String,
    /// Its folder below the data folder, with `/` between the parts.
    pub(crate) folder: String,
    /// Its files.
    #[serde(rename = "file")]
    pub(crate) files: Vec<ListedFile>,
}

/// One file: what it must be.
#[derive(Clone, Debug, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ListedFile {
    /// Its plain name.
    pub(crate) name: String,
    /// Its length in bytes.
    pub(crate) size: u64,
    /// Its checksum.
    #[serde(deserialize_with = "checksum")]
    pub(crate) sha256: Sha256,
}

impl ListedFile {
    /// Whether these bytes are the file's.
    pub(crate) fn is(&self, bytes: &[u8]) -> bool {
        bytes.len() as u64 == self.size && Sha256::of(bytes) == self.sha256
    }
}

impl Manifest {
    /// The manifest of the repository.
    pub(crate) fn of_repository() -> Result<Self, toml::de::Error> {
        toml::from_str(include_str!("../../fixtures/evaluation-data.toml"))
    }
}

fn checksum<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Sha256, D::Error> {
    let digits = String::deserialize(deserializer)?;
    Sha256::from_hex(&digits)
        .ok_or_else(|| serde::de::Error::custom("sha256 has 64 hexadecimal digits"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_repository_lists_the_scenes_of_table_1() {
        let manifest = Manifest::of_repository().unwrap();
        for scene in crate::table_1::SCENES {
            let listed = manifest.scenes.iter().find(|listed| listed.name == scene);
            let names: Vec<&str> = listed
                .unwrap()
                .files
                .iter()
                .map(|file| &*file.name)
                .collect();
            for file in ["scene.toml", "left.png", "right.png", "disp_left.png"] {
                assert!(names.contains(&file), "{scene} lists {names:?}");
            }
        }
        for scene in &manifest.scenes {
            assert!(scene.folder.starts_with("stereo/") && !scene.folder.contains(".."));
        }
    }

    /// The data, where there is some, is what the manifest says.
    #[test]
    fn the_data_is_what_the_manifest_says() {
        let Some(data) = crate::data_folder::beside_the_checkout() else {
            return;
        };
        for scene in Manifest::of_repository().unwrap().scenes {
            for file in scene.files {
                let path = data.join(&scene.folder).join(&file.name);
                assert!(
                    file.is(&std::fs::read(&path).unwrap()),
                    "{}",
                    path.display()
                );
            }
        }
    }
}
