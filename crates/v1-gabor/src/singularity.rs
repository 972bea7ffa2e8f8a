use ndarray::Array2;

use crate::Responses;
use crate::logarithmic_derivative::logarithmic_derivative;

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
        let params = self.params();
        let wave = params.wave_vectors()[orientation];
        let octaves = params.bandwidth.exp2();
        let half_band = params.peak_frequency * (octaves - 1.0) / (octaves + 1.0);
        let limit = (tau * half_band).powi(2);
        Array2::from_shape_fn(self.size().dim(), |(y, x)| {
            logarithmic_derivative(self, orientation, wave, x, y)
                .is_none_or(|change| change.x.norm_sqr() + change.y.norm_sqr() > limit)
        })
    }
}
