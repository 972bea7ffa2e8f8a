use serde::{Deserialize, Serialize};

use crate::ground_pose::GroundPose;

/// The least certain a pose may be: beyond this it is no pose but a lost robot.
const VAGUEST_M: f64 = 1e3;

/// Where the robot believes it stands, and how sure it is.
///
/// The errors of position and heading are taken as independent. Integers, so that a memory written
/// and read again is the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RobotPose {
    pose: GroundPose,
    xx_um2: i64,
    xz_um2: i64,
    zz_um2: i64,
    sigma_heading_nrad: i64,
}

/// Errors that are none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "a pose with covariance {covariance_m2:?} m2 and heading error {sigma_heading_rad} rad: \
     the covariance must be symmetric without negative variance, below 1000 m and a turn"
)]
pub struct NotAnError {
    /// The covariance of the position.
    pub covariance_m2: [[f64; 2]; 2],
    /// The standard error of the heading.
    pub sigma_heading_rad: f64,
}

impl RobotPose {
    /// A pose with the covariance `[[xx, xz], [xz, zz]]` of its position in square metres and the
    /// standard error of its heading in radians.
    ///
    /// # Errors
    /// [`NotAnError`] if the numbers are no covariance or no standard error.
    pub fn new(
        pose: GroundPose,
        covariance_m2: [[f64; 2]; 2],
        sigma_heading_rad: f64,
    ) -> Result<Self, NotAnError> {
        let [[xx, xz], [zx, zz]] = covariance_m2;
        let variance = |v: f64| (0.0..=VAGUEST_M * VAGUEST_M).contains(&v);
        let angle = (0.0..=std::f64::consts::TAU).contains(&sigma_heading_rad);
        if variance(xx) && variance(zz) && xz == zx && xz * xz <= xx * zz && angle {
            Ok(Self {
                pose,
                xx_um2: (xx * 1e12).round() as i64,
                xz_um2: (xz * 1e12).round() as i64,
                zz_um2: (zz * 1e12).round() as i64,
                sigma_heading_nrad: (sigma_heading_rad * 1e9).round() as i64,
            })
        } else {
            Err(NotAnError {
                covariance_m2,
                sigma_heading_rad,
            })
        }
    }

    /// Where it stands and which way it faces.
    #[must_use]
    pub const fn pose(&self) -> GroundPose {
        self.pose
    }

    /// The covariance of its position `[[xx, xz], [xz, zz]]`, in square metres.
    #[must_use]
    pub fn covariance_m2(&self) -> [[f64; 2]; 2] {
        let [xx, xz, zz] = [self.xx_um2, self.xz_um2, self.zz_um2].map(|um2| um2 as f64 / 1e12);
        [[xx, xz], [xz, zz]]
    }

    /// The standard error of its heading, in radians.
    #[must_use]
    pub fn sigma_heading_rad(&self) -> f64 {
        self.sigma_heading_nrad as f64 / 1e9
    }

    /// Whether the pose claims no error.
    pub(crate) const fn is_exact(&self) -> bool {
        self.xx_um2 == 0 && self.zz_um2 == 0 && self.sigma_heading_nrad == 0
    }

    /// What the errors of the pose add to the covariance of a place seen from it.
    pub(crate) fn spread_at(&self, [x, z]: [f64; 2]) -> [[f64; 2]; 2] {
        let [[xx, xz], [_, zz]] = self.covariance_m2();
        // A small turn to the left moves what is at (dx, dz) by (-dz, dx).
        let [dx, dz] = [x - self.pose.x_m(), z - self.pose.z_m()];
        let turn = self.sigma_heading_rad().powi(2);
        [
            [xx + turn * dz * dz, xz - turn * dx * dz],
            [xz - turn * dx * dz, zz + turn * dx * dx],
        ]
    }
}

impl From<GroundPose> for RobotPose {
    /// A pose that is exact.
    fn from(pose: GroundPose) -> Self {
        Self {
            pose,
            ..Self::default()
        }
    }
}
