use ndarray::Array2;
use rayon::prelude::*;

use crate::logarithmic_derivative::logarithmic_derivative;
use crate::{Responses, V1Responses, WaveVector};

impl Responses {
    /// Where the phase of one orientation means nothing, `[[y, x]]`: the neighbourhoods of phase
    /// singularities (Fleet & Jepson 1993).
    ///
    /// True where `|grad rho|^2 / rho^2 + |grad phi - k_q|^2 > (tau sigma_k)^2`: amplitude or
    /// frequency change faster than a filter of this band can follow, because two components
    /// nearly cancel. `sigma_k = omega0 (2^b - 1) / (2^b + 1)` is the half width of the band. Both
    /// terms are one number, the squared modulus of the logarithmic derivative of the demodulated
    /// response. Also true where the response is 0.
    ///
    /// `tau` has no unit. 1.25 is Fleet and Jepson's choice and strict; 1.75 keeps most of what
    /// stereo can use.
    ///
    /// # Panics
    /// If there is no such orientation.
    #[must_use]
    pub fn singularities(&self, orientation: usize, tau: f32) -> Array2<bool> {
        let wave = self.params().wave_vectors()[orientation];
        let limit = self.most_change(tau);
        Array2::from_shape_fn(self.size().dim(), |(y, x)| {
            self.is_singular(orientation, wave, limit, (x, y))
        })
    }

    /// The same responses, silent (0) where [`singularities`](Self::singularities) says that the
    /// phase of an orientation means nothing.
    #[must_use]
    pub fn without_singularities(&self, tau: f32) -> Self {
        let params = self.params();
        let waves = params.wave_vectors();
        let limit = self.most_change(tau);
        let mut heard = self.clone();
        let parts = 2 * waves.len();
        let width = self.size().width;
        heard
            .samples_mut()
            .par_chunks_mut(parts * width)
            .enumerate()
            .for_each(|(y, row)| {
                for (x, pixel) in row.chunks_exact_mut(parts).enumerate() {
                    for (q, &wave) in waves.iter().enumerate() {
                        if self.is_singular(q, wave, limit, (x, y)) {
                            pixel[q] = 0.0;
                            pixel[waves.len() + q] = 0.0;
                        }
                    }
                }
            });
        heard
    }

    /// `(tau sigma_k)^2`.
    fn most_change(&self, tau: f32) -> f32 {
        let params = self.params();
        let octaves = params.bandwidth.exp2();
        let half_band = params.peak_frequency * (octaves - 1.0) / (octaves + 1.0);
        (tau * half_band).powi(2)
    }

    fn is_singular(
        &self,
        orientation: usize,
        wave: WaveVector,
        limit: f32,
        (x, y): (usize, usize),
    ) -> bool {
        logarithmic_derivative(self, orientation, wave, x, y)
            .is_none_or(|change| change.x.norm_sqr() + change.y.norm_sqr() > limit)
    }
}

impl V1Responses {
    /// The same responses, silent (0) in the neighbourhoods of phase singularities of every scale:
    /// [`Responses::without_singularities`].
    #[must_use]
    pub fn without_singularities(&self, tau: f32) -> Self {
        let silenced = |scale: &Responses| scale.without_singularities(tau);
        Self::new(self.params(), self.scales().iter().map(silenced).collect())
    }
}
