use ndarray::{Array2, ArrayView2};

/// What a camera makes of light: electrons that arrive by chance, a noisy reading of them, eight bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct CameraNoise {
    /// Electrons of a white pixel.
    full_well: f64,
    /// Standard deviation of a reading, electrons.
    read: f64,
}

impl Default for CameraNoise {
    /// A small machine vision sensor: a hundred to one in white, thirty to one in a tenth of it.
    fn default() -> Self {
        Self {
            full_well: 10_000.0,
            read: 10.0,
        }
    }
}

impl CameraNoise {
    /// A picture of this light, from 0 to 1. The same seed gives the same noise on every machine.
    pub(crate) fn take(&self, light: ArrayView2<'_, f32>, seed: u64) -> Array2<u8> {
        let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        light.mapv(|light| {
            let electrons = self.full_well * f64::from(light).clamp(0.0, 1.0);
            // Thousands of electrons arrive as a normal distribution has it.
            let sigma = (electrons + self.read * self.read).sqrt();
            let seen = electrons + sigma * gaussian(&mut state);
            (255.0 * seen / self.full_well).round().clamp(0.0, 255.0) as u8
        })
    }
}

/// A Gaussian number from a shift register (xorshift64*), by Box and Muller.
fn gaussian(state: &mut u64) -> f64 {
    let mut uniform = || {
        *state ^= *state >> 12;
        *state ^= *state << 25;
        *state ^= *state >> 27;
        let bits = state.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        (bits as f64 + 0.5) / (1u64 << 53) as f64
    };
    let radius = (-2.0 * uniform().ln()).sqrt();
    radius * (std::f64::consts::TAU * uniform()).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A grey of a quarter has the noise of its electrons, in greys.
    #[test]
    fn noise_is_that_of_the_electrons() {
        let light = Array2::from_elem((200, 200), 0.25f32);
        let codes = CameraNoise::default().take(light.view(), 3);
        let mean = codes.iter().map(|&c| f64::from(c)).sum::<f64>() / 40_000.0;
        let variance = codes
            .iter()
            .map(|&c| (f64::from(c) - mean).powi(2))
            .sum::<f64>()
            / 40_000.0;
        let electrons = (2500.0f64 + 100.0).sqrt() / 10_000.0 * 255.0;
        // Rounding to whole greys adds a twelfth; 40,000 samples leave a percent.
        assert!((variance - electrons * electrons - 1.0 / 12.0).abs() < 0.05);
        assert!((mean - 63.75).abs() < 0.03);
    }
}
