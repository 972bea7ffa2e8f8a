use v1_gabor::Binocular;

use crate::eye::Eye;
use crate::rotation::Rotation;
use crate::{CameraIntrinsics, Head, Observer, Position};

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
    /// A focal length is not positive and finite.
    #[error("a camera with focal length ({0}, {1}) px forms no image")]
    Focal(f64, f64),
    /// A principal point is not finite.
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
            if pan.is_nan() || pan.abs() >= std::f64::consts::FRAC_PI_2 {
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
        if tilt_rad.is_nan() || tilt_rad.abs() >= std::f64::consts::FRAC_PI_2 {
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

    /// The two eyes in their places: half a baseline to either side of the head's origin, each
    /// turned about the vertical by its pan.
    #[must_use]
    pub fn eyes(&self) -> Binocular<Eye> {
        let half_m = self.baseline_m / 2.0;
        let eye = |intrinsics, pan_rad, x_m| Eye {
            intrinsics,
            rotation: Rotation::from_vector([0.0, pan_rad, 0.0]),
            centre: Position::new(x_m, 0.0, 0.0),
        };
        Binocular {
            left: eye(self.intrinsics.left, self.pan_rad.left, -half_m),
            right: eye(self.intrinsics.right, self.pan_rad.right, half_m),
        }
    }

    /// The pixels `(u, v)` at which a point appears to the two eyes; `None` if it lies beside or
    /// behind either. The pixels may lie outside the images.
    ///
    /// Triangulating `dx = u_right - u_left` at the left pixel gives the point's depth back.
    #[must_use]
    pub fn project(&self, point: Position<Head>) -> Option<Binocular<(f64, f64)>> {
        let eyes = self.eyes();
        Some(Binocular {
            left: eyes.left.project(point)?,
            right: eyes.right.project(point)?,
        })
    }

    /// The point at a depth along the line of sight of a pixel `(x, y)` of the left image.
    ///
    /// `depth_m` is the z of the head frame, as a [`DepthMap`](crate::DepthMap) holds it. `None`
    /// if that line of sight does not point forward, as no pixel's does for which a depth was
    /// triangulated with this rig.
    #[must_use]
    pub fn back_project(&self, pixel: (f64, f64), depth_m: f64) -> Option<Position<Head>> {
        let ray = self.eyes().left.ray(pixel);
        let [x, y, z] = ray.direction;
        (z > 0.0).then(|| {
            let stretch = depth_m / z;
            Position::new(ray.origin.x_m + stretch * x, stretch * y, depth_m)
        })
    }

    /// The same point seen from the level observer: the head's tilt undone.
    #[must_use]
    pub fn to_observer(&self, point: Position<Head>) -> Position<Observer> {
        Position::from_array(self.head_to_observer().apply(point.to_array()))
    }

    /// The same point seen from the tilted head: the inverse of [`StereoRig::to_observer`].
    #[must_use]
    pub fn to_head(&self, point: Position<Observer>) -> Position<Head> {
        Position::from_array(self.head_to_observer().apply_inverse(point.to_array()))
    }

    /// The turn from head to observer: looking up takes the head's forward axis toward -y.
    pub(crate) fn head_to_observer(&self) -> Rotation {
        Rotation::from_vector([self.tilt_rad, 0.0, 0.0])
    }
}
