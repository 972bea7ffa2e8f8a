use std::f32::consts::{FRAC_PI_2, PI};

use crate::{BadParams, GaborParams, Size};

/// What a bank of spherical quadrature filters is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonogenicParams {
    /// Number of scales, each half the size of the one before.
    pub scales: usize,
    /// Peak frequency `omega0`, in radians a pixel of its own scale.
    pub peak_frequency: f32,
    /// Bandwidth at half the peak gain, in octaves.
    pub bandwidth: f32,
}

impl Default for MonogenicParams {
    /// Six scales, `pi / 2` rad/px, one octave.
    fn default() -> Self {
        Self {
            scales: 6,
            peak_frequency: FRAC_PI_2,
            bandwidth: 1.0,
        }
    }
}

impl MonogenicParams {
    /// The same parameters with no more scales than an image of this size carries.
    #[must_use]
    pub fn fitted_to(self, size: Size) -> Self {
        Self {
            scales: self.as_gabor().fitted_to(size).scales,
            ..self
        }
    }

    /// The radial gain at a frequency of `omega` rad/px, at most one half: a Gaussian over the
    /// octaves, `exp(-ln(omega / omega0)^2 / (2 s^2)) / 2`, 0 at standstill.
    ///
    /// A half, because an image is real: a grating of amplitude `A` then answers with `A / 2`, as
    /// it does in the oriented families, and a threshold on energy means the same in all.
    #[must_use]
    pub fn radial_gain(&self, omega: f32) -> f32 {
        if omega <= 0.0 {
            return 0.0;
        }
        // Half gain lies half a bandwidth of octaves from the peak: s sqrt(2 ln 2) = b/2 ln 2.
        let deviation = self.bandwidth / 2.0 * 2.0f32.ln() / (2.0 * 2.0f32.ln()).sqrt();
        let octaves = (omega / self.peak_frequency).ln() / deviation;
        0.5 * (-0.5 * octaves * octaves).exp()
    }

    /// Pixels of replicated border that keep the two ends of an image apart in the Fourier domain:
    /// four periods of the peak frequency at one octave, where the filter has died away.
    pub(crate) fn margin(&self) -> usize {
        (8.0 * PI / (self.peak_frequency * self.bandwidth)).ceil() as usize
    }

    /// The Gabor filters of the same scales, frequency and bandwidth, wide enough for them.
    fn as_gabor(&self) -> GaborParams {
        GaborParams {
            scales: self.scales,
            peak_frequency: self.peak_frequency,
            bandwidth: self.bandwidth,
            ..GaborParams::default()
        }
    }

    /// Checks that a bank with these parameters exists for images of this size.
    pub(crate) fn check(&self, size: Size) -> Result<(), BadParams> {
        self.as_gabor().check_grid(size)?;
        let upper_edge = self.peak_frequency * (self.bandwidth / 2.0).exp2();
        if upper_edge > PI {
            return Err(BadParams::Band {
                peak_frequency: self.peak_frequency,
                upper_edge,
            });
        }
        Ok(())
    }
}
