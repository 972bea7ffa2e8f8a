use pulp::Simd;
use v1_gabor::machine::Machine;
use v1_gabor::{Size, WaveVector};

use crate::phase::{angle, wrap};
use crate::robust_fit::{Fit, robust_fit};
use crate::rough::Rough;
use crate::slopes::TileSlopes;
use crate::vector::{store, vector};
use crate::warp::{Place, Warp};
use crate::{MatchParams, Validity};

/// Pixels that one visit of the kernel treats together, side by side in vector registers.
pub(crate) const TILE: usize = 32;

/// Pixels and orientations of the square that is turned from one beside the other to the other way
/// round.
const SQUARE: usize = 8;

/// Most orientations of a bank; what the tile's buffers hold.
pub(crate) const MOST_ORIENTATIONS: usize = 32;

/// One number for each orientation and pixel of a tile.
pub(crate) type ByOrientation = [[f32; TILE]; MOST_ORIENTATIONS];

/// A few neighbouring pixels of one row: everything the fit needs.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Tile {
    /// Phase of the left response over the warped right one, in `[-pi, pi]`.
    pub(crate) phase: ByOrientation,
    /// How much the fit hears of each; 0 where an eye's energy is below the threshold.
    pub(crate) weight: ByOrientation,
    pub(crate) in_view: [bool; TILE],
}

/// Where the pixels of a tile are in the left image: the first of them, and how far each is from the
/// next along the row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Along {
    pub(crate) x: usize,
    pub(crate) y: usize,
    pub(crate) step: usize,
}

impl Along {
    /// The column of the pixel of this number.
    #[inline(always)]
    pub(crate) fn column(self, i: usize) -> f32 {
        (self.x + i * self.step) as f32
    }
}

/// The shifts of a tile's pixels, by component.
pub(crate) type TileShifts<'a> = (&'a [f32; TILE], &'a [f32; TILE]);

/// A way to read both eyes' responses for the pixels of a tile, in vectors of one kind.
pub(crate) trait Reader: Copy {
    /// The vectors, which the fit works in too.
    type Simd: Rough;

    fn simd(self) -> Self::Simd;

    /// Reads both eyes' responses for each pixel: the left eye's in place, `left` holding them from
    /// the tile's first pixel on, the right eye's at the present shifts, by filters that are stretched by
    /// the slopes.
    fn read(
        self,
        tile: &mut Tile,
        eyes: (&[f32], &Warp<'_>),
        at: Along,
        shifts: (TileShifts<'_>, Option<&TileSlopes>),
        threshold: f32,
    );
}

/// Reads one pixel after the other, its orientations side by side, for any number of them.
///
/// `ORIENTATIONS` is their number, or 0 for that which the second field has.
#[derive(Clone, Copy)]
pub(crate) struct ByPixel<const ORIENTATIONS: usize, S>(pub(crate) S, pub(crate) usize);

/// What both eyes say at one pixel, for [`SQUARE`] orientations.
#[derive(Clone, Copy)]
struct Pixel {
    phase: [f32; SQUARE],
    weight: [f32; SQUARE],
}

const SILENT: Pixel = Pixel {
    phase: [0.0; SQUARE],
    weight: [0.0; SQUARE],
};

impl Tile {
    pub(crate) const fn new() -> Self {
        Self {
            phase: [[0.0; TILE]; MOST_ORIENTATIONS],
            weight: [[0.0; TILE]; MOST_ORIENTATIONS],
            in_view: [false; TILE],
        }
    }

    /// The remaining shift of each pixel: equation 3. `parent_dy` is the coarser scale's vertical
    /// shift, toward which the prior pulls.
    #[inline(always)]
    pub(crate) fn fit<S: Rough>(
        &self,
        simd: S,
        waves: &[WaveVector],
        (parent_dy, dy): (&[f32; TILE], &[f32; TILE]),
        params: &MatchParams,
    ) -> Fit {
        let mut pull = [0.0f32; TILE];
        for i in 0..TILE {
            pull[i] = parent_dy[i] - dy[i];
        }
        robust_fit(simd, (&self.phase, &self.weight), waves, &pull, params)
    }

    /// Whether the fit at each pixel is an answer. Without a branch,
    /// so that all are judged at once.
    #[inline(always)]
    pub(crate) fn verdicts(
        &self,
        fit: &Fit,
        params: &MatchParams,
        at: Along,
        (dx, dy): (&[f32; TILE], &[f32; TILE]),
        size: Size,
    ) -> [Validity; TILE] {
        // A residual of half the carrier's period or more is another period's.
        const MOST_STEP_PX: f32 = std::f32::consts::PI;
        let (most_x, most_y) = ((size.width - 1) as f32, (size.height - 1) as f32);
        let mut verdicts = [Validity::Valid; TILE];
        for i in 0..TILE {
            let (ux, uy) = (fit.ux[i], fit.uy[i]);
            let (u, v) = (at.column(i) + dx[i] + ux, at.y as f32 + dy[i] + uy);
            let seen = (u >= 0.0) & (u <= most_x) & (v >= 0.0) & (v <= most_y);
            // Written so that a fit without a solution, NaN, is refused.
            let agreed = (fit.coherence[i] > params.least_coherence)
                & (ux * ux + uy * uy < MOST_STEP_PX * MOST_STEP_PX);
            let mut verdict = if seen {
                Validity::Valid
            } else {
                Validity::OutOfView
            };
            verdict = if agreed {
                verdict
            } else {
                Validity::Incoherent
            };
            let heard = fit.heard[i] >= LEAST_HEARD;
            verdict = if heard { verdict } else { Validity::NoEnergy };
            verdicts[i] = if self.in_view[i] {
                verdict
            } else {
                Validity::OutOfView
            };
        }
        verdicts
    }
}

/// Fewer orientations tell too little of two components.
const LEAST_HEARD: f32 = 3.0;

/// The shifts of a whole tile; NaN, which is nowhere, beyond the end of a row.
#[inline(always)]
pub(crate) fn whole(shifts: &[f32]) -> [f32; TILE] {
    shifts.try_into().unwrap_or_else(|_| {
        let mut whole = [f32::NAN; TILE];
        whole[..shifts.len()].copy_from_slice(shifts);
        whole
    })
}

impl<const ORIENTATIONS: usize, S: Rough + Machine<SQUARE>> Reader for ByPixel<ORIENTATIONS, S> {
    type Simd = S;

    #[inline(always)]
    fn simd(self) -> S {
        self.0
    }

    #[inline(always)]
    fn read(
        self,
        tile: &mut Tile,
        (left, warp): (&[f32], &Warp<'_>),
        at: Along,
        ((dx, dy), slopes): (TileShifts<'_>, Option<&TileSlopes>),
        threshold: f32,
    ) {
        let Self(simd, orientations) = self;
        let orientations = match ORIENTATIONS {
            0 => orientations,
            known => known,
        };
        let parts = 2 * orientations;
        let mut places = [None; TILE];
        for i in 0..TILE {
            places[i] = warp.place(at.column(i) + dx[i], at.y as f32 + dy[i]);
        }
        for first in (0..TILE).step_by(SQUARE) {
            for group in (0..orientations).step_by(SQUARE) {
                let mut pixels = [SILENT; SQUARE];
                for i in 0..SQUARE {
                    if let Some(place) = places[first + i] {
                        let left = &left[(first + i) * at.step * parts..][..parts];
                        let pixel = &mut pixels[i];
                        let slope = slopes.map(|slopes| slopes.0.map(|slope| slope[first + i]));
                        read_pixel::<ORIENTATIONS, S>(
                            simd,
                            left,
                            warp,
                            (orientations, group),
                            (place, slope),
                            threshold,
                            pixel,
                        );
                    }
                }
                let mut phases = [simd.load(&pixels[0].phase); SQUARE];
                let mut weights = [simd.load(&pixels[0].weight); SQUARE];
                for i in 1..SQUARE {
                    phases[i] = simd.load(&pixels[i].phase);
                    weights[i] = simd.load(&pixels[i].weight);
                }
                let (phases, weights) = (simd.turn(phases), simd.turn(weights));
                for q in 0..SQUARE {
                    *square_of(&mut tile.phase[group + q], first) = simd.store(phases[q]);
                    *square_of(&mut tile.weight[group + q], first) = simd.store(weights[q]);
                }
            }
        }
        for i in 0..TILE {
            tile.in_view[i] = places[i].is_some();
        }
    }
}

/// The numbers of the pixels of a square.
#[inline(always)]
fn square_of(pixels: &mut [f32; TILE], first: usize) -> &mut [f32; SQUARE] {
    pixels[first..]
        .first_chunk_mut()
        .expect("a tile is whole squares")
}

/// The phases and weights of the orientations from `group` on at one pixel.
#[inline(always)]
fn read_pixel<const ORIENTATIONS: usize, S: Rough>(
    simd: S,
    left: &[f32],
    warp: &Warp<'_>,
    (orientations, group): (usize, usize),
    (place, slope): (Place, Option<[f32; 4]>),
    threshold: f32,
    pixel: &mut Pixel,
) {
    let around = warp.around(place, 2 * orientations);
    let threshold = simd.splat_f32s(threshold);
    for lane in (0..SQUARE).step_by(S::F32_LANES) {
        let q = group + lane;
        let load = Load::<ORIENTATIONS> { orientations, q };
        let (le, lo) = load.parts(simd, left);
        let parts = [
            load.parts(simd, around[0]),
            load.parts(simd, around[1]),
            load.parts(simd, around[2]),
            load.parts(simd, around[3]),
        ];
        let (re, ro) = match slope {
            None => warp.read(simd, place, q, parts),
            Some(slope) => warp.read_stretched(simd, place, q, parts, slope),
        };
        let turn = warp.turn(simd, place, q);
        let products = Products::new(simd, (le, lo), (re, ro));
        let (phase, weight) = products.phase_and_weight(simd, turn, threshold);
        store(simd, &mut pixel.phase, lane, phase);
        store(simd, &mut pixel.weight, lane, weight);
    }
}

/// What the responses of two eyes say to each other, for the orientations and pixels of a vector.
#[derive(Clone, Copy)]
pub(crate) struct Products<S: Simd> {
    /// The left response times the conjugate right one, by its parts.
    even: S::f32s,
    odd: S::f32s,
    /// The energies.
    left: S::f32s,
    right: S::f32s,
}

impl<S: Rough> Products<S> {
    /// Of the even and odd parts of either eye.
    #[inline(always)]
    pub(crate) fn new(simd: S, (le, lo): (S::f32s, S::f32s), (re, ro): (S::f32s, S::f32s)) -> Self {
        Self {
            even: simd.mul_add_e_f32s(le, re, simd.mul_f32s(lo, ro)),
            odd: simd.negate_mul_add_e_f32s(le, ro, simd.mul_f32s(lo, re)),
            left: simd.mul_add_e_f32s(le, le, simd.mul_f32s(lo, lo)),
            right: simd.mul_add_e_f32s(re, re, simd.mul_f32s(ro, ro)),
        }
    }

    /// The phase of the left response over the right one, which is turned back by `turn`, and its
    /// weight; 0 where an eye's energy is below the threshold.
    ///
    /// The phase is the numerator of equation 2. A product wraps by itself, so no two responses'
    /// angles are ever subtracted. The weight is the balance of the amplitudes,
    /// `|L R| / ((|L|^2 + |R|^2) / 2)`: one where both eyes see the same contrast, small where one of
    /// them sees something else.
    #[inline(always)]
    pub(crate) fn phase_and_weight(
        self,
        simd: S,
        turn: S::f32s,
        threshold: S::f32s,
    ) -> (S::f32s, S::f32s) {
        let turned = simd.sub_f32s(angle(simd, self.odd, self.even), turn);
        let mean = simd.mul_f32s(simd.splat_f32s(0.5), simd.add_f32s(self.left, self.right));
        let amplitudes = simd.rough_root(simd.mul_f32s(self.left, self.right));
        let balance = simd.mul_f32s(amplitudes, simd.rough_reciprocal(mean));
        let heard = simd.less_than_f32s(threshold, simd.min_f32s(self.left, self.right));
        let weight = simd.select_f32s(heard, balance, simd.splat_f32s(0.0));
        (wrap(simd, turned), weight)
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
        if ORIENTATIONS != 0 && ORIENTATIONS.is_multiple_of(SQUARE) {
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
