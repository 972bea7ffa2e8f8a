use serde::{Deserialize, Serialize};

use crate::fusion::add;
use crate::ground_pose::GroundPose;
use crate::polar_box::PolarBox;
use crate::sighting::Sighting;

/// Where an object is believed to be on the ground of the map: a position and its covariance.
///
/// Whole micrometres and square micrometres, so that a map written and read again is the same to
/// the bit. The ellipse of k standard errors is what relations are qualified from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GroundEstimate {
    x_um: i64,
    z_um: i64,
    xx_um2: i64,
    xz_um2: i64,
    zz_um2: i64,
}

/// What the integers may have rounded off a position, twice over, in metres.
const GRAIN_M: f64 = 2e-6;

impl GroundEstimate {
    /// The estimate of a checked sighting: the error in distance along the line of sight, that
    /// in bearing across it.
    pub(crate) fn of_sighting(sighting: &Sighting, pose: GroundPose) -> Self {
        let (sin, cos) = pose.map_bearing_rad(sighting).sin_cos();
        let distance = sighting.distance_m;
        let along = (sighting.sigma_distance_m * 1e6).powi(2);
        let across = (distance * sighting.sigma_bearing_rad * 1e6).powi(2);
        let whole = |um: f64| um.round() as i64;
        Self {
            x_um: whole((pose.x_m() + distance * cos) * 1e6),
            z_um: whole((pose.z_m() + distance * sin) * 1e6),
            xx_um2: whole(along * cos * cos + across * sin * sin),
            xz_um2: whole((along - across) * sin * cos),
            zz_um2: whole(along * sin * sin + across * cos * cos),
        }
    }

    /// An estimate from metres, rounded to its grain.
    pub(crate) fn of([x, z]: [f64; 2], [[xx, xz], [_, zz]]: [[f64; 2]; 2]) -> Self {
        let whole = |value: f64| value.round() as i64;
        Self {
            x_um: whole(x * 1e6),
            z_um: whole(z * 1e6),
            xx_um2: whole(xx * 1e12),
            xz_um2: whole(xz * 1e12),
            zz_um2: whole(zz * 1e12),
        }
    }

    /// The same position, less sure by this covariance in square metres.
    pub(crate) fn widened(&self, by: [[f64; 2]; 2]) -> Self {
        Self::of(self.position_m(), add(self.covariance_m2(), by))
    }

    /// The position `[x, z]` in the map frame, in metres.
    #[must_use]
    pub fn position_m(&self) -> [f64; 2] {
        [self.x_um as f64 / 1e6, self.z_um as f64 / 1e6]
    }

    /// The covariance `[[xx, xz], [xz, zz]]` in the map frame, in square metres.
    #[must_use]
    pub fn covariance_m2(&self) -> [[f64; 2]; 2] {
        let [xx, xz, zz] = [self.xx_um2, self.xz_um2, self.zz_um2].map(|um2| um2 as f64 / 1e12);
        [[xx, xz], [xz, zz]]
    }

    /// Whether the covariance is one: no variance is negative.
    pub(crate) const fn is_sane(&self) -> bool {
        self.xx_um2 >= 0 && self.zz_um2 >= 0
    }

    /// The position seen from a pose, `[ahead, leftward]`, in metres.
    pub(crate) fn seen_from(&self, pose: GroundPose) -> [f64; 2] {
        let [x, z] = self.position_m();
        let (sin, cos) = pose.heading_rad().sin_cos();
        let [right, forward] = [x - pose.x_m(), z - pose.z_m()];
        [forward * cos - right * sin, -right * cos - forward * sin]
    }

    /// The box around the ellipse of `sigmas` standard errors.
    pub(crate) fn bounds(&self, sigmas: f64) -> GroundBox {
        let [[xx, xz], [_, zz]] = self.covariance_m2();
        let turn = 0.5 * (2.0 * xz).atan2(xx - zz);
        let (sin, cos) = turn.sin_cos();
        let (mean, spread) = ((xx + zz) / 2.0, ((xx - zz) / 2.0).hypot(xz));
        let half = |variance: f64| sigmas * variance.max(0.0).sqrt() + GRAIN_M;
        GroundBox {
            centre: self.position_m(),
            axes: [[cos, sin], [-sin, cos]],
            half: [half(mean + spread), half(mean - spread)],
        }
    }
}

/// A turned rectangle on the ground of the map, in metres.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GroundBox {
    centre: [f64; 2],
    /// Unit vectors along its two sides.
    axes: [[f64; 2]; 2],
    /// Half its extent along each.
    half: [f64; 2],
}

impl GroundBox {
    /// Whether the two rectangles share a point: no side of either separates them.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let between = difference(other.centre, self.centre);
        let reach = |rectangle: &Self, axis: [f64; 2]| {
            rectangle.half[0] * dot(rectangle.axes[0], axis).abs()
                + rectangle.half[1] * dot(rectangle.axes[1], axis).abs()
        };
        self.axes
            .into_iter()
            .chain(other.axes)
            .all(|axis| dot(between, axis).abs() <= reach(self, axis) + reach(other, axis))
    }

    /// The rectangle as an observer sees it.
    pub(crate) fn seen_from(&self, pose: GroundPose) -> PolarBox {
        let centre = difference(self.centre, [pose.x_m(), pose.z_m()]);
        let along = self.axes.map(|axis| dot(centre, axis).abs());
        let near = (along[0] - self.half[0])
            .max(0.0)
            .hypot((along[1] - self.half[1]).max(0.0));
        let far = (along[0] + self.half[0]).hypot(along[1] + self.half[1]);
        let bearing = centre[1].atan2(centre[0]);
        // A rectangle that does not contain the observer lies within half a turn of its centre.
        let aside = |corner: [f64; 2]| {
            let turn = centre[0] * corner[1] - centre[1] * corner[0];
            turn.atan2(dot(centre, corner))
        };
        let arc = if near > 0.0 {
            let turns = self.corners_from(centre).map(aside);
            let low = turns.into_iter().fold(0.0, f64::min);
            let high = turns.into_iter().fold(0.0, f64::max);
            (low, high)
        } else {
            (-std::f64::consts::PI, std::f64::consts::PI)
        };
        let ahead = bearing - pose.heading_rad();
        PolarBox::new((near, far), (ahead + arc.0, ahead + arc.1))
    }

    /// The four corners, where the centre is at `centre`.
    fn corners_from(&self, centre: [f64; 2]) -> [[f64; 2]; 4] {
        [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(s, t)| {
            let [u, v] = self.axes;
            let (s, t) = (s * self.half[0], t * self.half[1]);
            [
                centre[0] + s * u[0] + t * v[0],
                centre[1] + s * u[1] + t * v[1],
            ]
        })
    }
}

fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn difference(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}
