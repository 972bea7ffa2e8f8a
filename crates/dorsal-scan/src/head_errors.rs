use dorsal::egocentric_depth::{Attitude, BadRig, DriftBelief, Lens, NoSigma, RigDrift, StereoRig};
use dorsal::v1_gabor::Binocular;

use crate::chance::Chance;

/// What a real head gets wrong, and what it knows of that.
///
/// The robot knows the standard deviations, the nominal lens and what its encoders read; the slip,
/// each reading's error and each lens's own shape it does not.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadErrors {
    /// One standard deviation of every reading of an encoder: the pan of either eye and the tilt, in
    /// radians. Drawn anew for every fixation.
    pub encoder_sigma_rad: f64,
    /// How the right eye has slipped in its mount, up and clockwise, in radians: the same for every
    /// fixation, and unknown to the robot.
    pub slip_rad: [f64; 2],
    /// How well the bar holds the eyes' centres, in baselines.
    pub placed_sigma: f64,
    /// The lens of both eyes as it was calibrated.
    pub lens: Lens,
    /// One standard deviation of the first coefficient of either lens about the calibrated one.
    pub lens_sigma: f64,
}

impl Default for HeadErrors {
    /// Encoders of a twentieth of a degree, half a degree of slip about each axis, a barrel of some
    /// 15 px in the corners of 1024 x 768 that is known to three parts in a thousand, and a machined bar.
    fn default() -> Self {
        Self {
            encoder_sigma_rad: 0.05f64.to_radians(),
            slip_rad: [0.5f64.to_radians(), -0.5f64.to_radians()],
            placed_sigma: 1e-3,
            lens: Lens::BrownConrady([-0.06, 0.01, 0.0005, -0.0005, 0.0, 0.0, 0.0, 0.0]),
            lens_sigma: 2e-4,
        }
    }
}

impl HeadErrors {
    /// A head without errors, behind pinholes.
    #[must_use]
    pub const fn none() -> Self {
        Self {
            encoder_sigma_rad: 0.0,
            slip_rad: [0.0; 2],
            placed_sigma: 0.0,
            lens: Lens::Pinhole,
            lens_sigma: 0.0,
        }
    }

    /// The eyes as the robot believes them: what the encoders read, behind the calibrated lens.
    pub(crate) fn believed(&self, read: StereoRig) -> Result<StereoRig, BadRig> {
        read.with_lenses(Binocular {
            left: self.lens,
            right: self.lens,
        })
    }

    /// The lenses as they are: each has its own, for good.
    pub(crate) fn lenses(&self, chance: &mut Chance) -> Binocular<Lens> {
        let mut own = || match self.lens {
            Lens::BrownConrady(mut terms) => {
                terms[0] += chance.normal(self.lens_sigma);
                Lens::BrownConrady(terms)
            }
            other => other,
        };
        Binocular {
            left: own(),
            right: own(),
        }
    }

    /// The eyes as they are, where the encoders read `read`.
    pub(crate) fn actual(
        &self,
        read: StereoRig,
        lenses: Binocular<Lens>,
        chance: &mut Chance,
    ) -> Result<StereoRig, BadRig> {
        let mut error = || chance.normal(self.encoder_sigma_rad);
        let pan = read.pan_rad();
        let aimed = StereoRig::aimed(
            read.intrinsics(),
            read.baseline_m(),
            Binocular {
                left: Attitude::panned(pan.left + error()),
                right: Attitude::panned(pan.right + error()),
            },
        )?;
        let [pitch_rad, roll_rad] = self.slip_rad;
        aimed
            .drifted(&RigDrift {
                pitch_rad,
                roll_rad,
                ..RigDrift::default()
            })?
            .tilted(read.tilt_rad() + error())?
            .with_lenses(lenses)
    }

    /// What is expected of the right eye before a look: pitch and roll as the last look left them,
    /// yaw and the direction of the baseline as the encoders have them.
    ///
    /// The left eye is the reference. Its own reading errs too, which turns both the right eye and the
    /// bar against it: the error of yaw is that of two encoders, and the bar leans forward by one.
    pub(crate) fn expected(&self, last: Option<&DriftBelief>) -> Result<DriftBelief, NoSigma> {
        let encoder = self.encoder_sigma_rad;
        let mut drift = RigDrift::default();
        let mut sigma = RigDrift {
            pitch_rad: f64::INFINITY,
            yaw_rad: std::f64::consts::SQRT_2 * encoder,
            roll_rad: f64::INFINITY,
            down: self.placed_sigma,
            forward: self.placed_sigma.hypot(encoder),
        };
        if let Some(last) = last {
            // A hundredth of a degree is what a mount may give between two looks.
            let slack = 0.01f64.to_radians();
            let (found, known) = (last.drift(), last.sigma());
            drift.pitch_rad = found.pitch_rad;
            drift.roll_rad = found.roll_rad;
            sigma.pitch_rad = known.pitch_rad.hypot(slack);
            sigma.roll_rad = known.roll_rad.hypot(slack);
        }
        DriftBelief::new(drift, &sigma)
    }
}
