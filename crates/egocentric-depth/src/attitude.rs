use crate::Rotation;

/// Which way an eye looks in its head: it pans, then tilts, then twists about its own line of
/// sight, as in a gimbal whose outer axis stands upright.
///
/// Every attitude that looks forward has one such description.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Attitude {
    /// About the head's vertical, in radians, positive toward +x.
    pub pan_rad: f64,
    /// Up, in radians.
    pub tilt_rad: f64,
    /// Clockwise as seen from behind, in radians: torsion.
    pub torsion_rad: f64,
}

impl Attitude {
    /// An eye that only pans, by `pan_rad` about the head's vertical, positive toward +x.
    #[must_use]
    pub const fn panned(pan_rad: f64) -> Self {
        Self {
            pan_rad,
            tilt_rad: 0.0,
            torsion_rad: 0.0,
        }
    }

    /// The turn from the eye's frame to the head's.
    #[must_use]
    pub fn rotation(&self) -> Rotation {
        let pan = Rotation::from_vector([0.0, self.pan_rad, 0.0]);
        if self.tilt_rad == 0.0 && self.torsion_rad == 0.0 {
            return pan;
        }
        let tilt = Rotation::from_vector([self.tilt_rad, 0.0, 0.0]);
        let torsion = Rotation::from_vector([0.0, 0.0, self.torsion_rad]);
        pan.after(&tilt).after(&torsion)
    }

    /// The attitude that has this turn: the inverse of [`Attitude::rotation`] for eyes that do not
    /// look straight up or down.
    #[must_use]
    pub fn of(rotation: &Rotation) -> Self {
        // The forward axis is (sin pan cos tilt, -sin tilt, cos pan cos tilt); the second row holds
        // the torsion, cos tilt (sin torsion, cos torsion).
        let [[_, _, x], [across, down, y], [_, _, z]] = rotation.matrix();
        Self {
            pan_rad: x.atan2(z),
            tilt_rad: (-y).atan2(x.hypot(z)),
            torsion_rad: across.atan2(down),
        }
    }

    /// Pan, tilt and torsion.
    #[must_use]
    pub const fn to_array(&self) -> [f64; 3] {
        [self.pan_rad, self.tilt_rad, self.torsion_rad]
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// The three angles come back from the turn.
        #[test]
        fn a_turn_tells_its_angles(angles in prop::array::uniform3(-1.4f64..1.4)) {
            let [pan_rad, tilt_rad, torsion_rad] = angles;
            let sent = Attitude { pan_rad, tilt_rad, torsion_rad };
            let got = Attitude::of(&sent.rotation());
            for (sent, got) in sent.to_array().into_iter().zip(got.to_array()) {
                // Near straight up the pan is six times less sure than the matrix.
                prop_assert!((sent - got).abs() < 1e-14, "{sent} {got}");
            }
        }
    }

    /// The signs that the documentation promises.
    #[test]
    fn tilt_looks_up_and_torsion_leans_clockwise() {
        let up = Attitude {
            tilt_rad: 0.1,
            ..Attitude::default()
        };
        assert!(up.rotation().apply([0.0, 0.0, 1.0])[1] < 0.0);
        let twisted = Attitude {
            torsion_rad: 0.1,
            ..Attitude::default()
        };
        assert!(twisted.rotation().apply([1.0, 0.0, 0.0])[1] > 0.0);
    }
}
