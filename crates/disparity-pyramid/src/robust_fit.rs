use pulp::Simd;
use v1_gabor::WaveVector;

use crate::MatchParams;
use crate::doubled::Doubled;
use crate::rough::Rough;
use crate::tile::{ByOrientation, TILE};

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
    /// The covariance `s^2 A M A` by its entries xx, xy and yy, in square pixels, if it is asked for:
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
    for start in (0..TILE).step_by(2 * S::F32_LANES) {
        fit_lanes(simd, (phase, weight), waves, pull, params, start, &mut fit);
    }
    fit
}

/// The same for the pixels from `start` on that two vectors hold.
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
    let splat = |value| Doubled::splat(simd, value);
    let (zero, one) = (splat(0.0), splat(1.0));
    let omega_squared = waves[0].x * waves[0].x + waves[0].y * waves[0].y;
    let pull = Doubled::load(simd, pull, start);
    let (mut ux, mut uy) = (zero, zero);
    let mut normal = Normal {
        squares: zero,
        xx: zero,
        xy: zero,
        yy: zero,
        rx: zero,
        ry: zero,
        ridge: zero,
    };
    for round in 0..=params.robust_rounds {
        let last = round == params.robust_rounds;
        let (mut xx, mut xy, mut yy) = (zero, zero, zero);
        let (mut rx, mut ry, mut squares) = (zero, zero, zero);
        for (q, k) in waves.iter().enumerate() {
            let (kx, ky) = (splat(k.x), splat(k.y));
            let phase = Doubled::load(simd, &phase[q], start);
            let mut w = Doubled::load(simd, &weight[q], start);
            if round > 0 {
                let left_over = left_over(simd, phase, (kx, ky), (ux, uy));
                let ratio = left_over.mul(simd, splat(1.0 / CAUCHY_RAD));
                let doubt = ratio.mul_add(simd, ratio, one);
                w = w.mul(simd, doubt.rough_reciprocal(simd));
                if last {
                    let heard = left_over.abs(simd).at_most(simd, splat(DEAF_RAD));
                    w = heard.select(simd, w, zero);
                }
            }
            let (wx, wy) = (w.mul(simd, kx), w.mul(simd, ky));
            xx = wx.mul_add(simd, kx, xx);
            xy = wx.mul_add(simd, ky, xy);
            yy = wy.mul_add(simd, ky, yy);
            rx = wx.mul_add(simd, phase, rx);
            ry = wy.mul_add(simd, phase, ry);
            if params.covariance && last {
                squares = w.mul_add(simd, phase.mul(simd, phase), squares);
            }
        }
        // Every wave vector has the same length, so the trace is the sum of weights times its
        // square.
        let trace = xx.add(simd, yy);
        normal = Normal {
            squares,
            xx,
            xy,
            yy,
            rx,
            ry,
            ridge: zero,
        };
        if params.rows_only {
            let least = trace.mul(simd, splat(LEAST_ALONG_ROWS));
            let told = least.less_than(simd, xx);
            ux = told.select(simd, rx.quotient(simd, xx), splat(f32::NAN));
            continue;
        }
        let least = trace.mul(simd, trace).mul(simd, splat(LEAST_DETERMINANT));
        let told = least.less_than(simd, determinant(simd, xx, xy, yy));
        let ridge = trace.mul(simd, splat(params.vertical_prior));
        normal.ridge = ridge;
        yy = yy.add(simd, ridge);
        ry = ridge.mul_add(simd, pull, ry);
        // One division for both components; NaN where they cannot be told.
        let inverse = one.quotient(simd, determinant(simd, xx, xy, yy));
        let inverse = told.select(simd, inverse, splat(f32::NAN));
        ux = determinant_of(simd, (rx, xy), (ry, yy)).mul(simd, inverse);
        uy = determinant_of(simd, (xx, rx), (xy, ry)).mul(simd, inverse);
    }
    let (mut agreement, mut unexplained, mut heard) = (zero, zero, zero);
    let mut total = splat(f32::MIN_POSITIVE);
    for (q, k) in waves.iter().enumerate() {
        let phase = Doubled::load(simd, &phase[q], start);
        let w = Doubled::load(simd, &weight[q], start);
        let left_over = left_over(simd, phase, (splat(k.x), splat(k.y)), (ux, uy));
        agreement = w.mul_add(simd, left_over.cosine(simd), agreement);
        unexplained = w.mul_add(simd, left_over.mul(simd, left_over), unexplained);
        total = total.add(simd, w);
        heard = heard.add(simd, zero.less_than(simd, w).select(simd, one, zero));
    }
    let explained = total.mul(simd, splat(omega_squared));
    let square = unexplained.mul(simd, explained.rough_reciprocal(simd));
    if params.covariance {
        let entries = covariance(simd, &normal, (ux, uy), heard, params.rows_only);
        for (entry, out) in entries.into_iter().zip(&mut fit.covariance) {
            entry.store(simd, out, start);
        }
    }
    ux.store(simd, &mut fit.ux, start);
    uy.store(simd, &mut fit.uy, start);
    let coherence = agreement.quotient(simd, total);
    coherence.store(simd, &mut fit.coherence, start);
    square.sqrt(simd).store(simd, &mut fit.residual_px, start);
    heard.store(simd, &mut fit.heard, start);
}

/// The normal equations of the last round: `sum w phase^2`, `M` and `r` of equation 3, and the weight of the
/// vertical prior beside them.
struct Normal<S: Simd> {
    squares: Doubled<S>,
    xx: Doubled<S>,
    xy: Doubled<S>,
    yy: Doubled<S>,
    rx: Doubled<S>,
    ry: Doubled<S>,
    ridge: Doubled<S>,
}

/// `s^2 A M A` by its entries xx, xy and yy, where `A = (M + P)^-1`, `P` being the vertical prior's weight on dy
/// alone, which is `A - A P A`: what a prior holds does not scatter. `s^2` is
/// `sum w (phase - k.u)^2 = sum w phase^2 - 2 r.u + u.M u` over the degrees of freedom.
#[inline(always)]
fn covariance<S: Rough>(
    simd: S,
    normal: &Normal<S>,
    (ux, uy): (Doubled<S>, Doubled<S>),
    heard: Doubled<S>,
    rows_only: bool,
) -> [Doubled<S>; 3] {
    let &Normal {
        squares,
        xx,
        xy,
        yy,
        rx,
        ry,
        ridge,
    } = normal;
    let along_x = xx.mul_add(simd, ux, xy.mul(simd, uy).sub(simd, rx.add(simd, rx)));
    let along_y = yy.mul_add(simd, uy, xy.mul(simd, ux).sub(simd, ry.add(simd, ry)));
    let left_over = along_x.mul_add(simd, ux, squares);
    let left_over = along_y.mul_add(simd, uy, left_over);
    // Rounding takes a perfect fit below zero.
    let zero = Doubled::splat(simd, 0.0);
    let left_over = left_over.max(simd, zero);
    if rows_only {
        let freedom = heard.sub(simd, Doubled::splat(simd, 1.0));
        return [left_over.quotient(simd, freedom.mul(simd, xx)), zero, zero];
    }
    let freedom = heard.sub(simd, Doubled::splat(simd, 2.0));
    let held = yy.add(simd, ridge);
    let determinant = determinant(simd, xx, xy, held);
    let scale = left_over.quotient(simd, freedom.mul(simd, determinant));
    let share = ridge.quotient(simd, determinant);
    let free = share.negate_mul_add(simd, xx, Doubled::splat(simd, 1.0));
    let along_x = share.mul(simd, xy).negate_mul_add(simd, xy, held);
    [
        scale.mul(simd, along_x),
        scale.mul(simd, xy.neg(simd)).mul(simd, free),
        scale.mul(simd, xx).mul(simd, free),
    ]
}

/// What a shift leaves of an orientation's phase.
#[inline(always)]
fn left_over<S: Rough>(
    simd: S,
    phase: Doubled<S>,
    (kx, ky): (Doubled<S>, Doubled<S>),
    (ux, uy): (Doubled<S>, Doubled<S>),
) -> Doubled<S> {
    ky.negate_mul_add(simd, uy, kx.negate_mul_add(simd, ux, phase))
}

/// That of a symmetric matrix.
#[inline(always)]
fn determinant<S: Rough>(simd: S, xx: Doubled<S>, xy: Doubled<S>, yy: Doubled<S>) -> Doubled<S> {
    determinant_of(simd, (xx, xy), (xy, yy))
}

/// That of the matrix with these rows.
#[inline(always)]
fn determinant_of<S: Rough>(
    simd: S,
    (a, b): (Doubled<S>, Doubled<S>),
    (c, d): (Doubled<S>, Doubled<S>),
) -> Doubled<S> {
    b.negate_mul_add(simd, c, a.mul(simd, d))
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
