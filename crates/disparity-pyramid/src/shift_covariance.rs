use std::f32::consts::FRAC_PI_4;
use std::ops::Range;

use ndarray::Array2;
use rayon::prelude::*;
use v1_gabor::GaborParams;

use crate::{MatchParams, MedianRadius, Validity};

/// How uncertain a shift `(dx, dy)` is: the covariance of its two components, in square pixels.
///
/// Per pixel the least-squares fit of equation 3 has `M = sum_q w_q k_q k_q^T` and leaves the phases
/// `r_q`, its weights being those of the last robust round. Its covariance is
///
/// `C = s^2 A M A`, `A = (M + P)^-1`, `s^2 = sum_q w_q r_q^2 / nu`, `nu = nu_K (n - p) / (K - p)`
///
/// with the vertical prior's weight `P` on `dy` alone, for `n` of `K` orientations heard and `p` unknowns (2, or 1 where only rows are searched). The
/// effective degrees of freedom `nu_K` are fewer than `K - p`, as neighbouring filters overlap and
/// hear the same noise: the responses of two orientations `a` apart correlate by
/// `rho = exp(-(omega0 sigma sin(a/2))^2)`, and the errors of their phases, on a texture as white as
/// the noise, by `c = (pi/4) rho^2 F(1/2, 1/2; 2; rho^2)`. With `R` the matrix of these and `P` the
/// projection onto the phases that a shift can make, `nu_K = p tr((I - P) R) / tr(P R)`: for the
/// paper's bank about 3 in place of 6.
///
/// A value is the mean of the fits in 5 x 5 pixels, as one fit has so few degrees of freedom, plus a floor of 0.01 px in
/// each component, which is what the finest warp leaves of a shift without any noise, times
/// the part of the variance that `m` medians over windows of variance `v` leave of errors as smooth
/// as those of phases, `(sigma^2 / 2) / (sigma^2 / 2 + m v)`. Where every second pixel is fitted the windows are
/// as much wider, and the mean of neighbours that the pixels between take counts as one more.
///
/// On random dots under white noise of 2.5 to 5 grey levels in 256, an error over its `sigma_dx` has a
/// standard deviation of .8 to 1.1 (`tests/sigma_is_the_error.rs`). The covariance speaks of noise
/// alone. It does not know of a search that took a wrong period, of a surface that slants under the
/// filters, or of an edge that the medians round: on Venus and Sawtooth, 68 % of the errors lie within
/// 2.0 and 2.7 `sigma_dx`, though the surest eighth of the pixels errs by a quarter of what the
/// least sure does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShiftCovariance {
    /// Variance of `dx`.
    pub xx: f32,
    /// Covariance of `dx` and `dy`.
    pub xy: f32,
    /// Variance of `dy`; 0 where it is held.
    pub yy: f32,
}

/// Standard deviation that no fit falls below, in pixels, before medians: what the finest warp leaves of a shift
/// without any noise, on random dots (0.010 to 0.013).
const FLOOR_PX: f32 = 0.01;

/// Half the width of the window of fits that a value is the mean of, in pixels: what
/// [`fill`](crate::fill::fill) looks at, so that a filled pixel has a neighbour with a fit.
const REACH: usize = 2;

impl ShiftCovariance {
    /// That of a shift of which nothing is known.
    pub const UNKNOWN: Self = Self {
        xx: f32::INFINITY,
        xy: 0.0,
        yy: f32::INFINITY,
    };

    /// One standard deviation of `dx`, in pixels; infinite where nothing is known.
    #[must_use]
    pub fn sigma_dx(self) -> f32 {
        self.xx.sqrt()
    }

    /// One standard deviation of `dy`, in pixels; infinite where nothing is known.
    #[must_use]
    pub fn sigma_dy(self) -> f32 {
        self.yy.sqrt()
    }

    /// The correlation of `dx` and `dy`, from -1 to 1; 0 where either is unknown or held.
    #[must_use]
    pub fn correlation(self) -> f32 {
        let product = self.xx.sqrt() * self.yy.sqrt();
        if product > 0.0 && product.is_finite() {
            (self.xy / product).clamp(-1.0, 1.0)
        } else {
            0.0
        }
    }
}

/// The covariance of every valid shift from those of the fits, `[[y, x]]`: their mean over 5 x 5
/// pixels, corrected for overlapping filters and medians. The pixels are those that are fitted, `step`
/// apart. Unknown where there is no answer.
pub(crate) fn pooled(
    fits: &Array2<FitCovariance>,
    validity: &Array2<Validity>,
    (bank, step): (GaborParams, usize),
    params: &MatchParams,
) -> Array2<ShiftCovariance> {
    let left = left_by_medians(bank, step, params);
    let scale = overlap(bank, params.rows_only) * left;
    let floor = FLOOR_PX * FLOOR_PX * left;
    let floor_y = if params.rows_only { 0.0 } else { floor };
    let mut pooled = Array2::from_elem(fits.dim(), ShiftCovariance::UNKNOWN);
    let (height, width) = fits.dim();
    pooled
        .as_slice_mut()
        .expect("a fresh array is contiguous")
        .par_chunks_mut(width)
        .enumerate()
        .for_each_init(
            || vec![FitCovariance::UNKNOWN; width],
            |columns, (y, pooled)| {
                columns.fill(FitCovariance::UNKNOWN);
                for row in around(y, height) {
                    for (column, fit) in columns.iter_mut().zip(fits.row(row)) {
                        column.add(fit);
                    }
                }
                for (x, (out, validity)) in pooled.iter_mut().zip(validity.row(y)).enumerate() {
                    if !validity.is_valid() {
                        continue;
                    }
                    let mut sum = FitCovariance::UNKNOWN;
                    for column in &columns[around(x, width)] {
                        sum.add(column);
                    }
                    if sum.fits > 0.0 {
                        let mean = scale / sum.fits;
                        *out = ShiftCovariance {
                            xx: sum.xx * mean + floor,
                            xy: sum.xy * mean,
                            yy: sum.yy * mean + floor_y,
                        };
                    }
                }
            },
        );
    pooled
}

/// The covariance of one fit, or several added up.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FitCovariance {
    pub(crate) xx: f32,
    pub(crate) xy: f32,
    pub(crate) yy: f32,
    /// How many fits, as a number that adds up in the same registers.
    pub(crate) fits: f32,
}

impl FitCovariance {
    /// No fit at all.
    pub(crate) const UNKNOWN: Self = Self {
        xx: 0.0,
        xy: 0.0,
        yy: 0.0,
        fits: 0.0,
    };

    fn add(&mut self, other: &Self) {
        self.xx += other.xx;
        self.xy += other.xy;
        self.yy += other.yy;
        self.fits += other.fits;
    }
}

/// The rows or columns that a window around one of them reaches, of `length`.
fn around(at: usize, length: usize) -> Range<usize> {
    at.saturating_sub(REACH)..(at + REACH + 1).min(length)
}

/// How many times larger the variance is than that of independent orientations: `(K - p) / nu_K`.
fn overlap(bank: GaborParams, rows_only: bool) -> f32 {
    let waves = bank.wave_vectors();
    let reach = bank.peak_frequency * bank.sigma_px();
    let correlation = |a: usize, b: usize| {
        // Through half a turn a filter becomes its own conjugate, whose phase has the other sign.
        let apart = |wave: (f32, f32)| {
            let (x, y) = (waves[a].x - wave.0, waves[a].y - wave.1);
            // |k_a - k_b| = 2 omega0 sin(angle / 2).
            let half = 0.5 * x.hypot(y) / bank.peak_frequency;
            of_phases((-(reach * half).powi(2)).exp())
        };
        apart((waves[b].x, waves[b].y)) - apart((-waves[b].x, -waves[b].y))
    };
    let orientations = waves.len();
    // The wave vectors are evenly spread over half a turn, so that `sum k k^T` is `K omega0^2 / 2`
    // times the unit matrix and the projections onto their components need no inverse.
    let norm = 0.5 * orientations as f32 * bank.peak_frequency.powi(2);
    let (mut told, mut all) = (0.0, 0.0);
    for a in 0..orientations {
        all += correlation(a, a);
        for b in 0..orientations {
            let along_y = if rows_only {
                0.0
            } else {
                waves[a].y * waves[b].y
            };
            told += correlation(a, b) * (waves[a].x * waves[b].x + along_y) / norm;
        }
    }
    let unknowns = if rows_only { 1.0 } else { 2.0 };
    let freedom = unknowns * (all - told) / told;
    (orientations as f32 - unknowns) / freedom
}

/// How far the phase errors of two filters go together that hear the same white noise on a texture as
/// white, their responses correlating by `rho`: `rho` times the mean cosine of the angle between the
/// responses to the texture, `(pi / 4) rho F(1/2, 1/2; 2; rho^2)`.
fn of_phases(rho: f32) -> f32 {
    if rho > 0.999 {
        return rho;
    }
    let square = rho * rho;
    let (mut term, mut series) = (1.0, 1.0);
    for n in 0..60u8 {
        let n = f32::from(n);
        term *= (n + 0.5).powi(2) / ((n + 2.0) * (n + 1.0)) * square;
        series += term;
    }
    FRAC_PI_4 * square * series
}

/// The part of the variance that the medians after the last warp leave.
///
/// The error of a fit is as smooth as the filters' envelope: it correlates over `r` pixels by
/// `exp(-r^2 / (4 sigma^2))`. On noise as smooth as that a median is nearly a mean, and `m` means over
/// windows of variance `v` leave `sigma^2 / (sigma^2 + m v)` in two dimensions.
fn left_by_medians(bank: GaborParams, step: usize, params: &MatchParams) -> f32 {
    let window = match params.median_radius {
        MedianRadius::One => (9.0 - 1.0) / 12.0,
        MedianRadius::Two => (25.0 - 1.0) / 12.0,
    };
    let envelope = 0.5 * bank.sigma_px().powi(2);
    // Half of the columns, and of the rows, lie half a step from two samples.
    let window = window * (step * step) as f32;
    let between = if step > 1 {
        0.5 * (0.5 * step as f32).powi(2)
    } else {
        0.0
    };
    envelope / (envelope + params.medians as f32 * window + between)
}
