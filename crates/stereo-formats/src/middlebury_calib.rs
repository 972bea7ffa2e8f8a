//! Middlebury's `calib.txt` (2014 and after, ETH3D too): a rectified pair, lengths in millimetres.

use std::collections::BTreeMap;
use std::path::Path;

use egocentric_depth::{BadRig, CameraIntrinsics, StereoRig};
use v1_gabor::{Binocular, Size};

use crate::file::{self, Unreadable};
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
    #[error("{key} is '{value}', and {wanted} is needed")]
    Value {
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
        values.insert(key.trim(), value.trim());
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

struct Values<'a>(BTreeMap<&'a str, &'a str>);

impl Values<'_> {
    fn text(&self, key: &'static str) -> Result<&str, NotCalib> {
        self.0.get(key).copied().ok_or(NotCalib::Missing(key))
    }

    fn number<N: std::str::FromStr>(&self, key: &'static str) -> Result<N, NotCalib> {
        let value = self.text(key)?;
        value.parse().map_err(|_| wrong(key, value, "a number"))
    }

    /// A camera matrix `[fx 0 cx; 0 fy cy; 0 0 1]`.
    fn camera(&self, key: &'static str) -> Result<CameraIntrinsics, NotCalib> {
        let value = self.text(key)?;
        let numbers: Option<Vec<f64>> = value
            .strip_prefix('[')
            .and_then(|rest| rest.strip_suffix(']'))
            .and_then(|matrix| {
                let words = matrix.split([' ', ';', ',', '\t']);
                let words = words.filter(|word| !word.is_empty()).take(10);
                words.map(|word| word.parse().ok()).collect()
            });
        match numbers.as_deref() {
            Some(&[fx, 0.0, cx, 0.0, fy, cy, 0.0, 0.0, 1.0]) => Ok(CameraIntrinsics {
                focal_px: (fx, fy),
                principal_point_px: (cx, cy),
            }),
            _ => Err(wrong(
                key,
                value,
                "a camera without skew, [f 0 cx; 0 f cy; 0 0 1],",
            )),
        }
    }
}

fn wrong(key: &'static str, value: &str, wanted: &'static str) -> NotCalib {
    NotCalib::Value {
        key,
        value: value.chars().take(60).collect(),
        wanted,
    }
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
            NotCalib::Value { .. }
        ));
        assert!(matches!(
            refused("193.001", "-1"),
            NotCalib::Rig(BadRig::Baseline(_))
        ));
    }
}
