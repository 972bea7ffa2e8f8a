//! Middlebury's `calib.txt` (2014 and after, ETH3D too): a rectified pair, lengths in millimetres.

use std::collections::BTreeMap;
use std::path::Path;

use egocentric_depth::{BadRig, CameraIntrinsics, StereoRig};
use v1_gabor::{Binocular, Size};

use crate::camera_matrix;
use crate::file::{self, Unreadable, Unwritable};
use crate::rig_toml::SAME_OFFSET_PX;
use crate::toml_text::{self, NotToml};

/// What a `calib.txt` says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MiddleburyCalib {
    /// The rig: parallel eyes whose principal points lie `doffs` apart.
    pub rig: StereoRig,
    /// Size of the pictures it belongs to: the numbers in pixels are of this size.
    pub size: Size,
}

/// Why a text is not a `calib.txt`.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotCalib {
    /// The bytes are no text.
    #[error(transparent)]
    Text(#[from] NotToml),
    /// A line that is not `key=value`.
    #[error("line {0} is not of the form key=value")]
    Line(usize),
    /// A key that must be there and is not.
    #[error("it has no {0}; a calib.txt has cam0, cam1, doffs, baseline, width and height")]
    Missing(&'static str),
    /// A value that is not what its key needs.
    #[error("line {line}: {key} is '{value}', and {wanted} is needed")]
    Value {
        /// The line, counted from 1.
        line: usize,
        /// The key.
        key: &'static str,
        /// Its value, or the beginning of it.
        value: String,
        /// What it should be.
        wanted: &'static str,
    },
    /// The offset contradicts the principal points.
    #[error("doffs = {doffs_px} contradicts the cameras, whose cx lie {apart_px} px apart")]
    Offset {
        /// The offset as given, in pixels.
        doffs_px: f64,
        /// `cx1 - cx0`, in pixels.
        apart_px: f64,
    },
    /// The numbers describe no rig.
    #[error(transparent)]
    Rig(#[from] BadRig),
}

/// Decodes a `calib.txt`. Keys beside the six it needs (`ndisp`, `vmin` and their like) are left
/// alone: publishers differ in them.
///
/// # Errors
/// [`NotCalib`] says what is missing or wrong.
pub fn decode(bytes: &[u8]) -> Result<MiddleburyCalib, NotCalib> {
    let mut values = BTreeMap::new();
    for (number, line) in (1..).zip(toml_text::text(bytes)?.lines()) {
        if line.trim().is_empty() {
            continue;
        }
        let (key, value) = line.split_once('=').ok_or(NotCalib::Line(number))?;
        values.insert(key.trim(), (number, value.trim()));
    }
    let calib = Values(values);
    let left = calib.camera("cam0")?;
    let right = calib.camera("cam1")?;
    let doffs_px: f64 = calib.number("doffs")?;
    let apart_px = right.principal_point_px.0 - left.principal_point_px.0;
    let agrees = (doffs_px - apart_px).abs() <= SAME_OFFSET_PX;
    if !agrees {
        return Err(NotCalib::Offset { doffs_px, apart_px });
    }
    let baseline_mm: f64 = calib.number("baseline")?;
    Ok(MiddleburyCalib {
        rig: StereoRig::parallel(Binocular { left, right }, baseline_mm / 1000.0)?,
        size: Size {
            width: calib.number("width")?,
            height: calib.number("height")?,
        },
    })
}

/// The values by their keys, each with its line.
struct Values<'a>(BTreeMap<&'a str, (usize, &'a str)>);

impl Values<'_> {
    fn value(&self, key: &'static str) -> Result<(usize, &str), NotCalib> {
        self.0.get(key).copied().ok_or(NotCalib::Missing(key))
    }

    fn number<N: std::str::FromStr>(&self, key: &'static str) -> Result<N, NotCalib> {
        let (line, value) = self.value(key)?;
        let number = value.parse();
        number.map_err(|_| wrong(key, (line, value), "a number"))
    }

    /// A camera matrix `[fx 0 cx; 0 fy cy; 0 0 1]`.
    fn camera(&self, key: &'static str) -> Result<CameraIntrinsics, NotCalib> {
        let (line, value) = self.value(key)?;
        let numbers: Option<Vec<f64>> = value
            .strip_prefix('[')
            .and_then(|rest| rest.strip_suffix(']'))
            .and_then(|matrix| {
                let words = matrix.split([' ', ';', ',', '\t']);
                let words = words.filter(|word| !word.is_empty()).take(10);
                words.map(|word| word.parse().ok()).collect()
            });
        let camera = numbers.as_deref().and_then(camera_matrix::camera);
        camera.ok_or_else(|| {
            wrong(
                key,
                (line, value),
                "a camera without skew, [f 0 cx; 0 f cy; 0 0 1],",
            )
        })
    }
}

fn wrong(key: &'static str, (line, value): (usize, &str), wanted: &'static str) -> NotCalib {
    NotCalib::Value {
        line,
        key,
        value: value.chars().take(60).collect(),
        wanted,
    }
}

/// Why a rig goes into no `calib.txt`.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotRectified {
    /// Its eyes are not parallel pinholes.
    #[error(
        "a calib.txt holds parallel pinholes of one focal length; rectify the pair first (dorsal rig \
         rectify), or write another format"
    )]
    Rig,
    /// It does not say how large its pictures are.
    #[error("the rig does not say how large its pictures are: give size_px, or --size")]
    Size,
}

/// The `calib.txt` of a parallel rig, lengths in millimetres.
///
/// # Errors
/// [`NotRectified`] if the rig is none of these.
pub fn encode(rig: &StereoRig, size: Option<Size>) -> Result<Vec<u8>, NotRectified> {
    let Binocular { left, right } = rig.intrinsics();
    if !rig.is_rectified() {
        return Err(NotRectified::Rig);
    }
    let size = size.ok_or(NotRectified::Size)?;
    let camera = |camera: CameraIntrinsics| {
        let ((fx, fy), (cx, cy)) = (camera.focal_px, camera.principal_point_px);
        format!("[{fx} 0 {cx}; 0 {fy} {cy}; 0 0 1]")
    };
    let text = format!(
        "cam0={}\ncam1={}\ndoffs={}\nbaseline={}\nwidth={}\nheight={}\n",
        camera(left),
        camera(right),
        right.principal_point_px.0 - left.principal_point_px.0,
        millimetres(rig.baseline_m()),
        size.width,
        size.height
    );
    Ok(text.into_bytes())
}

/// The number of millimetres that is read back as exactly these metres, if one of the nearest three
/// is.
fn millimetres(metres: f64) -> f64 {
    let nearest = metres * 1000.0;
    [nearest, nearest.next_down(), nearest.next_up()]
        .into_iter()
        .find(|millimetres| millimetres / 1000.0 == metres)
        .unwrap_or(nearest)
}

/// Writes a `calib.txt`, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(
    path: impl AsRef<Path>,
    rig: &StereoRig,
    size: Option<Size>,
) -> Result<(), Unwritable<NotRectified>> {
    file::write(path.as_ref(), encode(rig, size))
}

/// Reads a `calib.txt`; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<MiddleburyCalib, Unreadable<NotCalib>> {
    file::read(path.as_ref(), decode)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "cam0=[994.978 0 311.193; 0 994.978 254.877; 0 0 1]\n\
        cam1=[994.978 0 342.279; 0 994.978 254.877; 0 0 1]\n\
        doffs=31.086\nbaseline=193.001\nwidth=741\nheight=500\nndisp=70\n";

    #[test]
    fn a_published_file_is_a_rig_in_metres() {
        let calib = decode(TEXT.as_bytes()).unwrap();
        assert!((calib.rig.baseline_m() - 0.193_001).abs() < 1e-12);
        assert_eq!(
            calib.rig.intrinsics().right.principal_point_px,
            (342.279, 254.877)
        );
        assert_eq!(
            calib.size,
            Size {
                width: 741,
                height: 500
            }
        );
    }

    #[test]
    fn refusals_say_what() {
        let refused = |from, to| decode(TEXT.replace(from, to).as_bytes()).unwrap_err();
        assert_eq!(
            refused("baseline=193.001\n", ""),
            NotCalib::Missing("baseline")
        );
        assert_eq!(refused("ndisp=70", "ndisp"), NotCalib::Line(7));
        assert!(matches!(
            refused("doffs=31.086", "doffs=3"),
            NotCalib::Offset { .. }
        ));
        assert!(matches!(
            refused("[994.978 0 311", "[994.978 1 311"),
            NotCalib::Value { line: 1, .. }
        ));
        let words = refused("baseline=193.001", "baseline=long").to_string();
        assert!(words.contains("line 4: baseline is 'long'"), "{words}");
        assert!(matches!(
            refused("193.001", "-1"),
            NotCalib::Rig(BadRig::Baseline(_))
        ));
    }
}
