use crate::dense::dense_params::DenseParams;

/// The energy at which a response counts half, in parts of the variance of the picture's noise: noise of a weak
/// texture's strength has phases too, which agree with nothing.
const SILENT_ENERGY_OF_VARIANCE: f32 = 0.05;

/// What is left of the penalties: with noise in both eyes the costs of what matches and of what does not lie
/// nearer together, and undiminished penalties would join surfaces.
const SMALL_STEP: f32 = 0.7;
const LARGE_STEP: f32 = 0.45;

/// What is left of the step of the picture at which a larger step costs a third, where steps are smoothed.
const EDGE_SOFTNESS: f32 = 0.8;

impl DenseParams {
    /// These for a picture whose noise has this standard deviation, in parts of the whole range.
    ///
    /// What each of these gives stands in `docs/level-2.md`, "Noise".
    pub(crate) fn in_noise(self, noise: f32) -> Self {
        Self {
            silent_energy: self
                .silent_energy
                .max(SILENT_ENERGY_OF_VARIANCE * noise * noise),
            small_step: SMALL_STEP * self.small_step,
            large_step: LARGE_STEP * self.large_step,
            edge_softness: EDGE_SOFTNESS * self.edge_softness,
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Whatever the noise, the parameters can be, and more of it silences more.
        #[test]
        fn noise_silences_and_loosens(noise in 0.0f32..0.5, more in 1.1f32..3.0) {
            let given = DenseParams::best();
            let (some, much) = (given.in_noise(noise), given.in_noise(more * noise));
            prop_assert!(some.check().is_ok() && much.check().is_ok());
            prop_assert!(some.silent_energy >= given.silent_energy);
            prop_assert!(much.silent_energy >= some.silent_energy);
            prop_assert!(some.large_step < given.large_step && some.small_step < given.small_step);
            // A larger step stays dearer than a small one.
            prop_assert!(some.small_step < some.large_step);
        }
    }
}
