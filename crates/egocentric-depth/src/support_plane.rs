use v1_gabor::Size;

use crate::relief::{Relief, plane_of, plane_through};
use crate::rotation::dot;
use crate::{DepthMap, Head, Position, StereoRig};

/// The plane that things stand on: a table top, a shelf, the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportPlane {
    /// Of length 1, square to the plane, from the plane to the eyes' side.
    up: [f64; 3],
    /// How high the head is above the plane, in metres; positive.
    head_m: f64,
    /// The part of the known depths that lie on it.
    share: f64,
}

/// How [`SupportPlane::find`] looks for a plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SupportParams {
    /// How far from level the plane may be in the observer frame, in radians.
    pub most_tilt_rad: f64,
    /// How far from the plane a depth may be to lie on it, in pixels of disparity.
    pub off_px: f64,
    /// The part of the known depths that has to lie on it, from 0 to 1.
    pub least_share: f64,
}

impl Default for SupportParams {
    /// Forty degrees keep walls out even if the rig does not know its tilt to ten; one pixel is what a
    /// disparity is wrong by where it is not wrong altogether; a tenth of a view is a small table.
    fn default() -> Self {
        Self {
            most_tilt_rad: 40f64.to_radians(),
            off_px: 1.0,
            least_share: 0.1,
        }
    }
}

/// Why there is no plane for things to stand on.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoSupport {
    /// Too few depths.
    #[error("{known} pixels of {size} have a known depth; a support plane needs at least {needed}")]
    TooFewDepths {
        /// How many pixels have a known depth.
        known: usize,
        /// Size of the depth map.
        size: Size,
        /// How many would do.
        needed: usize,
    },
    /// No level plane below the eyes holds enough of the depths.
    #[error(
        "no plane below the eyes and within {most_tilt_deg:.0} degrees of level holds {needed:.0} % of \
         the known depths (the best holds {found:.0} %); is a table or the ground in view, and does the \
         rig know its tilt?"
    )]
    NoPlane {
        /// The part of the known depths on the best plane, per cent.
        found: f64,
        /// The part that is needed, per cent.
        needed: f64,
        /// How far from level the plane might have been, degrees.
        most_tilt_deg: f64,
    },
}

/// How many depths at least are worth a plane.
const LEAST_DEPTHS: usize = 300;
/// How many depths the plane is looked for in: enough for a share of one in a hundred.
const SAMPLES: usize = 8000;
/// How many triples are tried. A plane that holds a fifth of the depths is hit by one in 125.
const TRIPLES: usize = 2000;

impl SupportPlane {
    /// The level plane below the eyes on which most of the known depths lie.
    ///
    /// Planes through three depths each are tried (RANSAC, with the same triples on every machine), and
    /// the best is fitted to all depths by reweighted least squares. Deviations count in pixels of
    /// disparity, not in metres, so that what is far and uncertain has no more say than what is near:
    /// the inverse depth of a plane is linear over the image plane of any eye. `rig` is the one the map
    /// was triangulated with; its tilt says what is level.
    ///
    /// # Errors
    /// [`NoSupport`] if there are too few depths, or no plane holds [`SupportParams::least_share`].
    pub fn find(
        depth: &DepthMap,
        rig: &StereoRig,
        params: &SupportParams,
    ) -> Result<Self, NoSupport> {
        let all = relief(depth, rig);
        if all.len() < LEAST_DEPTHS {
            return Err(NoSupport::TooFewDepths {
                known: all.len(),
                size: depth.size(),
                needed: LEAST_DEPTHS,
            });
        }
        let step = all.len().div_ceil(SAMPLES);
        let some: Vec<Relief> = all.iter().step_by(step).copied().collect();
        let scale = parallax_of_a_metre(rig);
        let level = |plane| Self::of(plane, scale).is_level(rig, params.most_tilt_rad);
        let mut best = (0.0, None);
        let mut dice = Dice(0x5EED);
        for _ in 0..TRIPLES {
            let triple = [(); 3].map(|()| some[dice.below(some.len())]);
            let Some(plane) = plane_through(triple).filter(|&plane| level(plane)) else {
                continue;
            };
            // A soft count: the nearer to the plane, the more.
            let score: f64 = some
                .iter()
                .map(|point| (1.0 - (point.off(plane) / params.off_px).powi(2)).max(0.0))
                .sum();
            if score > best.0 {
                best = (score, Some(plane));
            }
        }
        let fitted = best
            .1
            .and_then(|start| plane_of(&some, params.off_px / 2.0, Some(start)))
            .filter(|&plane| level(plane));
        let on = |plane: [f64; 3]| {
            let on = all.iter().filter(|p| p.off(plane).abs() <= params.off_px);
            on.count() as f64 / all.len() as f64
        };
        let share = fitted.map_or(0.0, on);
        match fitted {
            Some(plane) if share >= params.least_share => Ok(Self {
                share,
                ..Self::of(plane, scale)
            }),
            _ => Err(NoSupport::NoPlane {
                found: 100.0 * share,
                needed: 100.0 * params.least_share,
                most_tilt_deg: params.most_tilt_rad.to_degrees(),
            }),
        }
    }

    /// How high a point is above the plane, in metres; negative below it.
    #[must_use]
    pub fn height_m(&self, point: Position<Head>) -> f64 {
        self.head_m + dot(self.up, point.to_array())
    }

    /// The part of the known depths that lie on the plane, from 0 to 1.
    #[must_use]
    pub const fn share(&self) -> f64 {
        self.share
    }

    /// The direction away from the plane, in the head frame, of length 1.
    #[must_use]
    pub const fn up(&self) -> [f64; 3] {
        self.up
    }

    /// How much the height of a point changes with its depth, along its line of sight from the head.
    pub(crate) fn height_per_depth(&self, point: Position<Head>) -> f64 {
        dot(self.up, point.to_array()) / point.z_m
    }

    /// The plane `p + q x + r y` of parallaxes: as `p z + q X + r Y = f b`, its normal is `(q, r, p)`.
    fn of([p, q, r]: [f64; 3], parallax_of_a_metre: f64) -> Self {
        let length = dot([q, r, p], [q, r, p]).sqrt();
        Self {
            up: [q, r, p].map(|component| -component / length),
            head_m: parallax_of_a_metre / length,
            share: 0.0,
        }
    }

    /// Whether the plane lies below the eyes and is nearly level in the observer frame, whose y points
    /// down.
    fn is_level(&self, rig: &StereoRig, most_tilt_rad: f64) -> bool {
        let up = rig.head_to_observer().apply(self.up);
        -up[1] >= most_tilt_rad.cos()
    }
}

/// What a point at a depth of one metre has as parallax, px: the left focal length times the baseline.
pub(crate) fn parallax_of_a_metre(rig: &StereoRig) -> f64 {
    rig.intrinsics().left.focal_px.0 * rig.baseline_m()
}

/// Every known depth as a point of the head's image plane, row by row.
fn relief(depth: &DepthMap, rig: &StereoRig) -> Vec<Relief> {
    let scale = parallax_of_a_metre(rig);
    let eye = rig.eyes().left;
    let known = depth.metres();
    let known = known.indexed_iter().filter(|(_, z)| z.is_finite());
    known
        .filter_map(|((y, x), &z_m)| {
            let point = eye.at_depth((x as f64, y as f64), f64::from(z_m))?;
            Some(Relief {
                x: point.x_m / point.z_m,
                y: point.y_m / point.z_m,
                parallax_px: scale / point.z_m,
                weight: 1.0,
            })
        })
        .collect()
}

/// A stream of numbers that looks random and is the same on every machine (xorshift64*).
struct Dice(u64);

impl Dice {
    fn below(&mut self, limit: usize) -> usize {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 33;
        bits as usize % limit
    }
}
