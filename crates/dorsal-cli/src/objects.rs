use std::path::Path;

use anyhow::{Context as _, ensure};
use dorsal::Names;
use dorsal::egocentric_depth::LabelImage;
use dorsal::v1_gabor::Size;
use stereo_formats::{label_png, label_polygons, names};

use crate::look_arguments::is_toml;

/// The objects of the left picture: which pixels show them, and what they are called.
#[derive(Clone, Debug)]
pub(crate) struct Objects {
    pub(crate) labels: LabelImage,
    pub(crate) names: Names,
}

impl Objects {
    /// Reads the objects of a picture of this size: outlines with names from a TOML, or labels
    /// from a PNG, with names from a file of their own if there is one.
    pub(crate) fn read(labels: &Path, names: Option<&Path>, size: Size) -> anyhow::Result<Self> {
        let objects = if is_toml(labels) {
            let polygons = label_polygons::read(labels)?;
            Self {
                labels: polygons
                    .fill()
                    .with_context(|| format!("{}", labels.display()))?,
                names: polygons.names(),
            }
        } else {
            Self {
                labels: label_png::read(labels)?,
                names: names.map_or_else(|| Ok(Names::new()), names::read)?,
            }
        };
        ensure!(
            objects.labels.size() == size,
            "{} labels {} pixels and the left picture has {size}; \
             labels belong to the left picture, pixel by pixel",
            labels.display(),
            objects.labels.size(),
        );
        if let Some(path) = names {
            names::agree(&objects.names, &objects.labels)
                .with_context(|| format!("{} and {}", path.display(), labels.display()))?;
        }
        Ok(objects)
    }
}
