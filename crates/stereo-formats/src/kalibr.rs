//! Kalibr's `camchain.yaml`: two pinholes and how the second stands to the first.

use std::path::Path;

use egocentric_depth::{BadRig, CameraIntrinsics, Lens, RelativePose, Rotation, StereoRig};
use serde::Deserialize;
use v1_gabor::{Binocular, Size};

use crate::camera_matrix;
use crate::file::{self, Unreadable, Unwritable};
use crate::rig_toml::{SizedRig, brown_conrady};
use crate::yaml_text::{self, NotYaml, Number, plain, spell_list};

/// Why a text is no chain of two cameras, or a rig goes into none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotACamchain {
    /// The text is not the YAML that is read here.
    #[error(transparent)]
    Yaml(#[from] NotYaml),
    /// A value that is not what its key needs.
    #[error("line {line}: {camera} {what}")]
    Value {
        /// The line, counted from 1.
        line: usize,
        /// The camera.
        camera: &'static str,
        /// What is wrong.
        what: String,
    },
    /// A lens that Kalibr has no name for.
    #[error(
        "the {eye} lens has k3 = {k3} or terms beyond it, and a camchain's radtan ends with k1 k2 p1 p2; \
         write a rig.toml, ROS or OpenCV file, or rectify the pair first (dorsal rig rectify)"
    )]
    Lens {
        /// The eye: left or right.
        eye: &'static str,
        /// Its third radial coefficient.
        k3: f64,
    },
    /// A rig without a size of its pictures.
    #[error("the rig does not say how large its pictures are: give size_px, or --size")]
    NoSize,
    /// The numbers describe no rig.
    #[error(transparent)]
    Rig(#[from] BadRig),
}

#[derive(Deserialize)]
struct Chain {
    cam0: Camera,
    cam1: Camera,
}

#[derive(Deserialize)]
struct Camera {
    camera_model: String,
    intrinsics: Vec<Number>,
    #[serde(default)]
    distortion_model: Option<String>,
    #[serde(default)]
    distortion_coeffs: Vec<Number>,
    resolution: Option<[usize; 2]>,
    #[serde(rename = "T_cn_cnm1")]
    pose: Option<Vec<Vec<Number>>>,
}

/// Decodes a chain. Cameras beyond the second are left alone.
///
/// # Errors
/// [`NotACamchain`] says what is wrong, and in which line.
pub fn decode(bytes: &[u8]) -> Result<SizedRig, NotACamchain> {
    let chain: Chain = yaml_text::decode(bytes)?;
    let wrong = |camera: &'static str, key: &str, what: String| NotACamchain::Value {
        line: yaml_text::line_of(bytes, &[camera, key]),
        camera,
        what,
    };
    let camera = |name: &'static str, camera: &Camera| {
        if camera.camera_model != "pinhole" {
            let what = format!("has the model '{}'; pinhole is read", camera.camera_model);
            return Err(wrong(name, "camera_model", what));
        }
        let &[fx, fy, cx, cy] = &plain(&camera.intrinsics)[..] else {
            let what = format!(
                "has {} intrinsics, not fu fv pu pv",
                camera.intrinsics.len()
            );
            return Err(wrong(name, "intrinsics", what));
        };
        let intrinsics = CameraIntrinsics {
            focal_px: (fx, fy),
            principal_point_px: (cx, cy),
        };
        let terms = plain(&camera.distortion_coeffs);
        let model = camera.distortion_model.as_deref();
        let lens = match (model, &terms[..]) {
            (Some("none") | None, _) => Some(Lens::Pinhole),
            (Some("radtan"), terms @ [_, _, _, _]) => brown_conrady(terms),
            (Some("equidistant"), &[k1, k2, k3, k4]) => Some(Lens::Fisheye([k1, k2, k3, k4])),
            _ => None,
        };
        let lens = lens.ok_or_else(|| {
            let what = format!(
                "has the lens '{}' with {} terms; none, radtan and equidistant (4 terms) are read",
                model.unwrap_or_default(),
                terms.len()
            );
            wrong(name, "distortion_model", what)
        })?;
        Ok((intrinsics, lens))
    };
    let left = camera("cam0", &chain.cam0)?;
    let right = camera("cam1", &chain.cam1)?;
    let pose = pose(chain.cam1.pose.as_deref()).map_err(|what| wrong("cam1", "T_cn_cnm1", what))?;
    let intrinsics = Binocular {
        left: left.0,
        right: right.0,
    };
    let lenses = Binocular {
        left: left.1,
        right: right.1,
    };
    Ok(SizedRig {
        rig: StereoRig::from_pose(intrinsics, &pose)?.with_lenses(lenses)?,
        size: chain
            .cam0
            .resolution
            .map(|[width, height]| Size { width, height }),
    })
}

/// The pose of a matrix of four rows of four.
fn pose(rows: Option<&[Vec<Number>]>) -> Result<RelativePose, String> {
    let rows = rows.ok_or("has no T_cn_cnm1, the pose to the camera before it")?;
    let numbers: Vec<f64> = rows.iter().flat_map(|row| plain(row)).collect();
    let square = rows.len() == 4 && rows.iter().all(|row| row.len() == 4);
    let (Some(numbers), true) = (numbers.get(..12), square) else {
        return Err("has a T_cn_cnm1 that is not 4 x 4".to_owned());
    };
    let turn: Vec<f64> = (0..3)
        .flat_map(|i| numbers[4 * i..4 * i + 3].to_vec())
        .collect();
    let turn = camera_matrix::rows(&turn).ok_or("has no rotation")?;
    Ok(RelativePose {
        rotation: Rotation::from_matrix(turn)
            .map_err(|refused| format!("has a T_cn_cnm1 that is none: {refused}"))?,
        translation_m: std::array::from_fn(|i| numbers[4 * i + 3]),
    })
}

/// The chain of a rig. The tilt of its head and what is uncertain of it have no place in it.
///
/// # Errors
/// [`NotACamchain`] if the rig has a lens that the format has not, or no size of its pictures.
pub fn encode(sized: &SizedRig) -> Result<Vec<u8>, NotACamchain> {
    let size = sized.size.ok_or(NotACamchain::NoSize)?;
    let (cameras, lenses) = (sized.rig.intrinsics(), sized.rig.lenses());
    let pose = sized.rig.relative_pose();
    let camera = |name: &str, eye: &'static str, camera: CameraIntrinsics, lens: Lens| {
        let (model, terms) = match lens {
            Lens::Pinhole => ("none", Vec::new()),
            Lens::BrownConrady([k1, k2, p1, p2, 0.0, 0.0, 0.0, 0.0]) => {
                ("radtan", vec![k1, k2, p1, p2])
            }
            Lens::BrownConrady([_, _, _, _, k3, ..]) => return Err(NotACamchain::Lens { eye, k3 }),
            Lens::Fisheye(terms) => ("equidistant", terms.to_vec()),
        };
        let ((fx, fy), (cx, cy)) = (camera.focal_px, camera.principal_point_px);
        Ok(format!(
            "{name}:\n  camera_model: pinhole\n  distortion_coeffs: {}\n  distortion_model: {model}\n  \
             intrinsics: {}\n  resolution: [{}, {}]\n  rostopic: /{name}/image_raw\n",
            spell_list(&terms),
            spell_list(&[fx, fy, cx, cy]),
            size.width,
            size.height
        ))
    };
    let mut text = camera("cam0", "left", cameras.left, lenses.left)?;
    text += &camera("cam1", "right", cameras.right, lenses.right)?;
    text += "  T_cn_cnm1:\n";
    for (row, metres) in pose.rotation.matrix().into_iter().zip(pose.translation_m) {
        text += &format!("  - {}\n", spell_list(&[row[0], row[1], row[2], metres]));
    }
    text += "  - [0.0, 0.0, 0.0, 1.0]\n";
    Ok(text.into_bytes())
}

/// Reads a chain; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<SizedRig, Unreadable<NotACamchain>> {
    file::read(path.as_ref(), decode)
}

/// Writes a chain, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(path: impl AsRef<Path>, rig: &SizedRig) -> Result<(), Unwritable<NotACamchain>> {
    file::write(path.as_ref(), encode(rig))
}
