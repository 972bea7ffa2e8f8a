use pulp::Simd;
use v1_gabor::WaveVector;

use crate::MatchParams;
use crate::phase::cosine;
use crate::rough::Rough;
use crate::tile::{ByOrientation, TILE};
use crate::vector::{store, vector};

/// Residual phase at which an orientation's weight has fallen to half, in radians.
const CAUCHY_RAD: f32 = 0.4;

/// Residual phase beyond which the last round does not hear an orientation, in radians.
const DEAF_RAD: f32 = 1.5;

/// Least determinant of the normal equations relative to the square of their trace; below it the
/// orientations heard lie too close together to tell both components.
const LEAST_DETERMINANT: f32 = 1e-3;

/// The part of the weights' trace that must lie along the rows where these are all there is; below
/// it every orientation heard is nearly horizontal bars.
const LEAST_ALONG_ROWS: f32 = 1e-2;

/// The shift fitted to the phases of all orientations, for each pixel of a tile.
#[derive(Default)]
#[repr(align(64))]
pub(crate) struct Fit {
    /// Shift along x in pixels; NaN if the orientations heard do not tell both components.
    pub(crate) ux: [f32; TILE],
    /// Shift along y in pixels; NaN likewise.
    pub(crate) uy: [f32; TILE],
    /// Weighted mean cosine of the phases left over, from -1 to 1.
    pub(crate) coherence: [f32; TILE],
    /// Weighted root mean square of the component disparities left over, in pixels.
    pub(crate) residual_px: [f32; TILE],
    /// How many orientations were heard.
    pub(crate) heard: [f32; TILE],
    /// The covariance `s^2 M^-1` by its entries xx, xy and yy, in square pixels, if it is asked for:
    /// `s^2` is the weighted sum of the squared phases left over, over the number of orientations
    /// heard less that of unknowns.
    pub(crate) covariance: [[f32; TILE]; 3],
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
pub(crate) fn robust_fit<S: Rough>(
    simd: S,
    (phase, weight): (&ByOrientation, &ByOrientation),
    waves: &[WaveVector],
    pull: &[f32; TILE],
    params: &MatchParams,
) -> Fit {
    let mut fit = Fit::default();
    for start in (0..TILE).step_by(S::F32_LANES) {
        fit_lanes(simd, (phase, weight), waves, pull, params, start, &mut fit);
    }
    fit
}

/// The same for the pixels from `start` on that a vector holds.
#[inline(always)]
fn fit_lanes<S: Rough>(
    simd: S,
    (phase, weight): (&ByOrientation, &ByOrientation),
    waves: &[WaveVector],
    pull: &[f32; TILE],
    params: &MatchParams,
    start: usize,
    fit: &mut Fit,
) {
    let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
    let omega_squared = waves[0].x * waves[0].x + waves[0].y * waves[0].y;
    let pull = vector(simd, pull, start);
    let (mut ux, mut uy) = (zero, zero);
    let mut normal = Normal::<S> {
        squares: zero,
        xx: zero,
        xy: zero,
        yy: zero,
        rx: zero,
        ry: zero,
    };
    for round in 0..=params.robust_rounds {
        let last = round == params.robust_rounds;
        let (mut xx, mut xy, mut yy) = (zero, zero, zero);
        let (mut rx, mut ry, mut squares) = (zero, zero, zero);
        for (q, k) in waves.iter().enumerate() {
            let (kx, ky) = (simd.splat_f32s(k.x), simd.splat_f32s(k.y));
            let phase = vector(simd, &phase[q], start);
            let mut w = vector(simd, &weight[q], start);
            if round > 0 {
                let left_over = left_over(simd, phase, (kx, ky), (ux, uy));
                let ratio = simd.mul_f32s(left_over, simd.splat_f32s(1.0 / CAUCHY_RAD));
                let doubt = simd.mul_add_e_f32s(ratio, ratio, one);
                w = simd.mul_f32s(w, simd.rough_reciprocal(doubt));
                if last {
                    let size = simd.abs_f32s(left_over);
                    let heard = simd.less_than_or_equal_f32s(size, simd.splat_f32s(DEAF_RAD));
                    w = simd.select_f32s(heard, w, zero);
                }
            }
            let (wx, wy) = (simd.mul_f32s(w, kx), simd.mul_f32s(w, ky));
            xx = simd.mul_add_e_f32s(wx, kx, xx);
            xy = simd.mul_add_e_f32s(wx, ky, xy);
            yy = simd.mul_add_e_f32s(wy, ky, yy);
            rx = simd.mul_add_e_f32s(wx, phase, rx);
            ry = simd.mul_add_e_f32s(wy, phase, ry);
            if params.covariance && last {
                let square = simd.mul_f32s(phase, phase);
                squares = simd.mul_add_e_f32s(w, square, squares);
            }
        }
        // Every wave vector has the same length, so the trace is the sum of weights times its
        // square.
        let trace = simd.add_f32s(xx, yy);
        normal = Normal {
            squares,
            xx,
            xy,
            yy,
            rx,
            ry,
        };
        if params.rows_only {
            let least = simd.mul_f32s(trace, simd.splat_f32s(LEAST_ALONG_ROWS));
            let told = simd.less_than_f32s(least, xx);
            ux = simd.select_f32s(told, simd.div_f32s(rx, xx), simd.splat_f32s(f32::NAN));
            continue;
        }
        let least = simd.mul_f32s(
            simd.splat_f32s(LEAST_DETERMINANT),
            simd.mul_f32s(trace, trace),
        );
        let plain = determinant(simd, xx, xy, yy);
        let told = simd.less_than_f32s(least, plain);
        let ridge = simd.mul_f32s(simd.splat_f32s(params.vertical_prior), trace);
        yy = simd.add_f32s(yy, ridge);
        ry = simd.mul_add_e_f32s(ridge, pull, ry);
        // One division for both components; NaN where they cannot be told.
        let inverse = simd.quotient(one, determinant(simd, xx, xy, yy));
        let inverse = simd.select_f32s(told, inverse, simd.splat_f32s(f32::NAN));
        ux = simd.mul_f32s(determinant_of(simd, (rx, xy), (ry, yy)), inverse);
        uy = simd.mul_f32s(determinant_of(simd, (xx, rx), (xy, ry)), inverse);
    }
    let (mut agreement, mut unexplained, mut heard) = (zero, zero, zero);
    let mut total = simd.splat_f32s(f32::MIN_POSITIVE);
    for (q, k) in waves.iter().enumerate() {
        let (kx, ky) = (simd.splat_f32s(k.x), simd.splat_f32s(k.y));
        let phase = vector(simd, &phase[q], start);
        let w = vector(simd, &weight[q], start);
        let left_over = left_over(simd, phase, (kx, ky), (ux, uy));
        agreement = simd.mul_add_e_f32s(w, cosine(simd, left_over), agreement);
        let square = simd.mul_f32s(left_over, left_over);
        unexplained = simd.mul_add_e_f32s(w, square, unexplained);
        total = simd.add_f32s(total, w);
        let counts = simd.select_f32s(simd.less_than_f32s(zero, w), one, zero);
        heard = simd.add_f32s(heard, counts);
    }
    let explained = simd.mul_f32s(total, simd.splat_f32s(omega_squared));
    let square = simd.mul_f32s(unexplained, simd.rough_reciprocal(explained));
    let residual_px = simd.sqrt_f32s(square);
    if params.covariance {
        let entries = covariance(simd, &normal, (ux, uy), heard, params.rows_only);
        for i in 0..3 {
            store(simd, &mut fit.covariance[i], start, entries[i]);
        }
    }
    store(simd, &mut fit.ux, start, ux);
    store(simd, &mut fit.uy, start, uy);
    store(
        simd,
        &mut fit.coherence,
        start,
        simd.quotient(agreement, total),
    );
    store(simd, &mut fit.residual_px, start, residual_px);
    store(simd, &mut fit.heard, start, heard);
}

/// The normal equations of the last round: `sum w phase^2`, and `M` and `r` of equation 3.
struct Normal<S: Simd> {
    squares: S::f32s,
    xx: S::f32s,
    xy: S::f32s,
    yy: S::f32s,
    rx: S::f32s,
    ry: S::f32s,
}

/// `s^2 M^-1` by its entries xx, xy and yy, where `s^2` is
/// `sum w (phase - k.u)^2 = sum w phase^2 - 2 r.u + u.M u` over the degrees of freedom.
#[inline(always)]
fn covariance<S: Simd>(
    simd: S,
    normal: &Normal<S>,
    (ux, uy): (S::f32s, S::f32s),
    heard: S::f32s,
    rows_only: bool,
) -> [S::f32s; 3] {
    let &Normal {
        squares,
        xx,
        xy,
        yy,
        rx,
        ry,
    } = normal;
    let twice = |r| simd.add_f32s(r, r);
    let along_x = simd.mul_add_e_f32s(xx, ux, simd.sub_f32s(simd.mul_f32s(xy, uy), twice(rx)));
    let along_y = simd.mul_add_e_f32s(yy, uy, simd.sub_f32s(simd.mul_f32s(xy, ux), twice(ry)));
    let left_over = simd.mul_add_e_f32s(along_x, ux, squares);
    let left_over = simd.mul_add_e_f32s(along_y, uy, left_over);
    // Rounding takes a perfect fit below zero.
    let zero = simd.splat_f32s(0.0);
    let left_over = simd.max_f32s(left_over, zero);
    if rows_only {
        let freedom = simd.sub_f32s(heard, simd.splat_f32s(1.0));
        let variance = simd.div_f32s(left_over, simd.mul_f32s(freedom, xx));
        return [variance, zero, zero];
    }
    let freedom = simd.sub_f32s(heard, simd.splat_f32s(2.0));
    let scale = simd.mul_f32s(freedom, determinant(simd, xx, xy, yy));
    let scale = simd.div_f32s(left_over, scale);
    [yy, simd.neg_f32s(xy), xx].map(|entry| simd.mul_f32s(scale, entry))
}

/// What a shift leaves of an orientation's phase.
#[inline(always)]
fn left_over<S: Simd>(
    simd: S,
    phase: S::f32s,
    (kx, ky): (S::f32s, S::f32s),
    (ux, uy): (S::f32s, S::f32s),
) -> S::f32s {
    let explained = simd.mul_add_e_f32s(kx, ux, simd.mul_f32s(ky, uy));
    simd.sub_f32s(phase, explained)
}

/// That of a symmetric matrix.
#[inline(always)]
fn determinant<S: Simd>(simd: S, xx: S::f32s, xy: S::f32s, yy: S::f32s) -> S::f32s {
    determinant_of(simd, (xx, xy), (xy, yy))
}

/// That of the matrix with these rows.
#[inline(always)]
fn determinant_of<S: Simd>(
    simd: S,
    (a, b): (S::f32s, S::f32s),
    (c, d): (S::f32s, S::f32s),
) -> S::f32s {
    simd.sub_f32s(simd.mul_f32s(a, d), simd.mul_f32s(b, c))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use v1_gabor::GaborParams;

    use super::*;
    use crate::tile::MOST_ORIENTATIONS;

    fn fit(phases: &[f32; 8], params: &MatchParams) -> Fit {
        let mut phase: ByOrientation = [[0.0; TILE]; MOST_ORIENTATIONS];
        let mut weight: ByOrientation = [[0.0; TILE]; MOST_ORIENTATIONS];
        for q in 0..8 {
            phase[q] = [phases[q]; TILE];
            weight[q] = [1.0; TILE];
        }
        let waves = GaborParams::default().wave_vectors();
        let planes = (&phase, &weight);
        robust_fit(pulp::Scalar, planes, &waves, &[0.0; TILE], params)
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
}
