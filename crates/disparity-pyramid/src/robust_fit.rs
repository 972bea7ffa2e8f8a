use v1_gabor::WaveVector;

use crate::MatchParams;
use crate::phase::wrap;
use crate::tile::{MOST_ORIENTATIONS, TILE};

/// Residual phase at which an orientation's weight has fallen to half, in radians.
const CAUCHY_RAD: f32 = 0.4;

/// Residual phase beyond which the last round does not hear an orientation, in radians.
const DEAF_RAD: f32 = 1.5;

/// Least determinant of the normal equations relative to the square of their trace; below it the
/// orientations heard lie too close together to tell both components.
const LEAST_DETERMINANT: f32 = 1e-3;

/// The shift fitted to the phases of all orientations, for each pixel of a tile.
pub(crate) struct Fit {
    /// Shift along x in pixels; NaN if the orientations heard do not tell both components.
    pub(crate) ux: [f32; TILE],
    /// Shift along y in pixels; NaN likewise.
    pub(crate) uy: [f32; TILE],
    /// Weighted mean cosine of the phases left over, from -1 to 1.
    pub(crate) coherence: [f32; TILE],
    /// Weighted root mean square of the component disparities left over, in pixels.
    pub(crate) residual_px: [f32; TILE],
}

/// Equation 3, with the inverse and the right-hand side that its print lost: the shift `u` that
/// minimises `sum_q w_q (k_q.u - phase_q)^2`, that is `u = M^-1 r` with `M = sum_q w_q k_q k_q^T`
/// and `r = sum_q w_q phase_q k_q`.
///
/// The printed `d d^T / |d|^2` is the same matrix `n n^T` where the component disparity is not
/// zero, and 0/0 where it is; here the direction comes from the filter. Robust rounds weigh each
/// orientation by `1 / (1 + (residual / 0.4 rad)^2)` again. `pull` is where the coarser scale would
/// have the vertical component go.
#[inline(always)]
pub(crate) fn robust_fit(
    phase: &[[f32; TILE]; MOST_ORIENTATIONS],
    weight: &[[f32; TILE]; MOST_ORIENTATIONS],
    waves: &[WaveVector],
    pull: &[f32; TILE],
    params: &MatchParams,
) -> Fit {
    let omega_squared = waves[0].x * waves[0].x + waves[0].y * waves[0].y;
    let mut ux = [0.0f32; TILE];
    let mut uy = [0.0f32; TILE];
    for round in 0..=params.robust_rounds {
        let last = round == params.robust_rounds && round > 0;
        let mut xx = [0.0f32; TILE];
        let mut xy = [0.0f32; TILE];
        let mut yy = [0.0f32; TILE];
        let mut rx = [0.0f32; TILE];
        let mut ry = [0.0f32; TILE];
        for (q, k) in waves.iter().enumerate() {
            let (phase, weight) = (&phase[q], &weight[q]);
            for i in 0..TILE {
                let robust = if round == 0 {
                    1.0
                } else {
                    let left_over = phase[i] - (k.x * ux[i] + k.y * uy[i]);
                    let ratio = left_over * (1.0 / CAUCHY_RAD);
                    let deaf = last && left_over.abs() > DEAF_RAD;
                    if deaf {
                        0.0
                    } else {
                        1.0 / (1.0 + ratio * ratio)
                    }
                };
                let w = weight[i] * robust;
                xx[i] += w * k.x * k.x;
                xy[i] += w * k.x * k.y;
                yy[i] += w * k.y * k.y;
                rx[i] += w * k.x * phase[i];
                ry[i] += w * k.y * phase[i];
            }
        }
        for i in 0..TILE {
            // Every wave vector has the same length, so the trace is the sum of weights times its
            // square.
            let trace = xx[i] + yy[i];
            let determinant = xx[i] * yy[i] - xy[i] * xy[i];
            let told = determinant > LEAST_DETERMINANT * trace * trace && trace > 0.0;
            let ridge = params.vertical_prior * trace;
            let (yy, ry) = (yy[i] + ridge, ry[i] + ridge * pull[i]);
            let determinant = xx[i] * yy - xy[i] * xy[i];
            // One division for both components; NaN where they cannot be told.
            let inverse = if told { 1.0 / determinant } else { f32::NAN };
            ux[i] = (yy * rx[i] - xy[i] * ry) * inverse;
            uy[i] = (xx[i] * ry - xy[i] * rx[i]) * inverse;
        }
    }
    let mut agreement = [0.0f32; TILE];
    let mut unexplained = [0.0f32; TILE];
    let mut total = [f32::MIN_POSITIVE; TILE];
    for (q, k) in waves.iter().enumerate() {
        let (phase, weight) = (&phase[q], &weight[q]);
        for i in 0..TILE {
            let left_over = phase[i] - (k.x * ux[i] + k.y * uy[i]);
            agreement[i] += weight[i] * cosine(left_over);
            unexplained[i] += weight[i] * left_over * left_over;
            total[i] += weight[i];
        }
    }
    let mut fit = Fit {
        ux,
        uy,
        coherence: agreement,
        residual_px: unexplained,
    };
    for i in 0..TILE {
        fit.coherence[i] /= total[i];
        fit.residual_px[i] = (fit.residual_px[i] / (total[i] * omega_squared)).sqrt();
    }
    fit
}

/// A cosine good to 2e-4 at every angle: wrapped, then its power series as far as the twelfth, so
/// that the loop over it becomes vector code.
#[inline(always)]
fn cosine(angle: f32) -> f32 {
    const SERIES: [f32; 7] = [
        1.0,
        -1.0 / 2.0,
        1.0 / 24.0,
        -1.0 / 720.0,
        1.0 / 40_320.0,
        -1.0 / 3_628_800.0,
        1.0 / 479_001_600.0,
    ];
    let angle = wrap(angle);
    let square = angle * angle;
    SERIES
        .iter()
        .rev()
        .fold(0.0, |sum, coefficient| sum * square + coefficient)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use v1_gabor::GaborParams;

    use super::*;

    fn fit(phases: &[f32; 8], params: &MatchParams) -> Fit {
        let mut phase = [[0.0; TILE]; MOST_ORIENTATIONS];
        let mut weight = [[0.0; TILE]; MOST_ORIENTATIONS];
        for q in 0..8 {
            phase[q] = [phases[q]; TILE];
            weight[q] = [1.0; TILE];
        }
        let waves = GaborParams::default().wave_vectors();
        robust_fit(&phase, &weight, &waves, &[0.0; TILE], params)
    }

    proptest! {
        /// Phases that come from one shift give that shift back, coherent and without residual.
        #[test]
        fn phases_of_a_shift_give_the_shift(ux in -0.9f32..0.9, uy in -0.9f32..0.9) {
            let waves = GaborParams::default().wave_vectors();
            let phases = std::array::from_fn(|q| waves[q].x * ux + waves[q].y * uy);
            let params = MatchParams { vertical_prior: 0.0, ..MatchParams::default() };
            let fit = fit(&phases, &params);
            prop_assert!((fit.ux[3] - ux).abs() < 1e-5 && (fit.uy[3] - uy).abs() < 1e-5);
            prop_assert!(fit.coherence[3] > 0.999 && fit.residual_px[3] < 1e-4);
        }

        /// One orientation that says something else moves a plain fit, and a robust one by less
        /// than half as far.
        #[test]
        fn one_liar_is_outvoted(ux in -0.3f32..0.3, liar in 0usize..8, lie in 1.5f32..2.5) {
            let waves = GaborParams::default().wave_vectors();
            let mut phases = std::array::from_fn(|q| waves[q].x * ux);
            phases[liar] += lie;
            let miss = |rounds| {
                let params = MatchParams {
                    vertical_prior: 0.0, robust_rounds: rounds, ..MatchParams::default()
                };
                let fit = fit(&phases, &params);
                (fit.ux[0] - ux).hypot(fit.uy[0])
            };
            prop_assert!(miss(2) < 0.5 * miss(0), "{} of {}", miss(2), miss(0));
        }
    }

    /// The cosine of the fit is the cosine, to what its comment says.
    #[test]
    fn the_cosine_is_the_cosine() {
        for step in -400..400 {
            let angle = step as f32 * 0.02;
            assert!((cosine(angle) - angle.cos()).abs() < 2e-4, "at {angle}");
        }
    }
}
