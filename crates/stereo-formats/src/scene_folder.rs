//! Folders of evaluation data: pictures, truth, masks and calibration of a stereo or flow scene.

use std::io;
use std::path::{Path, PathBuf};

use ndarray::Array2;
use v1_gabor::{Binocular, Size};

use crate::file::{self, Unreadable};
use crate::flo::{self, NotFlo};
use crate::mask_png::{self, NotAMask};
use crate::pfm::{self, NotPfm};
use crate::picture::{self, NotAPair, Picture};
use crate::points::{self, NotPoints, PointPair};
use crate::raster::NotAPicture;
use crate::scene_toml::{self, FlowDescription, NotAScene, StereoDescription, Truth};
use crate::vector_planes::VectorPlanes;

/// The file that makes a folder a scene.
const DESCRIPTION: &str = "scene.toml";

/// A folder with a rectified or unrectified pair and what is known of it.
#[derive(Clone, Debug, PartialEq)]
pub struct StereoScene {
    /// The folder.
    pub folder: PathBuf,
    /// What its `scene.toml` says.
    pub description: StereoDescription,
}

/// A folder with two moments of one eye and the flow between them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FlowScene {
    /// The folder.
    pub folder: PathBuf,
    /// What its `scene.toml` says.
    pub description: FlowDescription,
}

/// Two moments of one eye.
#[derive(Clone, Debug)]
pub struct Frames {
    /// The earlier picture.
    pub first: Picture,
    /// The later picture.
    pub second: Picture,
}

/// Which pixels of a stereo scene count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mask {
    /// Those that the right eye sees too (`mask_nonocc`).
    Visible,
    /// Those whose truth is known (`mask_all`).
    Known,
    /// Those near depth discontinuities and visible (`mask_disc`).
    Edges,
}

/// Why a folder of evaluation data gives no scene.
#[derive(Debug, thiserror::Error)]
pub enum SceneMissing {
    /// The folder, or its `scene.toml`, is not there.
    #[error(
        "no scene in {}: {cause}.\n\
         A scene is a folder with scene.toml beside the pictures it names: left.png, right.png, \
         disp_left.png or disp_left.pfm, and mask_nonocc.png where there is one; scene.toml gives \
         name, dataset, citation, terms, width, height, left, right, rectified, disp_left, \
         disparity_scale and unknown_value. A data folder holds scenes as stereo/SET/SCENE and \
         flow/SCENE. Middlebury's pairs and truths can be downloaded from \
         https://vision.middlebury.edu/stereo/data/",
        folder.display()
    )]
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What the system says.
        cause: io::Error,
    },
    /// The `scene.toml` is not what it should be.
    #[error(transparent)]
    Description(#[from] Unreadable<NotAScene>),
}

/// Why a file that a scene names is not what the scene says.
#[derive(Debug, thiserror::Error)]
pub enum SceneBroken {
    /// A pair that is none.
    #[error(transparent)]
    Pair(#[from] NotAPair),
    /// A picture that is none.
    #[error(transparent)]
    Picture(#[from] Unreadable<NotAPicture>),
    /// A float map that is none.
    #[error(transparent)]
    Map(#[from] Unreadable<NotPfm>),
    /// A mask that is none.
    #[error(transparent)]
    Mask(#[from] Unreadable<NotAMask>),
    /// A list of points that is none.
    #[error(transparent)]
    Points(#[from] Unreadable<NotPoints>),
    /// A flow that is none.
    #[error(transparent)]
    Flow(#[from] Unreadable<NotFlo>),
    /// A file of another size than the scene's.
    #[error("{} has {found} pixels, and its {DESCRIPTION} says {said}", path.display())]
    Size {
        /// The file.
        path: PathBuf,
        /// Its size.
        found: Size,
        /// The scene's size.
        said: Size,
    },
}

impl StereoScene {
    /// Opens a scene: reads its `scene.toml`, no picture yet.
    ///
    /// # Errors
    /// [`SceneMissing`] says where data can be had and how a folder must look.
    pub fn open(folder: impl AsRef<Path>) -> Result<Self, SceneMissing> {
        let folder = folder.as_ref();
        Ok(Self {
            description: describe(folder, scene_toml::decode_stereo)?,
            folder: folder.to_owned(),
        })
    }

    /// The files of the pictures of both eyes.
    #[must_use]
    pub fn eye_paths(&self) -> Binocular<PathBuf> {
        let eyes = self.description.files.eyes.as_ref();
        eyes.map(|file| self.path(file))
    }

    /// The pictures of both eyes.
    ///
    /// # Errors
    /// [`SceneBroken`] if one is not read or has another size than the scene says.
    pub fn pair(&self) -> Result<Binocular<Picture>, SceneBroken> {
        let paths = self.eye_paths();
        let pair = picture::read_pair(paths.as_ref().map(PathBuf::as_path))?;
        // Both have one size by now.
        self.sized(paths.left, pair.left.size())?;
        Ok(pair)
    }

    /// The true disparity `d = x_left - x_right` in pixels `[[y, x]]`, NaN where unknown; `None`
    /// if the scene has no dense truth.
    ///
    /// # Errors
    /// [`SceneBroken`] if the file is not read or has another size than the scene says.
    pub fn truth(&self) -> Result<Option<Array2<f32>>, SceneBroken> {
        let (path, d) = match &self.description.files.truth {
            None => return Ok(None),
            Some(Truth::Pfm(file)) => (self.path(file), pfm::read(self.path(file))?),
            Some(Truth::Grey(file, scale)) => (self.path(file), scale.read(self.path(file))?),
        };
        self.sized(path, Size::of_dim(d.dim()))?;
        Ok(Some(d))
    }

    /// The true vertical disparity `dy = y_right - y_left` in pixels `[[y, x]]`, NaN where unknown;
    /// `None` if the scene has none.
    ///
    /// # Errors
    /// [`SceneBroken`] if the file is not read or has another size than the scene says.
    pub fn truth_dy(&self) -> Result<Option<Array2<f32>>, SceneBroken> {
        let Some(file) = &self.description.files.truth_dy else {
            return Ok(None);
        };
        let dy = pfm::read(self.path(file))?;
        self.sized(self.path(file), Size::of_dim(dy.dim()))?;
        Ok(Some(dy))
    }

    /// Which pixels count `[[y, x]]`; `None` if the scene has no such mask.
    ///
    /// # Errors
    /// [`SceneBroken`] if the file is not read or has another size than the scene says.
    pub fn mask(&self, mask: Mask) -> Result<Option<Array2<bool>>, SceneBroken> {
        let masks = &self.description.files.masks;
        let file = match mask {
            Mask::Visible => &masks.visible,
            Mask::Known => &masks.known,
            Mask::Edges => &masks.edges,
        };
        let Some(file) = file else {
            return Ok(None);
        };
        let mask = mask_png::read(self.path(file))?;
        self.sized(self.path(file), Size::of_dim(mask.dim()))?;
        Ok(Some(mask))
    }

    /// Sparse truth; `None` if the scene has none.
    ///
    /// # Errors
    /// [`SceneBroken`] if the file is not read.
    pub fn points(&self) -> Result<Option<Vec<PointPair>>, SceneBroken> {
        let file = self.description.files.points.as_ref();
        Ok(file.map(|file| points::read(self.path(file))).transpose()?)
    }

    fn path(&self, file: &str) -> PathBuf {
        self.folder.join(file)
    }

    fn sized(&self, path: PathBuf, found: Size) -> Result<(), SceneBroken> {
        sized(path, found, self.description.size)
    }
}

impl FlowScene {
    /// Opens a scene: reads its `scene.toml`, no picture yet.
    ///
    /// # Errors
    /// [`SceneMissing`] says where data can be had and how a folder must look.
    pub fn open(folder: impl AsRef<Path>) -> Result<Self, SceneMissing> {
        let folder = folder.as_ref();
        Ok(Self {
            description: describe(folder, scene_toml::decode_flow)?,
            folder: folder.to_owned(),
        })
    }

    /// Both moments.
    ///
    /// # Errors
    /// [`SceneBroken`] if one is not read or has another size than the scene says.
    pub fn frames(&self) -> Result<Frames, SceneBroken> {
        let frame = |file: &str| {
            let path = self.folder.join(file);
            let frame = picture::read(&path)?;
            sized(path, frame.size(), self.description.size)?;
            Ok::<_, SceneBroken>(frame)
        };
        Ok(Frames {
            first: frame(&self.description.frame1)?,
            second: frame(&self.description.frame2)?,
        })
    }

    /// The true flow: first `(x, y)` matches second `(x + dx, y + dy)`.
    ///
    /// # Errors
    /// [`SceneBroken`] if the file is not read or has another size than the scene says.
    pub fn truth(&self) -> Result<VectorPlanes, SceneBroken> {
        let path = self.folder.join(&self.description.flow);
        let flow = flo::read(&path)?;
        sized(path, flow.size(), self.description.size)?;
        Ok(flow)
    }
}

/// The stereo scenes of a data folder, `stereo/SET/SCENE`, in the order of their paths.
///
/// # Errors
/// [`SceneMissing`] if there is no such folder or no scene in it.
pub fn stereo_scenes(data: impl AsRef<Path>) -> Result<Vec<StereoScene>, SceneMissing> {
    let folder = data.as_ref().join("stereo");
    let mut scenes = Vec::new();
    for set in folders(&folder)? {
        for scene in folders(&set)? {
            if scene.join(DESCRIPTION).is_file() {
                scenes.push(StereoScene::open(scene)?);
            }
        }
    }
    some(folder, scenes)
}

/// The flow scenes of a data folder, `flow/SCENE`, in the order of their paths.
///
/// # Errors
/// [`SceneMissing`] if there is no such folder or no scene in it.
pub fn flow_scenes(data: impl AsRef<Path>) -> Result<Vec<FlowScene>, SceneMissing> {
    let folder = data.as_ref().join("flow");
    let mut scenes = Vec::new();
    for scene in folders(&folder)? {
        if scene.join(DESCRIPTION).is_file() {
            scenes.push(FlowScene::open(scene)?);
        }
    }
    some(folder, scenes)
}

fn some<T>(folder: PathBuf, scenes: Vec<T>) -> Result<Vec<T>, SceneMissing> {
    if scenes.is_empty() {
        let cause = io::Error::new(io::ErrorKind::NotFound, "no folder in it has a scene.toml");
        return Err(SceneMissing::Folder { folder, cause });
    }
    Ok(scenes)
}

/// The folders in a folder, sorted: the order of the disk means nothing.
fn folders(folder: &Path) -> Result<Vec<PathBuf>, SceneMissing> {
    let missing = |cause| SceneMissing::Folder {
        folder: folder.to_owned(),
        cause,
    };
    let entries: io::Result<Vec<PathBuf>> = folder
        .read_dir()
        .map_err(missing)?
        .map(|entry| Ok(entry?.path()))
        .collect();
    let mut folders = entries.map_err(missing)?;
    folders.retain(|path| path.is_dir());
    folders.sort();
    Ok(folders)
}

fn describe<T>(
    folder: &Path,
    decode: impl FnOnce(&[u8]) -> Result<T, NotAScene>,
) -> Result<T, SceneMissing> {
    file::read(&folder.join(DESCRIPTION), decode).map_err(|unreadable| match unreadable {
        Unreadable::Closed { cause, .. } => SceneMissing::Folder {
            folder: folder.to_owned(),
            cause,
        },
        content => SceneMissing::Description(content),
    })
}

fn sized(path: PathBuf, found: Size, said: Size) -> Result<(), SceneBroken> {
    if found == said {
        Ok(())
    } else {
        Err(SceneBroken::Size { path, found, said })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_folder_says_where_data_is_and_how_it_must_look() {
        for error in [
            StereoScene::open("no/such/scene").map(|_| ()).unwrap_err(),
            stereo_scenes("no/such/scene").map(|_| ()).unwrap_err(),
            flow_scenes("no/such/scene").map(|_| ()).unwrap_err(),
        ] {
            let text = error.to_string();
            for part in [
                "no/such/scene",
                "vision.middlebury.edu/stereo/data",
                "scene.toml",
            ] {
                assert!(text.contains(part), "{text}");
            }
        }
    }

    #[test]
    fn a_picture_of_another_size_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let text = "name = 'n'\ndataset = 'd'\ncitation = 'c'\nterms = 't'\nwidth = 4\n\
            height = 3\nleft = 'l.png'\nright = 'r.png'\nrectified = true\n";
        std::fs::write(folder.path().join(DESCRIPTION), text).unwrap();
        for file in ["l.png", "r.png"] {
            let grey = Array2::from_elem((3, 5), [7; 3]);
            picture::write_rgb(folder.path().join(file), grey.view()).unwrap();
        }
        let scene = StereoScene::open(folder.path()).unwrap();
        let error = scene.pair().map(|_| ()).unwrap_err().to_string();
        assert!(error.contains("l.png has 5 x 3 pixels"), "{error}");
        assert!(scene.truth().unwrap().is_none());
        assert!(scene.points().unwrap().is_none());
        assert!(scene.mask(Mask::Visible).unwrap().is_none());
    }
}
