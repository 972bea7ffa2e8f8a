use faer::Mat;
use faer::linalg::solvers::{DenseSolveCore, Solve};

use crate::RigDrift;

/// What is known of a rig's drift: a value, and the information about it that five numbers share.
///
/// It goes into a look as what is expected and comes out as what is known then; in between it ages,
/// for a rig may slip from one look to the next. The caller holds it: nothing else remembers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriftBelief {
    drift: RigDrift,
    information: [[f64; 5]; 5],
}

/// A standard deviation that is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("nothing is expected to within {sigma} of {parameter}; it must be positive")]
pub struct NoSigma {
    /// Which number it was for.
    pub parameter: &'static str,
    /// The standard deviation given.
    pub sigma: f64,
}

impl DriftBelief {
    /// A drift known to one standard deviation of each number, infinite where nothing is known.
    ///
    /// # Errors
    /// [`NoSigma`] if one is not positive.
    pub fn new(drift: RigDrift, sigma: &RigDrift) -> Result<Self, NoSigma> {
        let named = sigma.to_array().into_iter().zip(RigDrift::NAMES);
        for (sigma, parameter) in named {
            if sigma.is_nan() || sigma <= 0.0 {
                return Err(NoSigma { parameter, sigma });
            }
        }
        Ok(Self::of_sigma(drift, sigma))
    }

    pub(crate) fn of_sigma(drift: RigDrift, sigma: &RigDrift) -> Self {
        let sigma = sigma.to_array();
        Self {
            drift,
            information: std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    if i == j {
                        1.0 / (sigma[i] * sigma[i])
                    } else {
                        0.0
                    }
                })
            }),
        }
    }

    pub(crate) const fn of_information(drift: RigDrift, information: [[f64; 5]; 5]) -> Self {
        Self { drift, information }
    }

    /// The drift that is thought likeliest.
    #[must_use]
    pub const fn drift(&self) -> RigDrift {
        self.drift
    }

    /// The inverse of the covariance of [`RigDrift::to_array`]; zeros where nothing is known.
    #[must_use]
    pub const fn information(&self) -> [[f64; 5]; 5] {
        self.information
    }

    /// One standard deviation of each number, infinite where nothing is known of any.
    #[must_use]
    pub fn sigma(&self) -> RigDrift {
        let known = self.information;
        // What is unknown has an empty row; it is left out by a huge variance of its own.
        let scale: [f64; 5] = std::array::from_fn(|i| {
            if known[i][i] > 0.0 {
                known[i][i].sqrt().recip()
            } else {
                0.0
            }
        });
        let scaled = Mat::from_fn(5, 5, |i, j| {
            let own = if i == j && scale[i] == 0.0 { 1.0 } else { 0.0 };
            scale[i] * known[i][j] * scale[j] + own
        });
        let covariance = scaled.col_piv_qr().inverse();
        RigDrift::from_array(std::array::from_fn(|i| {
            if scale[i] > 0.0 {
                scale[i] * covariance[(i, i)].max(0.0).sqrt()
            } else {
                f64::INFINITY
            }
        }))
    }

    /// What is left of the belief when each number may since have changed, by this one standard
    /// deviation: 0 where it cannot have, infinite where it may be anything.
    ///
    /// The covariance grows by the squares of the changes; in terms of information
    /// `I' = (1 + I Q)^-1 I`, which holds where nothing is known, too.
    #[must_use]
    pub fn aged(&self, change: &RigDrift) -> Self {
        // Beyond any angle and any share of a baseline; infinity itself has no products.
        const ANYTHING: f64 = 1e3;
        let change = change.to_array().map(|sigma| sigma.clamp(0.0, ANYTHING));
        // Scaled by the square root of what is known, so that the numbers stay comparable.
        let system = Mat::from_fn(5, 5, |i, j| {
            let own = if i == j { 1.0 } else { 0.0 };
            own + self.information[i][j] * change[j] * change[j]
        });
        let known = Mat::from_fn(5, 5, |i, j| self.information[i][j]);
        let left = system.col_piv_qr().solve(&known);
        Self {
            drift: self.drift,
            // Symmetric but for rounding.
            information: std::array::from_fn(|i| {
                std::array::from_fn(|j| f64::midpoint(left[(i, j)], left[(j, i)]))
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Variances of what is independent add.
        #[test]
        fn ageing_adds_variances(
            sigma in prop::array::uniform5(1e-4f64..0.1),
            change in prop::array::uniform5(0.0f64..0.1),
        ) {
            let belief = DriftBelief::new(RigDrift::default(), &RigDrift::from_array(sigma))
                .expect("they are positive");
            let aged = belief.aged(&RigDrift::from_array(change)).sigma().to_array();
            for i in 0..5 {
                prop_assert!((aged[i] / sigma[i].hypot(change[i]) - 1.0).abs() < 1e-9);
            }
        }
    }

    /// What is unknown stays unknown, and says so.
    #[test]
    fn nothing_known_stays_nothing() {
        let mut sigma = RigDrift::from_array([0.01; 5]);
        sigma.pitch_rad = f64::INFINITY;
        let belief = DriftBelief::new(RigDrift::default(), &sigma).unwrap();
        let aged = belief.aged(&RigDrift {
            yaw_rad: f64::INFINITY,
            ..RigDrift::default()
        });
        assert_eq!(aged.sigma().pitch_rad, f64::INFINITY);
        assert!(aged.sigma().yaw_rad > 100.0);
        assert!((aged.sigma().roll_rad - 0.01).abs() < 1e-12);
        sigma.down = 0.0;
        assert_eq!(
            DriftBelief::new(RigDrift::default(), &sigma),
            Err(NoSigma {
                parameter: "down",
                sigma: 0.0
            })
        );
    }
}
