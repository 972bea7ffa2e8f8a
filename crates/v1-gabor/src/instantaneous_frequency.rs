use ndarray::{Array2, Zip};

use crate::Responses;
use crate::logarithmic_derivative::logarithmic_derivative;

/// How fast the phase of one orientation turns at every pixel, in radians a pixel of its scale.
///
/// Near [singularities](Responses::singularities) it means nothing.
#[derive(Clone, Debug, PartialEq)]
pub struct InstantaneousFrequency {
    /// `[[y, x]]`: radians a pixel along x. NaN where the response is 0.
    pub along_x: Array2<f32>,
    /// `[[y, x]]`: radians a pixel along y. NaN where the response is 0.
    pub along_y: Array2<f32>,
}

impl Responses {
    /// The instantaneous frequency of one orientation: the gradient of its phase,
    /// `grad phi_q = k_q + Im(conj(u) grad u) / |u|^2` with `u = G_q exp(-j k_q.x)`.
    ///
    /// The derivative is that of the demodulated response, so nothing is unwrapped. The ratio of
    /// the two eyes' frequencies is the gradient of disparity.
    ///
    /// # Panics
    /// If there is no such orientation.
    #[must_use]
    pub fn instantaneous_frequency(&self, orientation: usize) -> InstantaneousFrequency {
        let wave = self.params().wave_vectors()[orientation];
        let dim = self.size().dim();
        let mut frequency = InstantaneousFrequency {
            along_x: Array2::zeros(dim),
            along_y: Array2::zeros(dim),
        };
        Zip::indexed(&mut frequency.along_x)
            .and(&mut frequency.along_y)
            .for_each(|(y, x), along_x, along_y| {
                (*along_x, *along_y) = logarithmic_derivative(self, orientation, wave, x, y)
                    .map_or((f32::NAN, f32::NAN), |change| {
                        (wave.x + change.x.im, wave.y + change.y.im)
                    });
            });
        frequency
    }
}
