//! ROS `camera_info` in YAML, as `camera_calibration` writes it: one file for each eye.

use std::path::Path;

use egocentric_depth::{
    BadRig, CameraIntrinsics, Lens, NoRotation, Rectification, RelativePose, Rotation, StereoRig,
};
use serde::Deserialize;
use v1_gabor::{Binocular, Size};

use crate::camera_matrix;
use crate::file::{self, Unreadable, Unwritable};
use crate::rig_toml::{SizedRig, brown_conrady, brown_conrady_terms};
use crate::yaml_text::{self, NotYaml, Number, plain, spell_list};

/// What one file says of one camera.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraInfo {
    /// The camera's name.
    pub name: String,
    /// Size of its pictures.
    pub size: Size,
    /// The camera as it takes pictures, `K`.
    pub intrinsics: CameraIntrinsics,
    /// What its lens bends, `D`.
    pub lens: Lens,
    /// From the camera's frame into the rectified one, `R`.
    pub rectification: Rotation,
    /// The rectified camera, `P`, row by row; the fourth number is `-fx` times the baseline for a
    /// right eye.
    pub projection: [f64; 12],
}

/// Why a text is no camera, or two are no pair.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotCameraInfo {
    /// The text is not the YAML that is read here.
    #[error(transparent)]
    Yaml(#[from] NotYaml),
    /// A value that is not what its key needs.
    #[error("line {line}: {key} {what}")]
    Value {
        /// The line, counted from 1.
        line: usize,
        /// The key.
        key: &'static str,
        /// What is wrong with it.
        what: String,
    },
    /// The pictures of the two eyes differ in size.
    #[error("the left camera has pictures of {0} and the right one of {1} pixels")]
    Sizes(Size, Size),
    /// A rig without a size of its pictures.
    #[error("the rig does not say how large its pictures are: give size_px, or --size")]
    NoSize,
    /// The numbers describe no rig.
    #[error(transparent)]
    Rig(#[from] BadRig),
}

#[derive(Deserialize)]
struct Text {
    image_width: usize,
    image_height: usize,
    #[serde(default)]
    camera_name: String,
    camera_matrix: Matrix,
    #[serde(default)]
    distortion_model: String,
    distortion_coefficients: Matrix,
    rectification_matrix: Matrix,
    projection_matrix: Matrix,
}

#[derive(Deserialize)]
struct Matrix {
    rows: usize,
    cols: usize,
    data: Vec<Number>,
}

/// Decodes the camera of one eye.
///
/// # Errors
/// [`NotCameraInfo`] says what is wrong, and in which line.
pub fn decode(bytes: &[u8]) -> Result<CameraInfo, NotCameraInfo> {
    let text: Text = yaml_text::decode(bytes)?;
    let wrong = |key: &'static str, what: String| NotCameraInfo::Value {
        line: yaml_text::line_of(bytes, &[key]),
        key,
        what,
    };
    let numbers = |key: &'static str, matrix: &Matrix| {
        let (rows, cols, found) = (matrix.rows, matrix.cols, matrix.data.len());
        if rows.checked_mul(cols) != Some(found) {
            let what = format!("has {found} numbers for {rows} x {cols}");
            return Err(wrong(key, what));
        }
        let data = plain(&matrix.data);
        match data.iter().find(|number| !number.is_finite()) {
            Some(number) => Err(wrong(key, format!("has {number}, which is not finite"))),
            None => Ok(data),
        }
    };
    let k = numbers("camera_matrix", &text.camera_matrix)?;
    let d = numbers("distortion_coefficients", &text.distortion_coefficients)?;
    let r = numbers("rectification_matrix", &text.rectification_matrix)?;
    let p = numbers("projection_matrix", &text.projection_matrix)?;
    let turn = |key, numbers: &[f64]| {
        let rows = camera_matrix::rows(numbers)
            .ok_or_else(|| wrong(key, "has not nine numbers".to_owned()))?;
        Rotation::from_matrix(rows)
            .map_err(|refused: NoRotation| wrong(key, format!("is none: {refused}")))
    };
    let model = text.distortion_model.as_str();
    Ok(CameraInfo {
        name: text.camera_name,
        size: Size {
            width: text.image_width,
            height: text.image_height,
        },
        intrinsics: camera_matrix::camera(&k).ok_or_else(|| {
            let what = "is not [fx, 0, cx, 0, fy, cy, 0, 0, 1]".to_owned();
            wrong("camera_matrix", what)
        })?,
        lens: lens(model, &d).ok_or_else(|| {
            let what = format!(
                "is '{model}' with {} coefficients, which is unknown",
                d.len()
            );
            wrong("distortion_model", what)
        })?,
        rectification: turn("rectification_matrix", &r)?,
        projection: p
            .try_into()
            .map_err(|_| wrong("projection_matrix", "has not twelve numbers".to_owned()))?,
    })
}

/// A lens by the names that ROS has for it; `None` for a name that is unknown here, or for as many
/// coefficients as it does not have.
#[must_use]
pub fn lens(model: &str, d: &[f64]) -> Option<Lens> {
    match (model, d) {
        ("equidistant" | "fisheye", &[k1, k2, k3, k4]) => Some(Lens::Fisheye([k1, k2, k3, k4])),
        ("equidistant" | "fisheye", _) => None,
        ("plumb_bob" | "rational_polynomial" | "", terms) => brown_conrady(terms),
        _ => None,
    }
}

/// The rig of two cameras whose pictures are used as they were taken.
///
/// # Errors
/// [`NotCameraInfo`] if the two do not belong together.
pub fn rig(pair: &Binocular<CameraInfo>) -> Result<SizedRig, NotCameraInfo> {
    let (left, right) = (&pair.left, &pair.right);
    if left.size != right.size {
        return Err(NotCameraInfo::Sizes(left.size, right.size));
    }
    // In the rectified frame the right camera sees the left one's centre at T = P[3] / P[0].
    let seen = |eye: &CameraInfo| [eye.projection[3] / eye.projection[0], 0.0, 0.0];
    let (from_left, from_right) = (seen(left), seen(right));
    let apart = std::array::from_fn(|i| from_right[i] - from_left[i]);
    let pose = RelativePose {
        rotation: right.rectification.inverse().after(&left.rectification),
        translation_m: right.rectification.apply_inverse(apart),
    };
    let intrinsics = Binocular {
        left: left.intrinsics,
        right: right.intrinsics,
    };
    Ok(SizedRig {
        rig: StereoRig::from_pose(intrinsics, &pose)?.with_lenses(Binocular {
            left: left.lens,
            right: right.lens,
        })?,
        size: Some(left.size),
    })
}

/// The two cameras of a rig, named `left` and `right`. The tilt of its head and what is uncertain of
/// it have no place in these files.
///
/// # Errors
/// [`NotCameraInfo`] if the rig has no size of its pictures, or cannot be rectified.
pub fn of_rig(sized: &SizedRig) -> Result<Binocular<CameraInfo>, NotCameraInfo> {
    let size = sized.size.ok_or(NotCameraInfo::NoSize)?;
    let plan = Rectification::plan(&sized.rig, size)?;
    let rectified = plan.rig();
    let info = |name: &str, eye, lens, rectification, camera: CameraIntrinsics, across_m: f64| {
        let ((fx, fy), (cx, cy)) = (camera.focal_px, camera.principal_point_px);
        CameraInfo {
            name: name.to_owned(),
            size,
            intrinsics: eye,
            lens,
            rectification,
            projection: [
                fx,
                0.0,
                cx,
                // Subtracted from zero, so that the left eye has 0 and not -0.
                0.0 - fx * across_m,
                0.0,
                fy,
                cy,
                0.0,
                0.0,
                0.0,
                1.0,
                0.0,
            ],
        }
    };
    let (eyes, lenses, turns) = (sized.rig.intrinsics(), sized.rig.lenses(), plan.turns());
    let cameras = rectified.intrinsics();
    let baseline_m = rectified.baseline_m();
    Ok(Binocular {
        left: info(
            "left",
            eyes.left,
            lenses.left,
            turns.left,
            cameras.left,
            0.0,
        ),
        right: info(
            "right",
            eyes.right,
            lenses.right,
            turns.right,
            cameras.right,
            baseline_m,
        ),
    })
}

/// The YAML text of one camera.
#[must_use]
pub fn encode(info: &CameraInfo) -> Vec<u8> {
    let (model, d) = match &info.lens {
        Lens::Pinhole => ("plumb_bob", &[0.0; 5][..]),
        Lens::BrownConrady(terms) => match brown_conrady_terms(terms) {
            five @ [_, _, _, _, _] => ("plumb_bob", five),
            eight => ("rational_polynomial", eight),
        },
        Lens::Fisheye(terms) => ("equidistant", &terms[..]),
    };
    let matrix = |key: &str, rows: usize, numbers: &[f64]| {
        format!(
            "{key}:\n  rows: {rows}\n  cols: {}\n  data: {}\n",
            numbers.len() / rows,
            spell_list(numbers)
        )
    };
    let r = info.rectification.matrix();
    let text = format!(
        "image_width: {}\nimage_height: {}\ncamera_name: {}\n{}distortion_model: {model}\n{}{}{}",
        info.size.width,
        info.size.height,
        name(&info.name),
        matrix(
            "camera_matrix",
            3,
            &camera_matrix::numbers(&info.intrinsics)
        ),
        matrix("distortion_coefficients", 1, d),
        matrix("rectification_matrix", 3, r.as_flattened()),
        matrix("projection_matrix", 3, &info.projection),
    );
    text.into_bytes()
}

/// A name as YAML takes it for text, whatever stands in it: quoted by the rules that JSON shares.
fn name(name: &str) -> String {
    let escaped: String = name
        .chars()
        .flat_map(|sign| match sign {
            '"' => vec!['\\', '"'],
            '\\' => vec!['\\', '\\'],
            sign if sign.is_control() => format!("\\U{:08x}", u32::from(sign)).chars().collect(),
            sign => vec![sign],
        })
        .collect();
    format!("\"{escaped}\"")
}

/// Reads the camera of one eye; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<CameraInfo, Unreadable<NotCameraInfo>> {
    file::read(path.as_ref(), decode)
}

/// Writes the camera of one eye, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(
    path: impl AsRef<Path>,
    info: &CameraInfo,
) -> Result<(), Unwritable<std::convert::Infallible>> {
    file::write(path.as_ref(), Ok(encode(info)))
}
