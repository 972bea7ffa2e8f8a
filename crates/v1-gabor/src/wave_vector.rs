use std::f64::consts::PI;

use crate::GaborParams;

/// The wave vector `k_q = omega0 (cos theta_q, sin theta_q)` of one orientation, in radians a
/// pixel of its own scale. `theta_q = q pi / K` is the direction in which the phase grows, not the
/// direction of the bars.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WaveVector {
    /// Radians a pixel along x.
    pub x: f32,
    /// Radians a pixel along y.
    pub y: f32,
}

impl GaborParams {
    /// The wave vector of each orientation, in order.
    #[must_use]
    pub fn wave_vectors(&self) -> Vec<WaveVector> {
        (0..self.orientations)
            .map(|q| {
                let theta = q as f64 * PI / self.orientations as f64;
                let omega = f64::from(self.peak_frequency);
                WaveVector {
                    x: (omega * theta.cos()) as f32,
                    y: (omega * theta.sin()) as f32,
                }
            })
            .collect()
    }
}
