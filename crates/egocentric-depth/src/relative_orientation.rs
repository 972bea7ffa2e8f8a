use disparity_pyramid::{DisparityField, MatchParams};
use faer::Mat;
use faer::linalg::solvers::{DenseSolveCore, Solve};
use v1_gabor::Binocular;

use crate::epipolar_residual::{EpipolarGeometry, EpipolarResidual};
use crate::relief::{Relief, off_plane};
use crate::robust_sample::{SIGMA_OVER_MAD, median};
use crate::{DriftBelief, RigDrift, Rotation, StereoRig, midpoint};

/// What is known of the drift beforehand, and how much is asked of the fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrientationParams {
    /// The expected drift: none, what encoders say, or what is left of the belief of the look before
    /// ([`DriftBelief::aged`]).
    pub expected: DriftBelief,
    /// About how many matches to use, taken from a regular grid.
    pub matches: usize,
    /// How many rounds of Gauss-Newton to take at most.
    pub rounds: usize,
}

impl OrientationParams {
    /// What is expected of any rig: pitch and roll, which images fix, are open; yaw and the
    /// direction of the baseline, which they tell less of, are what the rig says to a degree and a
    /// hundredth of the baseline. Eyes that were mounted by hand and knocked since keep as much; where
    /// encoders read the vergence, a caller says so.
    pub const SIGMA: RigDrift = RigDrift {
        pitch_rad: f64::INFINITY,
        yaw_rad: std::f64::consts::PI / 180.0,
        roll_rad: f64::INFINITY,
        down: 0.01,
        forward: 0.01,
    };

    /// What is expected of a rig that was calibrated, whose eyes have since turned, as a knock or a slack
    /// gear turns them: nothing of the turn, and of the centres that a bar holds them to a thousandth of
    /// the baseline.
    pub const TURNED: RigDrift = RigDrift {
        pitch_rad: f64::INFINITY,
        yaw_rad: f64::INFINITY,
        roll_rad: f64::INFINITY,
        down: 0.001,
        forward: 0.001,
    };

    /// The expectation of a rig that has not drifted: within its own [`StereoRig::sigma`] where it
    /// has one, else within [`OrientationParams::SIGMA`].
    #[must_use]
    pub fn of(rig: &StereoRig) -> Self {
        let own = rig.sigma().to_array();
        let any = Self::SIGMA.to_array();
        let sigma = std::array::from_fn(|i| if own[i] > 0.0 { own[i] } else { any[i] });
        Self::expecting(DriftBelief::of_sigma(
            RigDrift::default(),
            &RigDrift::from_array(sigma),
        ))
    }

    /// How eyes are matched whose orientation is asked for: the vertical component of every fit by the
    /// phases alone, at every pixel. Lonely patches count too: what is wrong among them the robust fit refuses, and what is right stands where nothing else
    /// does. It takes several times as long as the default.
    ///
    /// What yaw does to the vertical component is hundredths of a pixel. The default pulls that
    /// component towards the coarser scale's ([`MatchParams::vertical_prior`]), where those
    /// hundredths are lost, which is right for depth and wrong here: before the paper's head, which
    /// verges at 1 m, the yaw that is found is 0.21 degrees off with it and 0.01 without.
    #[must_use]
    pub fn matching() -> MatchParams {
        MatchParams {
            vertical_prior: 0.0,
            sparse_scales: 0,
            finest_warps: 2,
            least_patch: 0,
            // A fit outvotes what is wrong, and asks for answers from everywhere in the picture.
            slanted_scales: 1,
            contradictions: None,
            fill_neighbours: Some(12),
            ..MatchParams::default()
        }
    }

    /// The default fit, which expects the right eye where `expected` has it and as surely.
    #[must_use]
    pub const fn expecting(expected: DriftBelief) -> Self {
        Self {
            expected,
            matches: 4000,
            rounds: 50,
        }
    }
}

impl Default for OrientationParams {
    /// No drift, within [`OrientationParams::SIGMA`].
    fn default() -> Self {
        Self::expecting(DriftBelief::of_sigma(RigDrift::default(), &Self::SIGMA))
    }
}

/// Where the right eye really is, as far as the matches tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativeOrientation {
    /// How the right eye has drifted from its nominal place.
    pub drift: RigDrift,
    /// The same with all that is known about it: what the next look may expect.
    pub belief: DriftBelief,
    /// One standard error of each number, from the scatter of the matches and the prior.
    ///
    /// Matches closer than [`RelativeOrientation::INDEPENDENT_PX`] see the same texture and count
    /// for less than one each.
    pub standard_error: RigDrift,
    /// Which of the numbers the images tell, in the order of [`RigDrift::NAMES`]: those that they
    /// leave less than half as uncertain as they were expected to be. The others stay as expected.
    pub told: [bool; 5],
    /// The part of the matches that lies off the one plane that most of them lie on, by more than
    /// [`RelativeOrientation::OFF_PLANE_PX`] of parallax.
    pub relief: f64,
    /// One standard deviation of the Sampson distance of the fitting matches, in pixels: an error
    /// `sigma` in each coordinate of both pixels has this `sigma`, and one in `dy` alone the
    /// square root of a half of it.
    pub noise_px: f64,
    /// Root mean square of the vertical misalignment before the fit, in pixels, over the matches
    /// as the fit weighs them.
    pub vertical_rms_before_px: f64,
    /// The same with the drift corrected. Row-bound matching wants less than 0.2.
    pub vertical_rms_after_px: f64,
    /// How many matches were used.
    pub matches: usize,
    /// How many rounds it took.
    pub rounds: usize,
    /// Whether the last round changed nothing any more; if not, the rounds ran out.
    pub settled: bool,
}

impl RelativeOrientation {
    /// Matches at least so far apart err independently, in pixels: three windows of the finest
    /// filters, since neighbours share their texture and what coarser scales made of it. On five
    /// pairs of published pose the errors then are of the size of the standard errors; one window
    /// makes these three times too small.
    pub const INDEPENDENT_PX: f64 = 33.0;

    /// A match this far off a plane, by parallax in pixels, does not lie on it.
    pub const OFF_PLANE_PX: f64 = 1.0;

    /// Below this part of matches off one plane a scene has no relief of its own.
    pub const LEAST_RELIEF: f64 = 0.05;

    /// Why the scene can tell less than five numbers, if it cannot: it is one plane, which any eyes
    /// see alike that see it through the same homography.
    #[must_use]
    pub fn is_one_plane(&self) -> bool {
        self.relief < Self::LEAST_RELIEF
    }
}

/// Why the matches do not tell where the right eye is.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoOrientation {
    /// Too few valid disparities.
    #[error("{found} valid disparities cannot orient an eye; {needed} are needed")]
    TooFewMatches {
        /// How many there are.
        found: usize,
        /// How many would do.
        needed: usize,
    },
    /// The matches and the prior leave one number open: they crowd in one place, or nothing is
    /// expected of what images do not tell.
    #[error(
        "these matches do not tell {parameter}: spread them over the image, or say what to expect"
    )]
    Undetermined {
        /// What stays open, as [`RigDrift::NAMES`] has it.
        parameter: &'static str,
    },
    /// The fit ran off to angles no rig drifts by.
    #[error("the fit ran off to {angle_rad} rad: these matches are not those of this rig")]
    RanOff {
        /// The angle of the turn it came to, in radians.
        angle_rad: f64,
    },
}

/// Five unknowns and their scatter want some ten matches each.
const LEAST_MATCHES: usize = 50;

/// Beyond this an eye has not drifted but been replaced, and small-angle reasoning ends.
const LARGEST_ANGLE_RAD: f64 = 0.5;

/// A standard error above this tells nothing, in radians or in baselines.
const LARGEST_ERROR: f64 = 0.1;

/// Matches of f32 pixels are never better than this, in pixels; without a floor a perfect synthetic
/// scene would divide by zero.
const LEAST_NOISE_PX: f64 = 1e-4;

/// Finds the right eye's attitude and place from vector disparities: calibration from the image
/// pair itself.
///
/// Gauss-Newton on the Sampson distance of the epipolar constraint, with Cauchy weights whose width
/// follows the scatter of the residuals, over the valid pixels weighed by their confidence. The
/// eight-point algorithm is no alternative: it fails on planes, where this does not.
///
/// `disparity` comes from the two images as they were taken, `rig` says what ought to hold, with
/// eyes of any attitude. The answer is a value: [`StereoRig::drifted`] corrects the rig for the next
/// step, and [`OrientationParams::expected`] takes its belief into the next look.
///
/// # Errors
/// [`NoOrientation`] if the matches are too few, leave the orientation open or belong to another
/// rig.
pub fn relative_orientation(
    disparity: &DisparityField,
    rig: &StereoRig,
    params: &OrientationParams,
) -> Result<RelativeOrientation, NoOrientation> {
    let matches = sample_matches(disparity, params.matches);
    if matches.len() < LEAST_MATCHES {
        return Err(NoOrientation::TooFewMatches {
            found: matches.len(),
            needed: LEAST_MATCHES,
        });
    }
    let mut drift = params.expected.drift();
    let mut rounds = 0;
    let mut settled = false;
    let mut system = System::at(&drift, &matches, rig, params);
    while rounds < params.rounds && !settled {
        let step = system.step()?;
        drift = moved(&drift, step);
        let angle_rad = turned_by(&drift);
        if angle_rad.is_nan() || angle_rad > LARGEST_ANGLE_RAD {
            return Err(NoOrientation::RanOff { angle_rad });
        }
        system = System::at(&drift, &matches, rig, params);
        // Ten nanoradians are a hundred-thousandth of a pixel: far below what any match says.
        settled = step.iter().all(|change| change.abs() < 1e-8);
        rounds += 1;
    }
    let standard_error = system.standard_error()?;
    let before = params.expected.sigma().to_array();
    let after = standard_error.to_array();
    Ok(RelativeOrientation {
        drift,
        belief: DriftBelief::of_information(drift, system.information),
        standard_error,
        told: std::array::from_fn(|i| after[i] < before[i] / 2.0),
        relief: relief(&matches, &system.weights, &drift, rig),
        noise_px: system.noise_px,
        vertical_rms_before_px: vertical_rms(&system.weights, &RigDrift::default(), &matches, rig),
        vertical_rms_after_px: vertical_rms(&system.weights, &drift, &matches, rig),
        matches: matches.len(),
        rounds,
        settled,
    })
}

/// A match and the weight its confidence gives it.
struct Match {
    pixels: Binocular<(f64, f64)>,
    confidence: f64,
    /// The part of a match that is its own and not its neighbours'.
    independent: f64,
}

/// The valid pixels on a square grid wide enough to leave about `wanted` of them: a grid spreads
/// over the whole image, and takes the same pixels every time.
fn sample_matches(disparity: &DisparityField, wanted: usize) -> Vec<Match> {
    let size = disparity.size();
    let valid = disparity.validity().iter().filter(|v| v.is_valid()).count();
    let pitch = ((valid as f64 / wanted.max(1) as f64).sqrt().floor() as usize).max(1);
    let independent = (pitch as f64 / RelativeOrientation::INDEPENDENT_PX)
        .powi(2)
        .min(1.0);
    (pitch / 2..size.height)
        .step_by(pitch)
        .flat_map(|y| (pitch / 2..size.width).step_by(pitch).map(move |x| (x, y)))
        .filter_map(|(x, y)| {
            let found = disparity.at(x, y)?;
            let (u, v) = (x as f64, y as f64);
            (found.confidence > 0.0).then(|| Match {
                pixels: Binocular {
                    left: (u, v),
                    right: (u + f64::from(found.dx), v + f64::from(found.dy)),
                },
                confidence: f64::from(found.confidence),
                independent,
            })
        })
        .collect()
}

/// The normal equations of one round.
struct System {
    /// The inverse covariance: what matches and prior know about each number.
    information: [[f64; 5]; 5],
    /// The negative gradient of half the cost.
    pull: [f64; 5],
    noise_px: f64,
    /// The weight of each match, 0 where the constraint says nothing.
    weights: Vec<f64>,
}

impl System {
    fn at(
        drift: &RigDrift,
        matches: &[Match],
        rig: &StereoRig,
        params: &OrientationParams,
    ) -> Self {
        let geometry = EpipolarGeometry::of(rig, drift);
        let residuals: Vec<Option<EpipolarResidual>> = matches
            .iter()
            .map(|found| geometry.residual(found.pixels))
            .collect();
        let mut sizes: Vec<f64> = residuals
            .iter()
            .flatten()
            .map(|residual| residual.sampson_px.abs())
            .collect();
        let scatter_px = SIGMA_OVER_MAD * median(&mut sizes);
        // `max` also turns the NaN of an empty sample into the floor.
        let noise_px = scatter_px.max(LEAST_NOISE_PX);

        let mut system = Self {
            information: [[0.0; 5]; 5],
            pull: [0.0; 5],
            noise_px,
            weights: Vec::with_capacity(matches.len()),
        };
        for (residual, found) in residuals.iter().zip(matches) {
            let weight = residual.as_ref().map_or(0.0, |residual| {
                found.confidence * cauchy_weight(residual.sampson_px / noise_px)
            });
            system.weights.push(weight);
            if let Some(residual) = residual {
                system.learn(
                    &residual.gradient,
                    residual.sampson_px,
                    weight * found.independent / (noise_px * noise_px),
                );
            }
        }
        let surprise = from_expected(drift, &params.expected.drift());
        let expected = params.expected.information();
        for i in 0..5 {
            for j in 0..5 {
                system.information[i][j] += expected[i][j];
                system.pull[i] -= expected[i][j] * surprise[j];
            }
        }
        system
    }

    /// Adds the term `precision / 2 * residual^2` of the cost.
    fn learn(&mut self, gradient: &[f64; 5], residual: f64, precision: f64) {
        for i in 0..5 {
            for j in 0..5 {
                self.information[i][j] += precision * gradient[i] * gradient[j];
            }
            self.pull[i] -= precision * gradient[i] * residual;
        }
    }

    /// The change of the five numbers that this round asks for.
    fn step(&self) -> Result<[f64; 5], NoOrientation> {
        let scale = self.scale()?;
        let solver = self.scaled(&scale).col_piv_qr();
        determined(&solver)?;
        let pull = Mat::from_fn(5, 1, |i, _| scale[i] * self.pull[i]);
        let step = solver.solve(&pull);
        Ok(std::array::from_fn(|i| scale[i] * step[(i, 0)]))
    }

    fn standard_error(&self) -> Result<RigDrift, NoOrientation> {
        let scale = self.scale()?;
        let solver = self.scaled(&scale).col_piv_qr();
        determined(&solver)?;
        let covariance = solver.inverse();
        let errors: [f64; 5] = std::array::from_fn(|i| scale[i] * covariance[(i, i)].sqrt());
        match errors
            .iter()
            .position(|&error| error.is_nan() || error > LARGEST_ERROR)
        {
            Some(open) => Err(NoOrientation::Undetermined {
                parameter: RigDrift::NAMES[open],
            }),
            None => Ok(RigDrift::from_array(errors)),
        }
    }

    /// What brings the diagonal to 1: angles and shares of the baseline differ in how much the
    /// matches know of them by orders of magnitude, which is no lack of rank.
    fn scale(&self) -> Result<[f64; 5], NoOrientation> {
        let scale: [f64; 5] = std::array::from_fn(|i| self.information[i][i].sqrt().recip());
        match scale.iter().position(|value| !value.is_finite()) {
            Some(open) => Err(NoOrientation::Undetermined {
                parameter: RigDrift::NAMES[open],
            }),
            None => Ok(scale),
        }
    }

    fn scaled(&self, scale: &[f64; 5]) -> Mat<f64> {
        Mat::from_fn(5, 5, |i, j| scale[i] * self.information[i][j] * scale[j])
    }
}

/// An error unless the scaled system has full rank: column pivoting leaves the column that adds
/// least for last, and without it a deficient system would yield steps of 1e16 in silence.
fn determined(solver: &faer::linalg::solvers::ColPivQr<f64>) -> Result<(), NoOrientation> {
    let r = solver.thin_R();
    // Normal equations square the condition; 1e-11 is a direction known 3e5 times worse than
    // the best, with some digits of f64 left.
    if r[(4, 4)].abs() > 1e-11 * r[(0, 0)].abs() {
        return Ok(());
    }
    let (order, _) = solver.P().arrays();
    Err(NoOrientation::Undetermined {
        parameter: RigDrift::NAMES[order[4]],
    })
}

/// The weight of a residual of so many standard deviations; 2.385 of them keep 95 % of the
/// efficiency on normal residuals.
fn cauchy_weight(deviations: f64) -> f64 {
    let ratio = deviations / 2.385;
    1.0 / (1.0 + ratio * ratio)
}

/// The drift after a step whose turn is measured in the axes of the right eye as it now stands.
fn moved(drift: &RigDrift, [pitch, yaw, roll, down, forward]: [f64; 5]) -> RigDrift {
    let turn = drift
        .turn()
        .after(&Rotation::from_vector([pitch, yaw, roll]));
    let [pitch_rad, yaw_rad, roll_rad] = turn.to_vector();
    RigDrift {
        pitch_rad,
        yaw_rad,
        roll_rad,
        down: drift.down + down,
        forward: drift.forward + forward,
    }
}

/// How far a drift is from the expected one, its turn again in the axes of the right eye.
fn from_expected(drift: &RigDrift, expected: &RigDrift) -> [f64; 5] {
    let [pitch, yaw, roll] = expected.turn().inverse().after(&drift.turn()).to_vector();
    [
        pitch,
        yaw,
        roll,
        drift.down - expected.down,
        drift.forward - expected.forward,
    ]
}

/// The part of the matches off the plane that most lie on, with the drift corrected.
fn relief(matches: &[Match], weights: &[f64], drift: &RigDrift, rig: &StereoRig) -> f64 {
    let eyes = drift.eyes(rig);
    let (focal_px, _) = rig.intrinsics().left.focal_px;
    let points: Vec<Relief> = matches
        .iter()
        .zip(weights)
        .filter_map(|(found, &weight)| {
            let (x, y) = eyes.left.straight(found.pixels.left)?;
            let rays = Binocular {
                left: eyes.left.ray(found.pixels.left)?,
                right: eyes.right.ray(found.pixels.right)?,
            };
            let [_, _, depth_m] = eyes.left.coordinates(midpoint(rays)?.position);
            Some(Relief {
                x,
                y,
                parallax_px: focal_px * rig.baseline_m() / depth_m,
                weight,
            })
        })
        .collect();
    off_plane(&points, RelativeOrientation::OFF_PLANE_PX).unwrap_or(0.0)
}

fn turned_by(drift: &RigDrift) -> f64 {
    let [pitch, yaw, roll, ..] = drift.to_array();
    // The length of the turn; unlike a maximum it lets no NaN pass unseen.
    pitch.hypot(yaw).hypot(roll)
}

fn vertical_rms(weights: &[f64], drift: &RigDrift, matches: &[Match], rig: &StereoRig) -> f64 {
    let geometry = EpipolarGeometry::of(rig, drift);
    let (squares, total) =
        matches
            .iter()
            .zip(weights)
            .fold(
                (0.0, 0.0),
                |(squares, total), (found, weight)| match geometry.residual(found.pixels) {
                    Some(residual) => (
                        squares + weight * residual.vertical_px * residual.vertical_px,
                        total + weight,
                    ),
                    None => (squares, total),
                },
            );
    (squares / total).sqrt()
}
