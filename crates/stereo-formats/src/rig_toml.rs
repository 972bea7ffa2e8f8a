//! Our own `rig.toml`: two cameras on a baseline.
//!
//! ```toml
//! baseline_m = 0.193001
//! doffs_px = 31.086                       # parallel eyes: cx_right - cx_left
//! # or, for eyes that turn: pan_left_deg and pan_right_deg, or vergence_deg shared evenly
//! tilt_deg = 0.0                          # of the head; positive looks up
//!
//! [left]
//! focal_px = 994.978                      # or [fx, fy]
//! principal_point_px = [311.193, 254.877]
//!
//! [right]                                 # what is left out is as in [left]
//! focal_px = 994.978
//! ```

use std::path::Path;

use egocentric_depth::{BadRig, CameraIntrinsics, StereoRig};
use serde::{Deserialize, Serialize};
use v1_gabor::Binocular;

use crate::file::{self, Unreadable, Unwritable};
use crate::toml_text::{self, NotToml};

/// How far two spellings of one offset may differ, in pixels: publishers round to a thousandth,
/// and three rounded numbers meet.
pub(crate) const SAME_OFFSET_PX: f64 = 0.002;

/// Why a text is not a rig.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NotARig {
    /// The text is not the TOML that is read here.
    #[error("{0}\nA rig file has baseline_m and [left] with focal_px and principal_point_px.")]
    Toml(#[from] NotToml),
    /// Two keys say different things about one angle.
    #[error("it has vergence_deg and {0}; give the vergence or both pans, not both")]
    TwoAngles(&'static str),
    /// One pan without the other.
    #[error("it has {has} and no {lacks}; a rig with pans needs both")]
    OnePan {
        /// The key that is there.
        has: &'static str,
        /// The key that is not.
        lacks: &'static str,
    },
    /// An offset of principal points for eyes that turn.
    #[error("it has doffs_px, which belongs to parallel eyes, and eyes that turn")]
    TurnedOffset,
    /// The offset contradicts the principal points.
    #[error(
        "doffs_px = {doffs_px} contradicts the principal points, which lie {apart_px} px apart; \
         leave one of them out"
    )]
    Offset {
        /// The offset as given, in pixels.
        doffs_px: f64,
        /// `cx_right - cx_left` of the principal points, in pixels.
        apart_px: f64,
    },
    /// The numbers describe no rig.
    #[error(transparent)]
    Rig(#[from] BadRig),
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Text {
    baseline_m: f64,
    doffs_px: Option<f64>,
    pan_left_deg: Option<f64>,
    pan_right_deg: Option<f64>,
    vergence_deg: Option<f64>,
    tilt_deg: Option<f64>,
    left: LeftEye,
    right: Option<RightEye>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct LeftEye {
    focal_px: Focal,
    principal_point_px: [f64; 2],
}

#[derive(Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct RightEye {
    focal_px: Option<Focal>,
    principal_point_px: Option<[f64; 2]>,
}

#[derive(Clone, Copy, Deserialize, Serialize)]
#[serde(
    untagged,
    expecting = "a focal length is a number or [fx, fy], in pixels"
)]
enum Focal {
    Square(f64),
    Oblong([f64; 2]),
}

impl Focal {
    fn of((fx, fy): (f64, f64)) -> Self {
        if fx == fy {
            Self::Square(fx)
        } else {
            Self::Oblong([fx, fy])
        }
    }

    const fn lengths(self) -> (f64, f64) {
        match self {
            Self::Square(focal) => (focal, focal),
            Self::Oblong([fx, fy]) => (fx, fy),
        }
    }
}

/// Decodes a rig.
///
/// # Errors
/// [`NotARig`] says what is missing, unknown, contradictory or impossible.
pub fn decode(bytes: &[u8]) -> Result<StereoRig, NotARig> {
    let text: Text = toml_text::decode(bytes)?;
    let pan_rad = pans(&text)?;
    if text.doffs_px.is_some() && (pan_rad.left != 0.0 || pan_rad.right != 0.0) {
        return Err(NotARig::TurnedOffset);
    }

    let [cx, cy] = text.left.principal_point_px;
    let left = CameraIntrinsics {
        focal_px: text.left.focal_px.lengths(),
        principal_point_px: (cx, cy),
    };
    let right_eye = text.right.unwrap_or_default();
    let right_point = match (right_eye.principal_point_px, text.doffs_px) {
        (None, doffs_px) => (cx + doffs_px.unwrap_or(0.0), cy),
        (Some([right_cx, right_cy]), doffs_px) => {
            let apart_px = right_cx - cx;
            let agrees = |doffs_px: f64| (doffs_px - apart_px).abs() <= SAME_OFFSET_PX;
            if let Some(doffs_px) = doffs_px.filter(|&doffs_px| !agrees(doffs_px)) {
                return Err(NotARig::Offset { doffs_px, apart_px });
            }
            (right_cx, right_cy)
        }
    };
    let right = CameraIntrinsics {
        focal_px: right_eye.focal_px.map_or(left.focal_px, Focal::lengths),
        principal_point_px: right_point,
    };
    let rig = StereoRig::vergent(Binocular { left, right }, text.baseline_m, pan_rad)?;
    Ok(rig.tilted(text.tilt_deg.unwrap_or(0.0).to_radians())?)
}

/// The pan of each eye, in radians; a vergence is shared evenly, as by eyes that look straight on.
fn pans(text: &Text) -> Result<Binocular<f64>, NotARig> {
    const LEFT: &str = "pan_left_deg";
    const RIGHT: &str = "pan_right_deg";
    let pans_deg = match (text.pan_left_deg, text.pan_right_deg, text.vergence_deg) {
        (Some(_), _, Some(_)) => return Err(NotARig::TwoAngles(LEFT)),
        (None, Some(_), Some(_)) => return Err(NotARig::TwoAngles(RIGHT)),
        (None, None, vergence_deg) => {
            let half = vergence_deg.unwrap_or(0.0) / 2.0;
            Binocular {
                left: half,
                // Subtracted from zero, so that no turn is 0 and not -0.
                right: 0.0 - half,
            }
        }
        (Some(left), Some(right), None) => Binocular { left, right },
        (has, ..) => {
            let (has, lacks) = if has.is_some() {
                (LEFT, RIGHT)
            } else {
                (RIGHT, LEFT)
            };
            return Err(NotARig::OnePan { has, lacks });
        }
    };
    Ok(pans_deg.map(f64::to_radians))
}

/// Reads a rig; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<StereoRig, Unreadable<NotARig>> {
    file::read(path.as_ref(), decode)
}

/// The TOML text of a rig: both eyes in full, and the pans if an eye turns.
///
/// Angles are written in degrees and come back within a rounding error, all other numbers exactly.
///
/// # Errors
/// [`NotARig::Toml`] if the text cannot be made, which no rig is known to cause.
pub fn encode(rig: &StereoRig) -> Result<Vec<u8>, NotARig> {
    let Binocular { left, right } = rig.intrinsics();
    let point = |eye: CameraIntrinsics| [eye.principal_point_px.0, eye.principal_point_px.1];
    let pan_rad = rig.pan_rad();
    let turned = |rad: f64, any: bool| any.then(|| rad.to_degrees());
    let panned = pan_rad.left != 0.0 || pan_rad.right != 0.0;
    Ok(toml_text::encode(&Text {
        baseline_m: rig.baseline_m(),
        doffs_px: None,
        pan_left_deg: turned(pan_rad.left, panned),
        pan_right_deg: turned(pan_rad.right, panned),
        vergence_deg: None,
        tilt_deg: turned(rig.tilt_rad(), rig.tilt_rad() != 0.0),
        left: LeftEye {
            focal_px: Focal::of(left.focal_px),
            principal_point_px: point(left),
        },
        right: Some(RightEye {
            focal_px: Some(Focal::of(right.focal_px)),
            principal_point_px: Some(point(right)),
        }),
    })?)
}

/// Writes a rig, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(path: impl AsRef<Path>, rig: &StereoRig) -> Result<(), Unwritable<NotARig>> {
    file::write(path.as_ref(), encode(rig))
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEFT: &str = "[left]\nfocal_px = 500\nprincipal_point_px = [320.0, 240.0]\n";

    fn of(head: &str, tail: &str) -> Result<StereoRig, NotARig> {
        decode(format!("baseline_m = 0.1\n{head}\n{LEFT}{tail}").as_bytes())
    }

    #[test]
    fn the_right_eye_is_as_the_left_one() {
        let rig = of("", "").unwrap();
        assert_eq!(rig.intrinsics().left, rig.intrinsics().right);
        assert_eq!(rig.intrinsics().left.focal_px, (500.0, 500.0));
        assert_eq!(
            (rig.baseline_m(), rig.vergence_rad(), rig.tilt_rad()),
            (0.1, 0.0, 0.0)
        );
        let oblong = of("", "[right]\nfocal_px = [501.0, 502.0]\n").unwrap();
        assert_eq!(oblong.intrinsics().right.focal_px, (501.0, 502.0));
        assert_eq!(oblong.intrinsics().right.principal_point_px, (320.0, 240.0));
    }

    #[test]
    fn an_offset_moves_the_right_principal_point() {
        let rig = of("doffs_px = 31.0", "").unwrap();
        assert_eq!(rig.intrinsics().right.principal_point_px, (351.0, 240.0));
        let right = "[right]\nprincipal_point_px = [350.0, 240.0]\n";
        assert!(of("doffs_px = 30.0", right).is_ok());
        let offset = NotARig::Offset {
            doffs_px: 31.0,
            apart_px: 30.0,
        };
        assert_eq!(of("doffs_px = 31.0", right), Err(offset));
        assert!(matches!(
            of("doffs_px = nan", right),
            Err(NotARig::Offset { .. })
        ));
        assert_eq!(
            of("doffs_px = 3\nvergence_deg = 4", ""),
            Err(NotARig::TurnedOffset)
        );
    }

    #[test]
    fn angles_are_degrees_and_said_once() {
        let rig = of("vergence_deg = 8.0\ntilt_deg = -30.0", "").unwrap();
        assert!((rig.pan_rad().left - 4f64.to_radians()).abs() < 1e-15);
        assert!((rig.pan_rad().right + 4f64.to_radians()).abs() < 1e-15);
        assert!((rig.tilt_rad() + 30f64.to_radians()).abs() < 1e-15);
        assert_eq!(
            of("vergence_deg = 8\npan_right_deg = 1", ""),
            Err(NotARig::TwoAngles("pan_right_deg"))
        );
        let has = "pan_left_deg";
        assert_eq!(
            of("pan_left_deg = 8", ""),
            Err(NotARig::OnePan {
                has,
                lacks: "pan_right_deg"
            })
        );
        let parting = of("pan_left_deg = -1\npan_right_deg = 1", "");
        assert!(matches!(parting, Err(NotARig::Rig(BadRig::Vergence(_)))));
    }

    #[test]
    fn what_is_unknown_is_refused_with_its_line() {
        let unknown = of("base_line = 3", "").unwrap_err().to_string();
        assert!(
            unknown.contains("base_line") && unknown.contains("line 2"),
            "{unknown}"
        );
        let focal =
            decode(b"baseline_m = 1\n[left]\nfocal_px = \"5\"\nprincipal_point_px = [1, 2]");
        assert!(
            focal
                .unwrap_err()
                .to_string()
                .contains("a number or [fx, fy]")
        );
        let nan = of("", "[right]\nfocal_px = nan\n");
        assert!(matches!(nan, Err(NotARig::Rig(BadRig::Focal(..)))));
    }
}
