use std::path::PathBuf;

use dorsal::egocentric_depth::{CameraIntrinsics, RelativePose, Rotation, StereoRig};
use dorsal::v1_gabor::{Binocular, Size};
use pyo3::prelude::*;
use stereo_formats::rig_toml::{self, SizedRig};
use stereo_formats::{kalibr, middlebury_calib};

use crate::refusal::{file_error, value_error};

/// Two cameras and how they stand to one another; a value that never changes.
#[pyclass(frozen, module = "dorsal")]
#[derive(Debug)]
pub(crate) struct Rig {
    sized: SizedRig,
}

impl Rig {
    /// The rig, if it is one of pictures of this size.
    pub(crate) fn of_pictures(&self, size: Size) -> PyResult<StereoRig> {
        match self.sized.size {
            Some(said) if said != size => Err(value_error(format!(
                "the rig is one of pictures of {said} pixels, and these have {size}: focal lengths and principal \
                 points count pixels of its own size"
            ))),
            _ => Ok(self.sized.rig),
        }
    }

    pub(crate) fn unsized_(rig: StereoRig) -> Self {
        Self {
            sized: SizedRig { rig, size: None },
        }
    }
}

#[pymethods]
impl Rig {
    /// Two like cameras side by side: `focal_px` one number or `(fx, fy)`, `principal_point_px` `(cx, cy)`, pixels;
    /// `baseline_m` metres between them. `right_principal_point_px` if the right eye's differs. Eyes that converge
    /// are each turned in by half of `vergence_rad`; `tilt_rad` turns the head up.
    #[staticmethod]
    #[pyo3(signature = (focal_px, principal_point_px, baseline_m, *, right_principal_point_px = None,
        vergence_rad = 0.0, tilt_rad = 0.0))]
    fn parallel(
        focal_px: Focal,
        principal_point_px: (f64, f64),
        baseline_m: f64,
        right_principal_point_px: Option<(f64, f64)>,
        vergence_rad: f64,
        tilt_rad: f64,
    ) -> PyResult<Self> {
        let eye = |principal_point_px| CameraIntrinsics {
            focal_px: focal_px.both(),
            principal_point_px,
        };
        let eyes = Binocular {
            left: eye(principal_point_px),
            right: eye(right_principal_point_px.unwrap_or(principal_point_px)),
        };
        let pans = Binocular {
            left: vergence_rad / 2.0,
            right: -vergence_rad / 2.0,
        };
        let rig = StereoRig::vergent(eyes, baseline_m, pans).and_then(|rig| rig.tilted(tilt_rad));
        rig.map(Self::unsized_).map_err(value_error)
    }

    /// Two pinholes as OpenCV's `stereoCalibrate` gives them: `K1`, `K2`, `R` and `T`, with `T` in metres. Lenses
    /// are taken to be undistorted; a calibration file that `Rig.read` reads may have their terms.
    #[staticmethod]
    fn from_matrices(
        left: [[f64; 3]; 3],
        right: [[f64; 3]; 3],
        rotation: [[f64; 3]; 3],
        translation_m: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        // OpenCV's is a column.
        let translation_m = match translation_m.getattr_opt("ravel")? {
            Some(ravel) => ravel.call0()?.extract()?,
            None => translation_m.extract()?,
        };
        let pose = RelativePose {
            rotation: Rotation::from_matrix(rotation).map_err(value_error)?,
            translation_m,
        };
        let eyes = Binocular { left, right }.map(|k| CameraIntrinsics {
            focal_px: (k[0][0], k[1][1]),
            principal_point_px: (k[0][2], k[1][2]),
        });
        let rig = StereoRig::from_pose(eyes, &pose);
        rig.map(Self::unsized_).map_err(value_error)
    }

    /// Reads `rig.toml`, Middlebury's `calib.txt` or Kalibr's `camchain.yaml`; `dorsal rig convert` reads more.
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Self> {
        let extension = path.extension().and_then(|extension| extension.to_str());
        let sized = match extension.map(str::to_ascii_lowercase).as_deref() {
            Some("txt") => {
                let calib = middlebury_calib::read(&path).map_err(file_error)?;
                SizedRig {
                    rig: calib.rig,
                    size: Some(calib.size),
                }
            }
            Some("yaml" | "yml") => kalibr::read(&path).map_err(file_error)?,
            _ => rig_toml::read_sized(&path).map_err(file_error)?,
        };
        Ok(Self { sized })
    }

    /// The text of a `rig.toml`, which holds everything.
    fn to_toml(&self) -> PyResult<String> {
        let bytes = rig_toml::encode_sized(&self.sized).map_err(value_error)?;
        String::from_utf8(bytes).map_err(value_error)
    }

    /// The rig of the text of a `rig.toml`.
    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Self> {
        let sized = rig_toml::decode_sized(text.as_bytes()).map_err(value_error)?;
        Ok(Self { sized })
    }

    /// Metres between the eyes.
    #[getter]
    fn baseline_m(&self) -> f64 {
        self.sized.rig.baseline_m()
    }

    /// By how much the eyes converge, in radians.
    #[getter]
    fn vergence_rad(&self) -> f64 {
        self.sized.rig.vergence_rad()
    }

    /// How far up the head is turned, in radians.
    #[getter]
    fn tilt_rad(&self) -> f64 {
        self.sized.rig.tilt_rad()
    }

    /// Whether what corresponds lies on one row.
    #[getter]
    fn is_rectified(&self) -> bool {
        self.sized.rig.is_rectified()
    }

    fn __reduce__<'py>(this: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, (String,))> {
        let text = this.get().to_toml()?;
        Ok((this.get_type().getattr("from_toml")?, (text,)))
    }

    fn __repr__(&self) -> String {
        let rig = &self.sized.rig;
        format!(
            "Rig(baseline_m={}, vergence_rad={}, tilt_rad={})",
            rig.baseline_m(),
            rig.vergence_rad(),
            rig.tilt_rad()
        )
    }
}

/// One focal length for both axes, or one each.
#[derive(Clone, Copy, Debug, FromPyObject)]
enum Focal {
    One(f64),
    Both((f64, f64)),
}

impl Focal {
    const fn both(self) -> (f64, f64) {
        match self {
            Self::One(px) => (px, px),
            Self::Both(px) => px,
        }
    }
}
