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
//!
//! A measured rig says of each eye which way it looks, instead of the pans above, and what its lens
//! bends; a calibrated one says how well it is known:
//!
//! ```toml
//! baseline_m = 0.12
//! size_px = [640, 480]                    # of the pictures it belongs to
//! slip = [0.001, -0.002]                  # of the right eye: down and forward, in baselines
//!
//! [left]
//! focal_px = [532.8, 532.9]
//! principal_point_px = [342.5, 233.9]
//! pan_deg = 0.2                           # toward +x; tilt_deg is up, torsion_deg clockwise
//! distortion = [-0.28, 0.03, 0.0, 0.0, 0.16]   # k1 k2 p1 p2 k3 [k4 k5 k6]; or fisheye = [4 terms]
//!
//! [right]
//! tilt_deg = 0.4
//! torsion_deg = -0.2
//!
//! [sigma]                                 # one standard deviation of the right eye's pose
//! pitch_deg = 0.01
//! yaw_deg = 0.2
//! ```

use std::path::Path;

use egocentric_depth::{Attitude, BadRig, CameraIntrinsics, Lens, RigDrift, StereoRig};
use serde::{Deserialize, Serialize};
use v1_gabor::{Binocular, Size};

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
    /// A lens of no known model.
    #[error(
        "{eye} has {terms} of a lens; distortion has 4, 5 or 8 numbers and fisheye 4, not both"
    )]
    Lens {
        /// The table it stands in.
        eye: &'static str,
        /// What is there.
        terms: String,
    },
    /// The numbers describe no rig.
    #[error(transparent)]
    Rig(#[from] BadRig),
}

/// A rig and the size of the pictures that its pixels are counted in, if it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizedRig {
    /// The rig.
    pub rig: StereoRig,
    /// Width and height of either picture.
    pub size: Option<Size>,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct Text {
    baseline_m: f64,
    size_px: Option<[usize; 2]>,
    slip: Option<[f64; 2]>,
    doffs_px: Option<f64>,
    pan_left_deg: Option<f64>,
    pan_right_deg: Option<f64>,
    vergence_deg: Option<f64>,
    tilt_deg: Option<f64>,
    left: LeftEye,
    right: Option<RightEye>,
    sigma: Option<SigmaText>,
}

/// One standard deviation of each number of the right eye's pose; what is left out is exact.
#[derive(Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields, default)]
struct SigmaText {
    pitch_deg: f64,
    yaw_deg: f64,
    roll_deg: f64,
    down: f64,
    forward: f64,
}

#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct LeftEye {
    focal_px: Focal,
    principal_point_px: [f64; 2],
    pan_deg: Option<f64>,
    tilt_deg: Option<f64>,
    torsion_deg: Option<f64>,
    distortion: Option<Vec<f64>>,
    fisheye: Option<Vec<f64>>,
}

#[derive(Default, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct RightEye {
    focal_px: Option<Focal>,
    principal_point_px: Option<[f64; 2]>,
    pan_deg: Option<f64>,
    tilt_deg: Option<f64>,
    torsion_deg: Option<f64>,
    distortion: Option<Vec<f64>>,
    fisheye: Option<Vec<f64>>,
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
    Ok(decode_sized(bytes)?.rig)
}

/// Decodes a rig and the size of its pictures, if it says one.
///
/// # Errors
/// [`NotARig`] says what is missing, unknown, contradictory or impossible.
pub fn decode_sized(bytes: &[u8]) -> Result<SizedRig, NotARig> {
    let text: Text = toml_text::decode(bytes)?;
    let own = text.attitudes();
    let pan_rad = pans(&text)?;
    let turned = own.is_some() || pan_rad.left != 0.0 || pan_rad.right != 0.0;
    if text.doffs_px.is_some() && turned {
        return Err(NotARig::TurnedOffset);
    }
    if own.is_some() && (text.vergence_deg.is_some() || text.pan_left_deg.is_some()) {
        return Err(NotARig::TwoAngles(
            "pan_deg, tilt_deg or torsion_deg of an eye",
        ));
    }

    let [cx, cy] = text.left.principal_point_px;
    let left = CameraIntrinsics {
        focal_px: text.left.focal_px.lengths(),
        principal_point_px: (cx, cy),
    };
    let left_lens = lens("[left]", &text.left.distortion, &text.left.fisheye)?;
    let right_eye = text.right.unwrap_or_default();
    let right_lens = lens("[right]", &right_eye.distortion, &right_eye.fisheye)?;
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
    let eyes = Binocular { left, right };
    let rig = match own {
        Some(attitude) => StereoRig::aimed(eyes, text.baseline_m, attitude)?,
        None => StereoRig::vergent(eyes, text.baseline_m, pan_rad)?,
    };
    let [down, forward] = text.slip.unwrap_or_default();
    let sigma = text.sigma.unwrap_or_default();
    let left_lens = left_lens.unwrap_or_default();
    Ok(SizedRig {
        rig: rig
            .tilted(text.tilt_deg.unwrap_or(0.0).to_radians())?
            .slipped((down, forward))?
            .with_lenses(Binocular {
                left: left_lens,
                right: right_lens.unwrap_or(left_lens),
            })?
            .with_sigma(RigDrift {
                pitch_rad: sigma.pitch_deg.to_radians(),
                yaw_rad: sigma.yaw_deg.to_radians(),
                roll_rad: sigma.roll_deg.to_radians(),
                down: sigma.down,
                forward: sigma.forward,
            })?,
        size: text.size_px.map(|[width, height]| Size { width, height }),
    })
}

impl Text {
    /// Which way the eyes look, if a table of either says so.
    fn attitudes(&self) -> Option<Binocular<Attitude>> {
        let attitude = |degrees: [Option<f64>; 3]| {
            let [pan_rad, tilt_rad, torsion_rad] =
                degrees.map(|degrees| degrees.unwrap_or(0.0).to_radians());
            Attitude {
                pan_rad,
                tilt_rad,
                torsion_rad,
            }
        };
        let left = [self.left.pan_deg, self.left.tilt_deg, self.left.torsion_deg];
        let right = self.right.as_ref().map_or([None; 3], |right| {
            [right.pan_deg, right.tilt_deg, right.torsion_deg]
        });
        let said = left.iter().chain(&right).any(Option::is_some);
        said.then(|| Binocular {
            left: attitude(left),
            right: attitude(right),
        })
    }
}

/// The lens that an eye's table tells of; `None` if it tells of none.
fn lens(
    eye: &'static str,
    distortion: &Option<Vec<f64>>,
    fisheye: &Option<Vec<f64>>,
) -> Result<Option<Lens>, NotARig> {
    let no_lens = |terms: String| Err(NotARig::Lens { eye, terms });
    match (distortion.as_deref(), fisheye.as_deref()) {
        (None, None) => Ok(None),
        (Some(_), Some(_)) => no_lens("both models".to_owned()),
        (Some(terms), None) => match brown_conrady(terms) {
            Some(lens) => Ok(Some(lens)),
            None => no_lens(format!("{} terms", terms.len())),
        },
        (None, Some(&[k1, k2, k3, k4])) => Ok(Some(Lens::Fisheye([k1, k2, k3, k4]))),
        (None, Some(terms)) => no_lens(format!("{} fisheye terms", terms.len())),
    }
}

/// A lens of Brown and Conrady by its terms in the order of OpenCV: none, 4, 5 or 8 of them; no
/// other number has a meaning here.
///
/// Formats without a name for a pinhole write it as terms of zero, so such a lens is a pinhole: a
/// rectified pair then is one, whichever file its rig came from.
pub(crate) fn brown_conrady(terms: &[f64]) -> Option<Lens> {
    let mut all = [0.0; 8];
    match terms.len() {
        0 => return Some(Lens::Pinhole),
        4 | 5 | 8 => all[..terms.len()].copy_from_slice(terms),
        _ => return None,
    }
    let bends = all.iter().any(|&term| term != 0.0);
    Some(if bends {
        Lens::BrownConrady(all)
    } else {
        Lens::Pinhole
    })
}

/// The terms of a lens in the order of OpenCV, as few as tell it.
pub(crate) fn brown_conrady_terms(terms: &[f64; 8]) -> &[f64] {
    match terms {
        [.., 0.0, 0.0, 0.0] => &terms[..5],
        _ => terms,
    }
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
    encode_sized(&SizedRig {
        rig: *rig,
        size: None,
    })
}

/// The TOML text of a rig and the size of its pictures; see [`encode`].
///
/// # Errors
/// [`NotARig::Toml`] if the text cannot be made, which no rig is known to cause.
pub fn encode_sized(SizedRig { rig, size }: &SizedRig) -> Result<Vec<u8>, NotARig> {
    let Binocular { left, right } = rig.intrinsics();
    let point = |eye: CameraIntrinsics| [eye.principal_point_px.0, eye.principal_point_px.1];
    let attitude = rig.attitude();
    // What a commanded head may be is written as one; all else as it was measured.
    let twists = |eye: Attitude| eye.tilt_rad != 0.0 || eye.torsion_rad != 0.0;
    let measured = twists(attitude.left) || twists(attitude.right) || rig.vergence_rad() < 0.0;
    let panned = attitude.left.pan_rad != 0.0 || attitude.right.pan_rad != 0.0;
    let angle = |rad: f64, said: bool| said.then(|| rad.to_degrees());
    let own = |rad: f64| angle(rad, measured && rad != 0.0);
    let lenses = rig.lenses();
    let bends = lenses.left != Lens::Pinhole || lenses.right != Lens::Pinhole;
    let distortion = |lens: Lens| match lens {
        Lens::Pinhole => bends.then(Vec::new),
        Lens::BrownConrady(terms) => Some(brown_conrady_terms(&terms).to_vec()),
        Lens::Fisheye(_) => None,
    };
    let fisheye = |lens: Lens| match lens {
        Lens::Fisheye(terms) => Some(terms.to_vec()),
        _ => None,
    };
    let sigma = rig.sigma();
    let [pitch, yaw, roll, ..] = sigma.to_array().map(f64::to_degrees);
    Ok(toml_text::encode(&Text {
        baseline_m: rig.baseline_m(),
        size_px: size.map(|size| [size.width, size.height]),
        slip: (rig.slip() != (0.0, 0.0)).then(|| [rig.slip().0, rig.slip().1]),
        doffs_px: None,
        pan_left_deg: angle(attitude.left.pan_rad, panned && !measured),
        pan_right_deg: angle(attitude.right.pan_rad, panned && !measured),
        vergence_deg: None,
        tilt_deg: angle(rig.tilt_rad(), rig.tilt_rad() != 0.0),
        left: LeftEye {
            focal_px: Focal::of(left.focal_px),
            principal_point_px: point(left),
            pan_deg: own(attitude.left.pan_rad),
            tilt_deg: own(attitude.left.tilt_rad),
            torsion_deg: own(attitude.left.torsion_rad),
            distortion: distortion(lenses.left),
            fisheye: fisheye(lenses.left),
        },
        right: Some(RightEye {
            focal_px: Some(Focal::of(right.focal_px)),
            principal_point_px: Some(point(right)),
            pan_deg: own(attitude.right.pan_rad),
            tilt_deg: own(attitude.right.tilt_rad),
            torsion_deg: own(attitude.right.torsion_rad),
            distortion: distortion(lenses.right),
            fisheye: fisheye(lenses.right),
        }),
        sigma: (sigma != RigDrift::default()).then_some(SigmaText {
            pitch_deg: pitch,
            yaw_deg: yaw,
            roll_deg: roll,
            down: sigma.down,
            forward: sigma.forward,
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

/// Writes a rig and the size of its pictures, whole or not at all; see [`encode_sized`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write_sized(path: impl AsRef<Path>, rig: &SizedRig) -> Result<(), Unwritable<NotARig>> {
    file::write(path.as_ref(), encode_sized(rig))
}

/// Reads a rig and the size of its pictures; see [`decode_sized`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read_sized(path: impl AsRef<Path>) -> Result<SizedRig, Unreadable<NotARig>> {
    file::read(path.as_ref(), decode_sized)
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
    fn a_measured_rig_may_part_and_bend() {
        let eyes = "[right]\npan_deg = 0.5\ntorsion_deg = -1\nfisheye = [0.1, 0, 0, 0]\n\
                    [sigma]\nyaw_deg = 0.2\n";
        let rig = of("slip = [0.01, 0.0]", eyes).unwrap();
        assert!((rig.vergence_rad() + 0.5f64.to_radians()).abs() < 1e-15);
        assert_eq!(rig.lenses().right, Lens::Fisheye([0.1, 0.0, 0.0, 0.0]));
        assert_eq!(
            (rig.lenses().left, rig.slip()),
            (Lens::Pinhole, (0.01, 0.0))
        );
        assert!((rig.sigma().yaw_rad - 0.2f64.to_radians()).abs() < 1e-15);
        assert_eq!(decode(&encode(&rig).unwrap()), Ok(rig));
        assert!(matches!(
            of("vergence_deg = 3", "[right]\npan_deg = 0.5\n"),
            Err(NotARig::TwoAngles(_))
        ));
        assert!(matches!(
            of("", "[right]\ndistortion = [1, 2, 3]\n"),
            Err(NotARig::Lens { eye: "[right]", .. })
        ));
        assert!(matches!(
            of("", "[right]\npan_deg = 6\n"),
            Err(NotARig::Rig(BadRig::Vergence(_)))
        ));
        assert!(matches!(
            of("", "[right]\ndistortion = [nan, 0, 0, 0, 0]\n"),
            Err(NotARig::Rig(BadRig::Lens(_)))
        ));
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
