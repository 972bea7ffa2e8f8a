use dorsal::egocentric_depth::{BadRig, CameraIntrinsics, Rotation, StereoRig};
use dorsal::v1_gabor::{Binocular, Size};
use stereo_formats::ros_camera_info::{CameraInfo, NotCameraInfo, lens, rig};

use crate::cdr::{Cdr, NotCdr};

/// The message that is a camera, as a bag names it.
pub const CAMERA_TYPE: &str = "sensor_msgs/msg/CameraInfo";

/// Why a message is no camera.
#[derive(Debug, thiserror::Error)]
pub enum NotARosCamera {
    /// The bytes are no message.
    #[error(transparent)]
    Cdr(#[from] NotCdr),
    /// The camera was never calibrated.
    #[error("its K is zero: the camera is not calibrated; give the rig with --rig")]
    Uncalibrated,
    /// The lens is unknown.
    #[error("its distortion model '{model}' with {terms} coefficients is unknown")]
    Lens {
        /// The name of the model.
        model: String,
        /// How many coefficients it has.
        terms: usize,
    },
    /// `R` turns nothing.
    #[error("its R is no rotation")]
    Turn,
}

/// The camera in a [`CAMERA_TYPE`] message.
///
/// # Errors
/// [`NotARosCamera`] says what is wrong.
pub fn decode_camera(bytes: &[u8]) -> Result<CameraInfo, NotARosCamera> {
    let mut cdr = Cdr::new(bytes)?;
    cdr.stamp_ns()?;
    let height = cdr.u32("height")? as usize;
    let width = cdr.u32("width")? as usize;
    let model = cdr.text("distortion_model")?;
    let terms = cdr.u32("d")?;
    // The terms come one after another, so that a length that is a lie ends with the bytes.
    let d: Vec<f64> = (0..terms).map(|_| cdr.f64("d")).collect::<Result<_, _>>()?;
    let k: [f64; 9] = cdr.f64s("k")?;
    let r: [f64; 9] = cdr.f64s("r")?;
    let projection: [f64; 12] = cdr.f64s("p")?;
    if k[0] == 0.0 || k[4] == 0.0 {
        return Err(NotARosCamera::Uncalibrated);
    }
    // A monocular camera leaves R zero, which means that it is not turned.
    let rows = if r == [0.0; 9] {
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    } else {
        [[r[0], r[1], r[2]], [r[3], r[4], r[5]], [r[6], r[7], r[8]]]
    };
    Ok(CameraInfo {
        name: String::new(),
        size: Size { width, height },
        intrinsics: CameraIntrinsics {
            focal_px: (k[0], k[4]),
            principal_point_px: (k[2], k[5]),
        },
        lens: lens(model, &d).ok_or_else(|| NotARosCamera::Lens {
            model: model.to_owned(),
            terms: d.len(),
        })?,
        rectification: Rotation::from_matrix(rows).map_err(|_| NotARosCamera::Turn)?,
        projection,
    })
}

/// The rig of two cameras. Pictures that were rectified before they were recorded are those of the
/// cameras `P`: parallel pinholes; others are those of `K`, `D` and `R`.
///
/// # Errors
/// [`NotCameraInfo`] if the two do not belong together.
pub fn recorded_rig(
    cameras: &Binocular<CameraInfo>,
    rectified: bool,
) -> Result<StereoRig, NotCameraInfo> {
    if !rectified {
        return Ok(rig(cameras)?.rig);
    }
    let (left, right) = (&cameras.left, &cameras.right);
    if left.size != right.size {
        return Err(NotCameraInfo::Sizes(left.size, right.size));
    }
    let camera = |info: &CameraInfo| CameraIntrinsics {
        focal_px: (info.projection[0], info.projection[5]),
        principal_point_px: (info.projection[2], info.projection[6]),
    };
    let across_m = |info: &CameraInfo| -info.projection[3] / info.projection[0];
    let parallel: Result<StereoRig, BadRig> = StereoRig::parallel(
        cameras.as_ref().map(camera),
        across_m(right) - across_m(left),
    );
    Ok(parallel?)
}
