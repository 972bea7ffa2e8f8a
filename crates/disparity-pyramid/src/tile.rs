use pulp::Simd;
use v1_gabor::WaveVector;
use v1_gabor::machine::Machine;

use crate::phase::{angle, wrap};
use crate::robust_fit::{Fit, robust_fit};
use crate::vector::{store, vector};
use crate::warp::{Place, Warp};
use crate::{MatchParams, Validity};

/// Pixels that one visit of the kernel treats together, side by side in vector registers.
pub(crate) const TILE: usize = 8;

/// Most orientations of a bank; what the tile's buffers hold.
pub(crate) const MOST_ORIENTATIONS: usize = 32;

/// One number for each orientation and pixel of a tile.
pub(crate) type ByOrientation = [[f32; TILE]; MOST_ORIENTATIONS];

/// A few neighbouring pixels of one row: everything the fit needs.
pub(crate) struct Tile {
    /// Phase of the left response over the warped right one, in `[-pi, pi]`.
    phase: ByOrientation,
    /// How much the fit hears of each; 0 where an eye's energy is below the threshold.
    weight: ByOrientation,
    in_view: [bool; TILE],
}

/// What both eyes say at one pixel, for [`TILE`] orientations.
#[derive(Clone, Copy)]
struct Pixel {
    phase: [f32; TILE],
    weight: [f32; TILE],
}

const SILENT: Pixel = Pixel {
    phase: [0.0; TILE],
    weight: [0.0; TILE],
};

impl Tile {
    pub(crate) const fn new() -> Self {
        Self {
            phase: [[0.0; TILE]; MOST_ORIENTATIONS],
            weight: [[0.0; TILE]; MOST_ORIENTATIONS],
            in_view: [false; TILE],
        }
    }

    /// Reads both eyes' responses for each pixel: the left eye's in place, `left` holding them from
    /// the tile's first pixel `(x, y)` on, the right eye's at the present shifts.
    ///
    /// `ORIENTATIONS` is their number, or 0 for any.
    #[inline(always)]
    pub(crate) fn read<const ORIENTATIONS: usize, S: Simd + Machine<TILE>>(
        &mut self,
        simd: S,
        (left, warp): (&[f32], &Warp<'_>),
        orientations: usize,
        (x, y): (usize, usize),
        (dx, dy): (&[f32], &[f32]),
        threshold: f32,
    ) {
        let orientations = match ORIENTATIONS {
            0 => orientations,
            known => known,
        };
        let parts = 2 * orientations;
        let mut places = [None; TILE];
        for i in 0..dx.len().min(TILE) {
            places[i] = warp.place((x + i) as f32 + dx[i], y as f32 + dy[i]);
        }
        for group in (0..orientations).step_by(TILE) {
            let mut pixels = [SILENT; TILE];
            for i in 0..TILE {
                if let Some(place) = places[i] {
                    let left = &left[i * parts..][..parts];
                    let pixel = &mut pixels[i];
                    read_pixel::<ORIENTATIONS, S>(
                        simd,
                        left,
                        warp,
                        (orientations, group),
                        place,
                        threshold,
                        pixel,
                    );
                }
            }
            let mut phases = [simd.load(&pixels[0].phase); TILE];
            let mut weights = [simd.load(&pixels[0].weight); TILE];
            for i in 1..TILE {
                phases[i] = simd.load(&pixels[i].phase);
                weights[i] = simd.load(&pixels[i].weight);
            }
            let (phases, weights) = (simd.turn(phases), simd.turn(weights));
            for q in 0..TILE {
                self.phase[group + q] = simd.store(phases[q]);
                self.weight[group + q] = simd.store(weights[q]);
            }
        }
        for i in 0..TILE {
            self.in_view[i] = places[i].is_some();
        }
    }

    /// The remaining shift of each pixel: equation 3. `parent_dy` is the coarser scale's vertical
    /// shift, toward which the prior pulls.
    #[inline(always)]
    pub(crate) fn fit<S: Simd>(
        &self,
        simd: S,
        waves: &[WaveVector],
        parent_dy: &[f32],
        dy: &[f32],
        params: &MatchParams,
    ) -> Fit {
        let mut pull = [0.0f32; TILE];
        for (pull, (parent, dy)) in pull.iter_mut().zip(parent_dy.iter().zip(dy)) {
            *pull = parent - dy;
        }
        robust_fit(simd, (&self.phase, &self.weight), waves, &pull, params)
    }

    /// Whether the fit at a pixel is an answer.
    #[inline(always)]
    pub(crate) fn verdict(
        &self,
        i: usize,
        fit: &Fit,
        params: &MatchParams,
        (x, y): (usize, usize),
        (dx, dy): (f32, f32),
        warp: &Warp<'_>,
    ) -> Validity {
        // A residual of half the carrier's period or more is another period's.
        const MOST_STEP_PX: f32 = std::f32::consts::PI;
        if !self.in_view[i] {
            return Validity::OutOfView;
        }
        if fit.heard[i] < 3.0 {
            return Validity::NoEnergy;
        }
        let step_squared = fit.ux[i] * fit.ux[i] + fit.uy[i] * fit.uy[i];
        // Written so that a fit without a solution, NaN, is refused.
        let agreed =
            fit.coherence[i] > params.least_coherence && step_squared < MOST_STEP_PX * MOST_STEP_PX;
        if !agreed {
            return Validity::Incoherent;
        }
        let (x, y) = (x as f32 + dx + fit.ux[i], y as f32 + dy + fit.uy[i]);
        if warp.place(x, y).is_none() {
            return Validity::OutOfView;
        }
        Validity::Valid
    }
}

/// The phases and weights of the orientations from `group` on at one pixel.
///
/// The phase is the numerator of equation 2: that of the left response over the warped right one,
/// which [`Warp`] leaves turned back by `k.beyond`. A product wraps by itself, so no two responses'
/// angles are ever subtracted. The weight is the balance of the amplitudes,
/// `|L R| / ((|L|^2 + |R|^2) / 2)`: one where both eyes see the same contrast, small where one of
/// them sees something else.
#[inline(always)]
fn read_pixel<const ORIENTATIONS: usize, S: Simd>(
    simd: S,
    left: &[f32],
    warp: &Warp<'_>,
    (orientations, group): (usize, usize),
    place: Place,
    threshold: f32,
    pixel: &mut Pixel,
) {
    let around = warp.around(place, 2 * orientations);
    let threshold = simd.splat_f32s(threshold);
    for lane in (0..TILE).step_by(S::F32_LANES) {
        let q = group + lane;
        let load = Load::<ORIENTATIONS> { orientations, q };
        let (le, lo) = load.parts(simd, left);
        let parts = [
            load.parts(simd, around[0]),
            load.parts(simd, around[1]),
            load.parts(simd, around[2]),
            load.parts(simd, around[3]),
        ];
        let (re, ro) = warp.read(simd, place, q, parts);
        let even = simd.mul_add_e_f32s(le, re, simd.mul_f32s(lo, ro));
        let odd = simd.sub_f32s(simd.mul_f32s(lo, re), simd.mul_f32s(le, ro));
        let turned = simd.sub_f32s(angle(simd, odd, even), warp.turn(simd, place, q));
        let left = simd.mul_add_e_f32s(le, le, simd.mul_f32s(lo, lo));
        let right = simd.mul_add_e_f32s(re, re, simd.mul_f32s(ro, ro));
        let mean = simd.mul_f32s(simd.splat_f32s(0.5), simd.add_f32s(left, right));
        let balance = simd.div_f32s(simd.sqrt_f32s(simd.mul_f32s(left, right)), mean);
        let heard = simd.less_than_f32s(threshold, simd.min_f32s(left, right));
        let weight = simd.select_f32s(heard, balance, simd.splat_f32s(0.0));
        store(simd, &mut pixel.phase, lane, wrap(simd, turned));
        store(simd, &mut pixel.weight, lane, weight);
    }
}

/// Takes a pixel's samples to the parts of the orientations from `q` on that a vector holds; zeros
/// beyond the last.
#[derive(Clone, Copy)]
struct Load<const ORIENTATIONS: usize> {
    orientations: usize,
    q: usize,
}

impl<const ORIENTATIONS: usize> Load<ORIENTATIONS> {
    #[inline(always)]
    fn parts<S: Simd>(self, simd: S, pixel: &[f32]) -> (S::f32s, S::f32s) {
        let Self { orientations, q } = self;
        // Whole vectors, if the number is known to be a multiple of them.
        if ORIENTATIONS != 0 && ORIENTATIONS.is_multiple_of(TILE) {
            let (even, odd) = (q, ORIENTATIONS + q);
            return (vector(simd, pixel, even), vector(simd, pixel, odd));
        }
        let (even, odd) = pixel.split_at(orientations);
        let some = |parts: &[f32]| {
            let end = (q + S::F32_LANES).min(parts.len());
            simd.partial_load_f32s(&parts[q.min(end)..end])
        };
        (some(even), some(odd))
    }
}
