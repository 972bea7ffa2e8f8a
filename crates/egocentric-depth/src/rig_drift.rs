use v1_gabor::Binocular;

use crate::eye::Eye;
use crate::rotation::Rotation;
use crate::{Position, StereoRig};

/// How the right eye has drifted from its nominal place, the left eye being the reference.
///
/// The same five numbers serve for a drift, for its standard errors and for a prior. The length of
/// the baseline is not among them: images alone never tell it.
///
/// For a parallel rig and small angles, with normalised coordinates `x, y` and depth `Z`, the drift
/// adds `dy = pitch (1 + y^2) - yaw x y - roll x + b (y forward - down) / Z` to the vertical and
/// `dx = -yaw (1 + x^2) + pitch x y + roll y + b x forward / Z` to the horizontal disparity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RigDrift {
    /// How far the right eye looks up, in radians.
    pub pitch_rad: f64,
    /// How far the right eye looks to the right of its nominal pan, in radians; negative when the
    /// eyes converge more than they should.
    pub yaw_rad: f64,
    /// How far the right eye leans clockwise, seen from behind, in radians.
    pub roll_rad: f64,
    /// How far the right eye sits below the left one, in baselines.
    pub down: f64,
    /// How far the right eye sits in front of the left one, in baselines.
    pub forward: f64,
}

impl RigDrift {
    /// The names of the five numbers, in the order of [`RigDrift::to_array`].
    pub const NAMES: [&'static str; 5] = ["pitch", "yaw", "roll", "down", "forward"];

    /// Pitch, yaw and roll in radians, down and forward in baselines.
    #[must_use]
    pub const fn to_array(&self) -> [f64; 5] {
        [
            self.pitch_rad,
            self.yaw_rad,
            self.roll_rad,
            self.down,
            self.forward,
        ]
    }

    /// The inverse of [`RigDrift::to_array`].
    #[must_use]
    pub const fn from_array([pitch_rad, yaw_rad, roll_rad, down, forward]: [f64; 5]) -> Self {
        Self {
            pitch_rad,
            yaw_rad,
            roll_rad,
            down,
            forward,
        }
    }

    /// The turn of the right eye that the drift adds, in the axes of that eye:
    /// `exp [pitch, yaw, roll]`.
    #[must_use]
    pub fn turn(&self) -> Rotation {
        Rotation::from_vector([self.pitch_rad, self.yaw_rad, self.roll_rad])
    }

    /// The attitude of the right eye of `rig` with the drift added: its nominal pan after
    /// [`RigDrift::turn`].
    #[must_use]
    pub fn right_rotation(&self, rig: &StereoRig) -> Rotation {
        rig.eyes().right.rotation.after(&self.turn())
    }

    /// The eyes of `rig` with the drift added: what
    /// [`triangulate_rays`](crate::triangulate_rays()) takes and what a rectification starts from.
    #[must_use]
    pub fn eyes(&self, rig: &StereoRig) -> Binocular<Eye> {
        let Binocular { left, right } = rig.eyes();
        let baseline_m = rig.baseline_m();
        Binocular {
            left,
            right: Eye {
                rotation: self.right_rotation(rig),
                centre: Position::new(
                    right.centre.x_m,
                    right.centre.y_m + baseline_m * self.down,
                    right.centre.z_m + baseline_m * self.forward,
                ),
                ..right
            },
        }
    }
}
