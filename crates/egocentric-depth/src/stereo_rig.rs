use v1_gabor::Binocular;

use crate::eye::Eye;
use crate::rotation::{Rotation, cross, dot};
use crate::{Attitude, CameraIntrinsics, Head, Lens, Observer, Position, RelativePose, RigDrift};

/// Two eyes on one baseline.
///
/// The head frame has its origin midway between the eyes, x to the right along the baseline,
/// y down and z forward. Each eye has an [`Attitude`] in it: a parallel rig none, a vergent one two
/// pans, a full head tilt and torsion too. The whole head is turned about x by its tilt (positive
/// looks up) against the level observer frame.
///
/// Any two cameras that look roughly the same way are such a rig ([`StereoRig::from_pose`]), and so
/// is a rig whose right eye has slipped ([`StereoRig::drifted`]).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StereoRig {
    intrinsics: Binocular<CameraIntrinsics>,
    lenses: Binocular<Lens>,
    baseline_m: f64,
    attitude: Binocular<Attitude>,
    /// How far the right eye has slipped from the baseline: down and forward, in baselines.
    slip: (f64, f64),
    tilt_rad: f64,
    sigma: RigDrift,
}

/// Why a head with these eyes sees no depth.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BadRig {
    /// Both eyes sit in one point, or nowhere.
    #[error("a baseline of {0} m gives no parallax; it must be positive and finite")]
    Baseline(f64),
    /// A focal length is not positive and finite.
    #[error(
        "a camera with focal length ({0}, {1}) px forms no image; both must be positive and finite"
    )]
    Focal(f64, f64),
    /// A principal point is not finite.
    #[error("a principal point at ({0}, {1}) px is nowhere")]
    PrincipalPoint(f64, f64),
    /// The lines of sight part in front of the head.
    #[error(
        "lines of sight that part by {:.3} degrees meet nowhere in front of the head; the left eye's pan \
         must be the larger one, positive to the right",
        -.0.to_degrees()
    )]
    Vergence(f64),
    /// An eye looks backwards, or an angle is not a number.
    #[error("an angle of {:.3} degrees is beyond a right angle, or no number", .0.to_degrees())]
    Angle(f64),
    /// A lens has a coefficient that is not finite.
    #[error("a lens with the coefficient {0} bends nothing known; it must be finite")]
    Lens(f64),
    /// The cameras were given in the wrong order.
    #[error(
        "the right camera stands {0} m to the left of the left one; are the cameras exchanged, or \
         is the pose that of the left camera?"
    )]
    Exchanged(f64),
    /// The right eye is not beside the left one.
    #[error("a right eye that slipped by {0} baselines is beside the left one no more")]
    Slip(f64),
    /// An uncertainty is negative or not finite.
    #[error("a standard deviation of {0} of the pose is none; it must be finite and not negative")]
    Sigma(f64),
}

/// How far the lines of sight of a measured rig may part: real cameras that were mounted parallel
/// part by a degree or two and still see depth at all but the greatest distances.
const MOST_PARTING_RAD: f64 = 5.0 * std::f64::consts::PI / 180.0;

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
        let vergence = pan_rad.left - pan_rad.right;
        if vergence < 0.0 {
            return Err(BadRig::Vergence(vergence));
        }
        Self::aimed(intrinsics, baseline_m, pan_rad.map(Attitude::panned))
    }

    /// A rig whose eyes have any attitude: a pan-tilt-vergence head with torsion, or a rig as it was
    /// measured.
    ///
    /// A measured rig may part by five degrees, which two cameras mounted parallel by hand do; a
    /// head that is told to verge ([`StereoRig::vergent`]) may not part at all.
    ///
    /// # Errors
    /// [`BadRig`] says which value cannot be.
    pub fn aimed(
        intrinsics: Binocular<CameraIntrinsics>,
        baseline_m: f64,
        attitude: Binocular<Attitude>,
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
        let [pan, tilt, _] = attitude.left.to_array();
        let [right_pan, right_tilt, _] = attitude.right.to_array();
        for angle in [pan, tilt, right_pan, right_tilt] {
            if angle.is_nan() || angle.abs() >= std::f64::consts::FRAC_PI_2 {
                return Err(BadRig::Angle(angle));
            }
        }
        for torsion in [attitude.left.torsion_rad, attitude.right.torsion_rad] {
            if torsion.is_nan() || torsion.abs() > std::f64::consts::PI {
                return Err(BadRig::Angle(torsion));
            }
        }
        let vergence = pan - right_pan;
        if vergence < -MOST_PARTING_RAD {
            return Err(BadRig::Vergence(vergence));
        }
        Ok(Self {
            intrinsics,
            lenses: Binocular {
                left: Lens::Pinhole,
                right: Lens::Pinhole,
            },
            baseline_m,
            attitude,
            slip: (0.0, 0.0),
            tilt_rad: 0.0,
            sigma: RigDrift::default(),
        })
    }

    /// Two cameras that stand to one another as a calibration file says. The head frame lies along
    /// their baseline and looks where both look in the mean.
    ///
    /// # Errors
    /// [`BadRig`] says which value cannot be.
    pub fn from_pose(
        intrinsics: Binocular<CameraIntrinsics>,
        pose: &RelativePose,
    ) -> Result<Self, BadRig> {
        let right_in_left = pose.inverse().translation_m;
        let baseline_m = dot(right_in_left, right_in_left).sqrt();
        if !(baseline_m.is_finite() && baseline_m > 0.0) {
            return Err(BadRig::Baseline(baseline_m));
        }
        let across = right_in_left.map(|metres| metres / baseline_m);
        if across[0] < 0.0 {
            return Err(BadRig::Exchanged(-right_in_left[0]));
        }
        let right_axis = pose.rotation.apply_inverse([0.0, 0.0, 1.0]);
        let both = [right_axis[0], right_axis[1], right_axis[2] + 1.0];
        let along = dot(both, across);
        let ahead: [f64; 3] = std::array::from_fn(|i| both[i] - along * across[i]);
        let length = dot(ahead, ahead).sqrt();
        // Eyes that look along their baseline see no depth.
        if length.is_nan() || length < 1e-6 {
            return Err(BadRig::Angle(std::f64::consts::FRAC_PI_2));
        }
        let ahead = ahead.map(|component| component / length);
        let left = Rotation::of_axes([across, cross(ahead, across), ahead]);
        let right = left.after(&pose.rotation.inverse());
        Self::aimed(
            intrinsics,
            baseline_m,
            Binocular { left, right }.map(|rotation| Attitude::of(&rotation)),
        )
    }

    /// How the right camera stands to the left one: the inverse of [`StereoRig::from_pose`], but for
    /// the tilt of the head, which two cameras do not know of.
    #[must_use]
    pub fn relative_pose(&self) -> RelativePose {
        let Binocular { left, right } = self.eyes();
        RelativePose {
            rotation: right.rotation.inverse().after(&left.rotation),
            translation_m: right.coordinates(left.centre),
        }
    }

    /// The same rig with these lenses; the images it belongs to are then the distorted ones, as they
    /// were taken.
    ///
    /// # Errors
    /// [`BadRig::Lens`] if a coefficient is not finite.
    pub fn with_lenses(self, lenses: Binocular<Lens>) -> Result<Self, BadRig> {
        for lens in [lenses.left, lenses.right] {
            let wrong = lens.coefficients().iter().find(|term| !term.is_finite());
            if let Some(&wrong) = wrong {
                return Err(BadRig::Lens(wrong));
            }
        }
        Ok(Self { lenses, ..self })
    }

    /// The same rig, known to one standard deviation of each of these numbers: what encoders and a
    /// calibration promise. Every depth then carries the error of the pose with it.
    ///
    /// # Errors
    /// [`BadRig::Sigma`] if one is negative or not finite.
    pub fn with_sigma(self, sigma: RigDrift) -> Result<Self, BadRig> {
        match sigma
            .to_array()
            .into_iter()
            .find(|sigma| !(sigma.is_finite() && *sigma >= 0.0))
        {
            Some(wrong) => Err(BadRig::Sigma(wrong)),
            None => Ok(Self { sigma, ..self }),
        }
    }

    /// The same rig with its right eye where it has drifted to; the left one and the head frame
    /// stay.
    ///
    /// # Errors
    /// [`BadRig`] if no rig drifts as far.
    pub fn drifted(self, drift: &RigDrift) -> Result<Self, BadRig> {
        let slip = (self.slip.0 + drift.down, self.slip.1 + drift.forward);
        let right = Attitude::of(&drift.right_rotation(&self));
        let aimed = Self::aimed(
            self.intrinsics,
            self.baseline_m,
            Binocular {
                left: self.attitude.left,
                right,
            },
        )?;
        Self {
            attitude: aimed.attitude,
            ..self
        }
        .slipped(slip)
    }

    /// The same rig with its right eye down and forward by so many baselines.
    ///
    /// # Errors
    /// [`BadRig::Slip`] if that is as far as the eyes are apart.
    pub fn slipped(self, slip: (f64, f64)) -> Result<Self, BadRig> {
        for share in [slip.0, slip.1] {
            let beside = share.abs() < 1.0;
            if !beside {
                return Err(BadRig::Slip(share));
            }
        }
        Ok(Self { slip, ..self })
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

    /// What their lenses bend.
    #[must_use]
    pub const fn lenses(&self) -> Binocular<Lens> {
        self.lenses
    }

    /// Which way each eye looks in the head.
    #[must_use]
    pub const fn attitude(&self) -> Binocular<Attitude> {
        self.attitude
    }

    /// How far the right eye has slipped down and forward from the baseline, in baselines.
    #[must_use]
    pub const fn slip(&self) -> (f64, f64) {
        self.slip
    }

    /// One standard deviation of what is known of the right eye's pose; zeros if it is taken for
    /// exact.
    #[must_use]
    pub const fn sigma(&self) -> RigDrift {
        self.sigma
    }

    /// Distance between the eyes along the head's x axis, in metres.
    #[must_use]
    pub const fn baseline_m(&self) -> f64 {
        self.baseline_m
    }

    /// Pan of each eye about the head's vertical, in radians, positive toward +x.
    #[must_use]
    pub fn pan_rad(&self) -> Binocular<f64> {
        self.attitude.map(|attitude| attitude.pan_rad)
    }

    /// Whether what corresponds lies on one row of both images, as [`Rectification`](crate::Rectification)
    /// makes it: parallel pinholes of one focal length and one row of principal points.
    #[must_use]
    pub fn is_rectified(&self) -> bool {
        let (pan, eyes) = (self.pan_rad(), self.intrinsics());
        self.only_pans()
            && pan.left == 0.0
            && pan.right == 0.0
            && eyes.left.focal_px == eyes.right.focal_px
            && eyes.left.principal_point_px.1 == eyes.right.principal_point_px.1
    }

    /// Whether both eyes are pinholes on the baseline that do no more than pan: then the horizontal
    /// shift alone tells depth, row by row.
    #[must_use]
    pub fn only_pans(&self) -> bool {
        let pans = |eye: Attitude| eye.tilt_rad == 0.0 && eye.torsion_rad == 0.0;
        pans(self.attitude.left)
            && pans(self.attitude.right)
            && self.slip == (0.0, 0.0)
            && self.lenses.left == Lens::Pinhole
            && self.lenses.right == Lens::Pinhole
    }

    /// Tilt of the head, in radians, positive upwards.
    #[must_use]
    pub const fn tilt_rad(&self) -> f64 {
        self.tilt_rad
    }

    /// The angle between the two lines of sight, in radians, positive when they meet in front.
    #[must_use]
    pub fn vergence_rad(&self) -> f64 {
        let pan_rad = self.pan_rad();
        pan_rad.left - pan_rad.right
    }

    /// The two eyes in their places: half a baseline to either side of the head's origin, each
    /// turned by its attitude, the right one where it has slipped to.
    #[must_use]
    pub fn eyes(&self) -> Binocular<Eye> {
        let half_m = self.baseline_m / 2.0;
        let (down, forward) = self.slip;
        Binocular {
            left: Eye {
                intrinsics: self.intrinsics.left,
                lens: self.lenses.left,
                rotation: self.attitude.left.rotation(),
                centre: Position::new(-half_m, 0.0, 0.0),
            },
            right: Eye {
                intrinsics: self.intrinsics.right,
                lens: self.lenses.right,
                rotation: self.attitude.right.rotation(),
                centre: Position::new(half_m, self.baseline_m * down, self.baseline_m * forward),
            },
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
        self.eyes().left.at_depth(pixel, depth_m)
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
