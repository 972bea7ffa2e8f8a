//! The squares of ground that have been seen free.

use crate::look_evidence::{AskedPlace, Evidence, LookEvidence};
use crate::scene_memory::SceneMemory;

impl SceneMemory {
    /// Keeps the squares around the robot that the look shows free.
    pub(crate) fn walk(&mut self, evidence: &impl LookEvidence) {
        let cell = i64::from(self.params.cell_mm);
        let reach = i64::from(self.params.ground_mm) / cell;
        let pose = self.robot.pose();
        let (sin, cos) = pose.heading_rad().sin_cos();
        let square = |metres: f64| (metres * 1e3 / cell as f64).floor() as i64;
        let (x, z) = (square(pose.x_m()), square(pose.z_m()));
        for (dx, dz) in (-reach..reach).flat_map(|dx| (-reach..reach).map(move |dz| (dx, dz))) {
            if self.free.len() >= self.params.most_cells {
                return;
            }
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
                within_m: cell as f64 / 2e3,
                radius_m: 0.0,
            };
            if evidence.at(place) == Evidence::FreeSpace {
                self.free.insert((column, row));
            }
        }
    }

    /// The middle of a square along one axis, in metres.
    pub(crate) fn centre_m(&self, square: i32) -> f64 {
        (f64::from(square) + 0.5) * f64::from(self.params.cell_mm) / 1e3
    }
}
