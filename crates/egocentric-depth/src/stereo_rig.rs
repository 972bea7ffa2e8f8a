use v1_gabor::Binocular;

use crate::CameraIntrinsics;

/// Two eyes on one baseline.
///
/// The head frame has its origin midway between the eyes, x to the right along the baseline,
/// y down and z forward. Each eye is turned about y by its pan (positive toward +x); the whole
/// head is turned about x by its tilt (positive looks up) against the level observer frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StereoRig {
    intrinsics: Binocular<CameraIntrinsics>,
    baseline_m: f64,
    pan_rad: Binocular<f64>,
    tilt_rad: f64,
}

/// Why a head with these eyes sees no depth.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BadRig {
    /// Both eyes sit in one point, or nowhere.
    #[error("a baseline of {0} m gives no parallax; it must be positive and finite")]
    Baseline(f64),
    /// A focal length is not a positive number, or a principal point is not a number.
    #[error("a camera with focal length ({0}, {1}) px forms no image")]
    Focal(f64, f64),
    /// The principal point is not a number.
    #[error("a principal point at ({0}, {1}) px is nowhere")]
    PrincipalPoint(f64, f64),
    /// The lines of sight part in front of the head.
    #[error("lines of sight that part by {0} rad meet nowhere in front of the head")]
    Vergence(f64),
    /// An eye looks backwards, or an angle is not a number.
    #[error("an angle of {0} rad is beyond a right angle, or no number")]
    Angle(f64),
}

impl StereoRig {
    /// A rig of two parallel eyes. Their principal points may differ: `doffs = cx_right - cx_left`.
    ///
    /// # Errors
    /// [`BadRig`] says which value cannot be.
    pub fn parallel(
        intrinsics: Binocular<CameraIntrinsics>,
        baseline_m: f64,
    ) -> Result<Self, BadRig> {
        Self::vergent(
            intrinsics,
            baseline_m,
            Binocular {
                left: 0.0,
                right: 0.0,
            },
        )
    }

    /// A rig whose eyes are panned toward each other: `pan_rad.left >= pan_rad.right`.
    ///
    /// # Errors
    /// [`BadRig`] says which value cannot be.
    pub fn vergent(
        intrinsics: Binocular<CameraIntrinsics>,
        baseline_m: f64,
        pan_rad: Binocular<f64>,
    ) -> Result<Self, BadRig> {
        if !(baseline_m.is_finite() && baseline_m > 0.0) {
            return Err(BadRig::Baseline(baseline_m));
        }
        for eye in [intrinsics.left, intrinsics.right] {
            let (fx, fy) = eye.focal_px;
            if !(fx.is_finite() && fy.is_finite() && fx > 0.0 && fy > 0.0) {
                return Err(BadRig::Focal(fx, fy));
            }
            let (cx, cy) = eye.principal_point_px;
            if !(cx.is_finite() && cy.is_finite()) {
                return Err(BadRig::PrincipalPoint(cx, cy));
            }
        }
        for pan in [pan_rad.left, pan_rad.right] {
            if !(pan.abs() < std::f64::consts::FRAC_PI_2) {
                return Err(BadRig::Angle(pan));
            }
        }
        let vergence = pan_rad.left - pan_rad.right;
        if vergence < 0.0 {
            return Err(BadRig::Vergence(vergence));
        }
        Ok(Self {
            intrinsics,
            baseline_m,
            pan_rad,
            tilt_rad: 0.0,
        })
    }

    /// The same rig with the whole head turned up by `tilt_rad` (negative looks down).
    ///
    /// # Errors
    /// [`BadRig::Angle`] if the head would look straight up, straight down or backwards.
    pub fn tilted(self, tilt_rad: f64) -> Result<Self, BadRig> {
        if !(tilt_rad.abs() < std::f64::consts::FRAC_PI_2) {
            return Err(BadRig::Angle(tilt_rad));
        }
        Ok(Self { tilt_rad, ..self })
    }

    /// The two cameras.
    #[must_use]
    pub const fn intrinsics(&self) -> Binocular<CameraIntrinsics> {
        self.intrinsics
    }

    /// Distance between the eyes, in metres.
    #[must_use]
    pub const fn baseline_m(&self) -> f64 {
        self.baseline_m
    }

    /// Pan of each eye about the head's vertical, in radians, positive toward +x.
    #[must_use]
    pub const fn pan_rad(&self) -> Binocular<f64> {
        self.pan_rad
    }

    /// Tilt of the head, in radians, positive upwards.
    #[must_use]
    pub const fn tilt_rad(&self) -> f64 {
        self.tilt_rad
    }

    /// The angle between the two lines of sight, in radians, positive when they meet in front.
    #[must_use]
    pub fn vergence_rad(&self) -> f64 {
        self.pan_rad.left - self.pan_rad.right
    }
}
