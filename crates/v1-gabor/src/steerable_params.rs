use std::f32::consts::FRAC_PI_2;

use crate::{BadParams, GaborParams, Size};

/// Which derivative of a Gaussian a steerable pair is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum SteerableOrder {
    /// `s2`: the second derivative, 1.76 octaves wide; 7 separable basis filters steer it.
    Second,
    /// `s4`: the fourth derivative, 1.22 octaves wide; 11 separable basis filters steer it.
    Fourth,
}

/// What a bank of Freeman and Adelson's (1991) steerable quadrature filters is made of.
///
/// The bandwidth is not among the parameters: it is the [order](SteerableOrder)'s own.
///
/// ```
/// use v1_gabor::{FilterBank, Size, SteerableOrder, SteerableParams};
///
/// let size = Size { width: 320, height: 240 };
/// let s2 = SteerableParams { order: SteerableOrder::Second, ..SteerableParams::default() };
/// let bank = FilterBank::plan(s2.fitted_to(size), size)?;
/// assert!((bank.params().bandwidth - 1.765).abs() < 0.001);
/// # Ok::<(), v1_gabor::BadParams>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SteerableParams {
    /// Second or fourth.
    pub order: SteerableOrder,
    /// Number `K` of orientations: the wave vector of filter `q` points along `q pi / K`.
    pub orientations: usize,
    /// Number of scales, each half the size of the one before.
    pub scales: usize,
    /// Peak frequency `omega0` of every filter, in radians a pixel of its own scale.
    pub peak_frequency: f32,
    /// Taps on either side of the centre: a filter is `2 radius + 1` taps wide.
    pub radius: usize,
}

impl Default for SteerableParams {
    /// Fourth order, and otherwise as the Gabor filters: eight orientations, six scales, `pi / 2`
    /// rad/px, 11 x 11 taps.
    fn default() -> Self {
        Self {
            order: SteerableOrder::Fourth,
            orientations: 8,
            scales: 6,
            peak_frequency: FRAC_PI_2,
            radius: 5,
        }
    }
}

impl SteerableOrder {
    /// Octaves between the two frequencies of half gain.
    ///
    /// The spectrum of the n-th derivative is `t^n exp(n (1 - t^2) / 2)`, `t` being the frequency
    /// over the peak's. It is one half at `t` = 0.4816 and 1.6366 for the second, 0.6169 and
    /// 1.4415 for the fourth.
    #[must_use]
    pub const fn bandwidth(self) -> f32 {
        match self {
            Self::Second => 1.7647,
            Self::Fourth => 1.2244,
        }
    }

    /// The upper frequency of half gain over the peak frequency.
    const fn upper_edge(self) -> f32 {
        match self {
            Self::Second => 1.6366,
            Self::Fourth => 1.4415,
        }
    }

    /// Peak frequency of the pair whose envelope is `exp(-r^2)`, in radians a unit of `r`: the root
    /// of twice the order.
    pub(crate) fn natural_frequency(self) -> f64 {
        match self {
            Self::Second => 2.0,
            Self::Fourth => 8.0f64.sqrt(),
        }
    }
}

impl SteerableParams {
    /// The Gabor filters of the same orientations, scales, peak frequency, bandwidth and width.
    #[must_use]
    pub const fn as_gabor(&self) -> GaborParams {
        GaborParams {
            orientations: self.orientations,
            scales: self.scales,
            peak_frequency: self.peak_frequency,
            bandwidth: self.order.bandwidth(),
            radius: self.radius,
        }
    }

    /// The same parameters with no more scales than an image of this size carries.
    #[must_use]
    pub fn fitted_to(self, size: Size) -> Self {
        Self {
            scales: self.as_gabor().fitted_to(size).scales,
            ..self
        }
    }

    /// Units of the filters' own coordinate a pixel.
    pub(crate) fn units_a_pixel(&self) -> f64 {
        f64::from(self.peak_frequency) / self.order.natural_frequency()
    }

    /// Checks that a bank with these parameters exists for images of this size.
    pub(crate) fn check(&self, size: Size) -> Result<(), BadParams> {
        self.as_gabor().check_grid(size)?;
        let upper_edge = self.peak_frequency * self.order.upper_edge();
        if upper_edge > std::f32::consts::PI {
            return Err(BadParams::Band {
                peak_frequency: self.peak_frequency,
                upper_edge,
            });
        }
        // At 2.7 units the fourth derivative is down to 3 % of its peak, the second to 1 %.
        let least = (2.7 / self.units_a_pixel()).ceil() as usize;
        if self.radius < least {
            return Err(BadParams::Radius {
                radius: self.radius,
                sigma_px: (1.0 / (2.0f64.sqrt() * self.units_a_pixel())) as f32,
                least,
            });
        }
        Ok(())
    }
}
