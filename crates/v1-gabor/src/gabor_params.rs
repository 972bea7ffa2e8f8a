use std::f32::consts::{FRAC_PI_2, PI};

use crate::Size;

/// What a bank of Gabor filters is made of. The default is the paper's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GaborParams {
    /// Number `K` of orientations: the wave vector of filter `q` points along `q pi / K`.
    pub orientations: usize,
    /// Number of scales, each half the size of the one before.
    pub scales: usize,
    /// Peak frequency `omega0` of every filter, in radians a pixel of its own scale.
    pub peak_frequency: f32,
    /// Bandwidth of every filter at half its peak gain, in octaves.
    pub bandwidth: f32,
    /// Taps on either side of the centre: a filter is `2 radius + 1` taps wide.
    pub radius: usize,
}

impl Default for GaborParams {
    /// Eight orientations, six scales, `pi / 2` rad/px, one octave, 11 x 11 taps.
    fn default() -> Self {
        Self {
            orientations: 8,
            scales: 6,
            peak_frequency: FRAC_PI_2,
            bandwidth: 1.0,
            radius: 5,
        }
    }
}

/// Why no bank can be planned with these parameters.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BadParams {
    /// Too few orientations to see every direction, or more than the layout holds.
    #[error("{0} orientations: a bank has 4 to 32 of them")]
    Orientations(usize),
    /// No scale at all.
    #[error("a bank needs at least one scale")]
    NoScale,
    /// The coarsest scale would be smaller than half a filter.
    #[error(
        "{scales} scales leave {coarsest} pixels of an image of {size}, less than half a filter of \
         {taps} taps; this image carries at most {most}"
    )]
    TooManyScales {
        /// Scales asked for.
        scales: usize,
        /// Most scales that this image carries.
        most: usize,
        /// Size of the image.
        size: Size,
        /// Size of the coarsest scale asked for.
        coarsest: Size,
        /// Width of a filter in taps.
        taps: usize,
    },
    /// The peak frequency is not between standstill and the Nyquist frequency.
    #[error("a peak frequency of {0} rad/px is not between 0 and pi")]
    PeakFrequency(f32),
    /// Half the peak gain is still exceeded at the Nyquist frequency, where even and odd filters
    /// part.
    #[error(
        "at a peak of {peak_frequency} rad/px the band of this family ends at {upper_edge} rad/px, \
         beyond the Nyquist frequency; a lower peak frequency helps"
    )]
    Band {
        /// Peak frequency asked for, in rad/px.
        peak_frequency: f32,
        /// Where the gain falls to half above it, in rad/px.
        upper_edge: f32,
    },
    /// The bandwidth is not a positive number of octaves.
    #[error("a bandwidth of {0} octaves is not positive and finite")]
    Bandwidth(f32),
    /// The window cuts the envelope off where it is still large.
    #[error(
        "a radius of {radius} taps cuts an envelope of sigma {sigma_px} px off; it needs at least \
         {least} taps, or a higher peak frequency or a larger bandwidth"
    )]
    Radius {
        /// Radius asked for, in taps.
        radius: usize,
        /// Standard deviation of the envelope that frequency and bandwidth give, in pixels.
        sigma_px: f32,
        /// Least radius that holds it, in taps.
        least: usize,
    },
    /// An image without pixels.
    #[error("an image of {0} has no pixel")]
    EmptyImage(Size),
}

impl GaborParams {
    /// Standard deviation of the Gaussian envelope, in pixels: the one whose gain falls to half
    /// at the edges of the band, `sqrt(2 ln 2) / omega0 (2^b + 1) / (2^b - 1)`.
    #[must_use]
    pub fn sigma_px(&self) -> f32 {
        let octaves = self.bandwidth.exp2();
        (2.0 * 2.0f32.ln()).sqrt() / self.peak_frequency * (octaves + 1.0) / (octaves - 1.0)
    }

    /// Width of a filter in taps.
    #[must_use]
    pub const fn taps(&self) -> usize {
        2 * self.radius + 1
    }

    /// The most scales that an image of this size carries: the coarsest one must be at least half
    /// a filter wide and high (replicated borders stand in for the other half). At least one.
    #[must_use]
    pub fn most_scales(&self, size: Size) -> usize {
        let mut scales = 1;
        let mut coarser = size.halved();
        while coarser.width.min(coarser.height) > self.radius {
            scales += 1;
            coarser = coarser.halved();
        }
        scales
    }

    /// The same parameters with no more scales than an image of this size carries.
    #[must_use]
    pub fn fitted_to(self, size: Size) -> Self {
        Self {
            scales: self.scales.min(self.most_scales(size)),
            ..self
        }
    }

    /// Checks that a bank with these parameters exists for images of this size.
    pub(crate) fn check(&self, size: Size) -> Result<(), BadParams> {
        self.check_grid(size)?;
        let sigma_px = self.sigma_px();
        // At 1.9 sigma the envelope is down to a sixth; the paper's 5 taps are 2.2 sigma.
        let least = (1.9 * sigma_px).ceil() as usize;
        if self.radius < least {
            return Err(BadParams::Radius {
                radius: self.radius,
                sigma_px,
                least,
            });
        }
        Ok(())
    }

    /// Checks what all families have in common: everything but the fit of the window.
    pub(crate) fn check_grid(&self, size: Size) -> Result<(), BadParams> {
        if size.area() == 0 {
            return Err(BadParams::EmptyImage(size));
        }
        if !(4..=32).contains(&self.orientations) {
            return Err(BadParams::Orientations(self.orientations));
        }
        if !(self.peak_frequency > 0.0 && self.peak_frequency < PI) {
            return Err(BadParams::PeakFrequency(self.peak_frequency));
        }
        if !(self.bandwidth > 0.0 && self.bandwidth.is_finite()) {
            return Err(BadParams::Bandwidth(self.bandwidth));
        }
        if self.scales == 0 {
            return Err(BadParams::NoScale);
        }
        let most = self.most_scales(size);
        if self.scales > most {
            let coarsest = (1..self.scales).fold(size, |size, _| size.halved());
            return Err(BadParams::TooManyScales {
                scales: self.scales,
                most,
                size,
                coarsest,
                taps: self.taps(),
            });
        }
        Ok(())
    }
}
