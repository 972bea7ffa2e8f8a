//! The squares of ground that have been seen free.

use std::f64::consts::SQRT_2;

use crate::life::Life;
use crate::look_evidence::{AskedPlace, Evidence, LookEvidence};
use crate::memory_change::Change;
use crate::scene_memory::SceneMemory;

/// How much wider than the circle around a square the ball is that it is asked by. Evidence lets one
/// line of sight in twenty be stray; a segment of a twentieth of a disc is a tenth of its width high, so
/// a ball wider by a quarter still holds the square when that much of it is forgiven.
const SPARE: f64 = 1.25;

impl SceneMemory {
    /// Keeps the squares around the robot that the look shows free, and gives up those on which it
    /// shows that a thing may stand.
    ///
    /// The ball that a square is asked by holds the whole square and [`SPARE`] more. A ball inside of the
    /// square would leave its corners out, and a hand would graze what stands there.
    pub(crate) fn walk(&mut self, evidence: &impl LookEvidence) {
        let cell = i64::from(self.params.cell_mm);
        let reach = i64::from(self.params.ground_mm) / cell;
        let pose = self.robot.pose();
        let (sin, cos) = pose.heading_rad().sin_cos();
        let square = |metres: f64| (metres * 1e3 / cell as f64).floor() as i64;
        let (x, z) = (square(pose.x_m()), square(pose.z_m()));
        for (dx, dz) in (-reach..reach).flat_map(|dx| (-reach..reach).map(move |dz| (dx, dz))) {
            let (Ok(column), Ok(row)) = (i32::try_from(x + dx), i32::try_from(z + dz)) else {
                continue;
            };
            let [right, forward] = [
                self.centre_m(column) - pose.x_m(),
                self.centre_m(row) - pose.z_m(),
            ];
            let place = AskedPlace {
                right_m: right * cos + forward * sin,
                forward_m: forward * cos - right * sin,
                height_m: f64::from(self.params.above_ground_mm) / 1e3,
                within_m: SPARE * cell as f64 / 2e3 * SQRT_2,
                radius_m: 0.0,
            };
            match evidence.at(place) {
                Evidence::FreeSpace
                    if self.free.len() < self.params.most_cells
                        || self.free.contains_key(&(column, row)) =>
                {
                    self.free.insert((column, row), self.looks);
                }
                Evidence::Taken => {
                    self.free.remove(&(column, row));
                }
                _ => {}
            }
        }
    }

    /// The squares that count as free: those seen free of late ([`MemoryParams::trusted_looks`]), and since the
    /// last sighting of everything that the memory has lost. What is not where it was may stand
    /// on any ground that nobody has looked at since it was seen there.
    ///
    /// [`MemoryParams::trusted_looks`]: crate::MemoryParams::trusted_looks
    pub(crate) fn trusted_ground(&self) -> impl Fn((i32, i32)) -> bool + '_ {
        let lost = self
            .objects
            .values()
            .filter(|kept| matches!(kept.life, Life::Missing | Life::Removed));
        let lost_since = lost.map(|kept| kept.last_look).max();
        move |square| {
            let seen = self.free.get(&square);
            seen.is_some_and(|&look| {
                self.trusts(look) && lost_since.is_none_or(|lost_since| look > lost_since)
            })
        }
    }

    /// Gives up the squares that an object which appears or has moved may cover: they were seen free
    /// before it stood there, or it was overlooked. What is seen of a body is its front, so that it may
    /// reach as far as its width beyond.
    pub(crate) fn cover(&mut self, changes: &[Change]) {
        for change in changes {
            let (Change::Appeared { object } | Change::Moved { object, .. }) = change else {
                continue;
            };
            let (Some(place), Some(kept)) = (self.estimate(object), self.objects.get(object))
            else {
                continue;
            };
            let [[xx, _], [_, zz]] = place.covariance_m2();
            let reach = 2.0 * f64::from(kept.radius_mm) / 1e3
                + self.params.qualify.sigmas * xx.max(zz).sqrt()
                + self.half_diagonal_m();
            let [x, z] = place.position_m();
            let side = f64::from(self.params.cell_mm) / 1e3;
            let squares = |at: f64| {
                let square = |at: f64| (at / side).floor() as i32;
                square(at - reach)..=square(at + reach)
            };
            for column in squares(x) {
                for row in squares(z) {
                    let (dx, dz) = (self.centre_m(column) - x, self.centre_m(row) - z);
                    if dx.hypot(dz) <= reach {
                        self.free.remove(&(column, row));
                    }
                }
            }
        }
    }

    /// From the middle of a square to its corners, in metres.
    pub(crate) fn half_diagonal_m(&self) -> f64 {
        f64::from(self.params.cell_mm) / 2e3 * SQRT_2
    }

    /// The middle of a square along one axis, in metres.
    pub(crate) fn centre_m(&self, square: i32) -> f64 {
        (f64::from(square) + 0.5) * f64::from(self.params.cell_mm) / 1e3
    }
}
