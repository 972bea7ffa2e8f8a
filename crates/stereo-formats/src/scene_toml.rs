//! `scene.toml`: what a folder of evaluation data says of itself.

use egocentric_depth::{BadRig, CameraIntrinsics, StereoRig};
use serde::Deserialize;
use v1_gabor::{Binocular, Size};

use crate::camera_matrix;
use crate::middlebury_png::{BadScale, GreyScale};
use crate::toml_text::{self, NotToml};

/// Why a text describes no scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotAScene {
    /// The text is not the TOML that is read here.
    #[error(transparent)]
    Toml(#[from] NotToml),
    /// A file name that leads out of the folder.
    #[error("{key} = '{file}' is no plain file name; the files of a scene stand in its own folder")]
    FileName {
        /// The key.
        key: &'static str,
        /// Its value.
        file: String,
    },
    /// Grey truth without a scale, or with one that is none.
    #[error("disp_left is a PNG, and disparity_scale is {0}; it says how many greys make a pixel")]
    Scale(String),
    /// An unknown value that is none.
    #[error("unknown_value = {0} is none; a PNG has a number from 0 to 255")]
    Unknown(i64),
    /// Some numbers of a calibration, and not all.
    #[error("it has focal_px and no {0}; a calibration needs cx_px, cy_px and baseline_mm too")]
    Calibration(&'static str),
    /// The numbers describe no rig.
    #[error("its calibration is none: {0}")]
    Rig(#[from] BadRig),
    /// A camera matrix that is none.
    #[error("{0} is no camera matrix [fx, 0, cx, 0, fy, cy, 0, 0, 1]")]
    Camera(&'static str),
}

/// A stereo scene as its `scene.toml` describes it; [`crate::scene_folder`] opens the files.
#[derive(Clone, Debug, PartialEq)]
pub struct StereoDescription {
    /// Short name, such as `venus`.
    pub name: String,
    /// The set it comes from, in words.
    pub dataset: String,
    /// The paper to cite.
    pub citation: String,
    /// The publisher's terms.
    pub terms: String,
    /// Size of the pictures.
    pub size: Size,
    /// Whether rows correspond: left `(x, y)` matches right `(x - d, y)`.
    pub rectified: bool,
    /// Whether the truth is rounded to whole pixels, so that a finer answer is penalised.
    pub integer_truth: bool,
    /// The calibration, where one is published for a rectified pair.
    pub rig: Option<StereoRig>,
    /// The pose of a pair that is not rectified, where one is known.
    pub pose: Option<Pose>,
    pub(crate) files: StereoFiles,
}

/// The plain file names of a stereo scene.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StereoFiles {
    pub(crate) eyes: Binocular<String>,
    pub(crate) truth: Option<Truth>,
    pub(crate) truth_dy: Option<String>,
    pub(crate) masks: Masks,
    pub(crate) points: Option<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Truth {
    Pfm(String),
    Grey(String, GreyScale),
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Masks {
    pub(crate) visible: Option<String>,
    pub(crate) known: Option<String>,
    pub(crate) edges: Option<String>,
}

/// How the right camera stands to the left one, for a pair that is not rectified:
/// `x_right = rotation * x_left + translation` in camera coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// The two cameras.
    pub intrinsics: Binocular<CameraIntrinsics>,
    /// Lens distortion `k1 k2 p1 p2 k3` of each camera; zeros if there is none.
    pub distortion: Binocular<[f64; 5]>,
    /// The rotation, row by row.
    pub rotation: [[f64; 3]; 3],
    /// The translation, in metres if `metric`, else in a unit that was not published.
    pub translation: [f64; 3],
    /// Whether the translation is in metres.
    pub metric: bool,
}

/// A flow scene as its `scene.toml` describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FlowDescription {
    /// Short name, such as `rubberwhale`.
    pub name: String,
    /// The set it comes from, in words.
    pub dataset: String,
    /// The paper to cite.
    pub citation: String,
    /// The publisher's terms.
    pub terms: String,
    /// Size of the frames.
    pub size: Size,
    pub(crate) frame1: String,
    pub(crate) frame2: String,
    pub(crate) flow: String,
}

/// The keys that are read; a scene has many more, written for people, and those are left alone.
#[derive(Deserialize)]
struct StereoText {
    name: String,
    dataset: String,
    citation: String,
    terms: String,
    width: usize,
    height: usize,
    left: String,
    right: String,
    rectified: bool,
    disp_left: Option<String>,
    dy_left: Option<String>,
    disparity_scale: Option<f32>,
    unknown_value: Option<UnknownValue>,
    #[serde(default)]
    gt_integer: bool,
    mask_nonocc: Option<String>,
    mask_all: Option<String>,
    mask_disc: Option<String>,
    points: Option<String>,
    focal_px: Option<f64>,
    cx_px: Option<f64>,
    cy_px: Option<f64>,
    doffs: Option<f64>,
    baseline_mm: Option<f64>,
    k: Option<[f64; 9]>,
    k_left: Option<[f64; 9]>,
    k_right: Option<[f64; 9]>,
    distortion_left: Option<[f64; 5]>,
    distortion_right: Option<[f64; 5]>,
    rotation: Option<[f64; 9]>,
    translation_mm: Option<[f64; 3]>,
    translation_squares: Option<[f64; 3]>,
}

#[derive(Deserialize)]
struct FlowText {
    name: String,
    dataset: String,
    citation: String,
    terms: String,
    width: usize,
    height: usize,
    frame1: String,
    frame2: String,
    flow: String,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "unknown_value is a grey value or \"inf\"")]
enum UnknownValue {
    Grey(i64),
    Word(#[expect(dead_code, reason = "a float map has its own word for unknown")] String),
}

/// Decodes the description of a stereo scene.
///
/// # Errors
/// [`NotAScene`] says what is missing or wrong.
pub fn decode_stereo(bytes: &[u8]) -> Result<StereoDescription, NotAScene> {
    let text: StereoText = toml_text::decode(bytes)?;
    let rig = text.rig()?;
    let pose = text.pose()?;
    let optional = |key, file: &Option<String>| {
        let file = file.clone();
        file.map(|file| plain(key, file)).transpose()
    };
    let files = StereoFiles {
        truth: text.truth()?,
        truth_dy: optional("dy_left", &text.dy_left)?,
        masks: Masks {
            visible: optional("mask_nonocc", &text.mask_nonocc)?,
            known: optional("mask_all", &text.mask_all)?,
            edges: optional("mask_disc", &text.mask_disc)?,
        },
        points: optional("points", &text.points)?,
        eyes: Binocular {
            left: plain("left", text.left)?,
            right: plain("right", text.right)?,
        },
    };
    Ok(StereoDescription {
        name: text.name,
        dataset: text.dataset,
        citation: text.citation,
        terms: text.terms,
        size: Size {
            width: text.width,
            height: text.height,
        },
        rectified: text.rectified,
        integer_truth: text.gt_integer,
        rig,
        pose,
        files,
    })
}

/// Decodes the description of a flow scene.
///
/// # Errors
/// [`NotAScene`] says what is missing or wrong.
pub fn decode_flow(bytes: &[u8]) -> Result<FlowDescription, NotAScene> {
    let text: FlowText = toml_text::decode(bytes)?;
    Ok(FlowDescription {
        frame1: plain("frame1", text.frame1)?,
        frame2: plain("frame2", text.frame2)?,
        flow: plain("flow", text.flow)?,
        name: text.name,
        dataset: text.dataset,
        citation: text.citation,
        terms: text.terms,
        size: Size {
            width: text.width,
            height: text.height,
        },
    })
}

impl StereoText {
    fn truth(&self) -> Result<Option<Truth>, NotAScene> {
        let Some(file) = self.disp_left.clone() else {
            return Ok(None);
        };
        let file = plain("disp_left", file)?;
        if file.ends_with(".pfm") {
            return Ok(Some(Truth::Pfm(file)));
        }
        let unknown = match self.unknown_value {
            Some(UnknownValue::Grey(grey)) => {
                u8::try_from(grey).map_err(|_| NotAScene::Unknown(grey))?
            }
            _ => 0,
        };
        let scale = self
            .disparity_scale
            .ok_or_else(|| NotAScene::Scale("missing".to_owned()))?;
        let scale = GreyScale::new(scale, unknown)
            .map_err(|BadScale(scale)| NotAScene::Scale(scale.to_string()))?;
        Ok(Some(Truth::Grey(file, scale)))
    }

    /// The rig of a rectified pair: one focal length, principal points `doffs` apart.
    fn rig(&self) -> Result<Option<StereoRig>, NotAScene> {
        let Some(focal_px) = self.focal_px else {
            return Ok(None);
        };
        let cx = self.cx_px.ok_or(NotAScene::Calibration("cx_px"))?;
        let cy = self.cy_px.ok_or(NotAScene::Calibration("cy_px"))?;
        let baseline_mm = self
            .baseline_mm
            .ok_or(NotAScene::Calibration("baseline_mm"))?;
        let eye = |cx| CameraIntrinsics {
            focal_px: (focal_px, focal_px),
            principal_point_px: (cx, cy),
        };
        let eyes = Binocular {
            left: eye(cx),
            right: eye(cx + self.doffs.unwrap_or(0.0)),
        };
        Ok(Some(StereoRig::parallel(eyes, baseline_mm / 1000.0)?))
    }

    fn pose(&self) -> Result<Option<Pose>, NotAScene> {
        let Some(rotation) = self.rotation else {
            return Ok(None);
        };
        let (translation, metric) = match (self.translation_mm, self.translation_squares) {
            (Some(mm), _) => (mm.map(|mm| mm / 1000.0), true),
            (None, Some(squares)) => (squares, false),
            (None, None) => return Ok(None),
        };
        let (rows, _) = rotation.as_chunks::<3>();
        let [first, second, third] = rows else {
            return Ok(None);
        };
        Ok(Some(Pose {
            intrinsics: Binocular {
                left: camera("k_left", self.k_left.or(self.k))?,
                right: camera("k_right", self.k_right.or(self.k))?,
            },
            distortion: Binocular {
                left: self.distortion_left.unwrap_or_default(),
                right: self.distortion_right.unwrap_or_default(),
            },
            rotation: [*first, *second, *third],
            translation,
            metric,
        }))
    }
}

fn camera(key: &'static str, k: Option<[f64; 9]>) -> Result<CameraIntrinsics, NotAScene> {
    let camera = k.and_then(|k| camera_matrix::camera(&k));
    camera.ok_or(NotAScene::Camera(key))
}

/// A file name without a way out of the folder.
fn plain(key: &'static str, file: String) -> Result<String, NotAScene> {
    let leads_out = file.contains(['/', '\\', ':', '\0']) || matches!(&*file, "" | "." | "..");
    if leads_out {
        Err(NotAScene::FileName { key, file })
    } else {
        Ok(file)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "name = 'n'\ndataset = 'd'\ncitation = 'c'\nterms = 't'\nwidth = 4\n\
        height = 3\nleft = 'left.png'\nright = 'right.png'\nrectified = true\n";

    fn refused(more: &str) -> NotAScene {
        decode_stereo(format!("{TEXT}{more}\n").as_bytes()).unwrap_err()
    }

    #[test]
    fn refusals_say_what() {
        assert!(matches!(
            refused("points = '../secret'"),
            NotAScene::FileName { key: "points", .. }
        ));
        assert_eq!(
            refused("disp_left = 'd.png'"),
            NotAScene::Scale("missing".into())
        );
        let scale = "disp_left = 'd.png'\ndisparity_scale = 0";
        assert_eq!(refused(scale), NotAScene::Scale("0".into()));
        let unknown = "disp_left = 'd.png'\ndisparity_scale = 8\nunknown_value = 300";
        assert_eq!(refused(unknown), NotAScene::Unknown(300));
        assert_eq!(
            refused("focal_px = 1\ncx_px = 3"),
            NotAScene::Calibration("cy_px")
        );
        let pose = "rotation = [1, 0, 0, 0, 1, 0, 0, 0, 1]\ntranslation_mm = [1, 2, 3]";
        assert_eq!(refused(pose), NotAScene::Camera("k_left"));
        assert!(matches!(refused("left = 'twice'"), NotAScene::Toml(_)));
    }
}
