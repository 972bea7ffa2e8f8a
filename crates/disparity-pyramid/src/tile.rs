use v1_gabor::WaveVector;

use crate::phase::{angle, wrap};
use crate::refine::Eyes;
use crate::robust_fit::{Fit, robust_fit};
use crate::warp::{Place, Warp, lanes};
use crate::{MatchParams, Validity};

/// Pixels that one visit of the kernel treats together, side by side in vector registers.
pub(crate) const TILE: usize = 16;

/// Most orientations of a bank; what the tile's buffers hold.
pub(crate) const MOST_ORIENTATIONS: usize = 32;

/// A few neighbouring pixels of one row: everything the fit needs, by orientation and pixel.
pub(crate) struct Tile {
    /// Phase of the left response over the warped right one, in `[-pi, pi]`.
    phase: [[f32; TILE]; MOST_ORIENTATIONS],
    /// How much the fit hears of each; 0 where an eye's energy is below the threshold.
    weight: [[f32; TILE]; MOST_ORIENTATIONS],
    in_view: [bool; TILE],
    heard: [u8; TILE],
}

impl Tile {
    pub(crate) const fn new() -> Self {
        Self {
            phase: [[0.0; TILE]; MOST_ORIENTATIONS],
            weight: [[0.0; TILE]; MOST_ORIENTATIONS],
            in_view: [false; TILE],
            heard: [0; TILE],
        }
    }

    /// Reads both eyes' responses for each pixel from `start` on: the left eye's in place, the
    /// right eye's at the present shifts.
    #[inline(always)]
    pub(crate) fn read<const LANES: usize>(
        &mut self,
        eyes: &Eyes<'_>,
        warp: &Warp<'_>,
        (start, y): (usize, usize),
        (dx, dy): (&[f32], &[f32]),
        threshold: f32,
    ) {
        for i in 0..TILE {
            let place = dx
                .get(i)
                .and_then(|dx| warp.place((start + i) as f32 + dx, y as f32 + dy[i]));
            self.in_view[i] = place.is_some();
            if let Some(place) = place {
                self.read_pixel::<LANES>(i, eyes, warp, (start + i, y), place, threshold);
            } else {
                self.heard[i] = 0;
                for q in 0..eyes.waves.len() {
                    self.phase[q][i] = 0.0;
                    self.weight[q][i] = 0.0;
                }
            }
        }
    }

    /// The phases and weights of all orientations at one pixel.
    ///
    /// The phase is the numerator of equation 2: that of the left response over the warped right
    /// one, which [`Warp`] leaves turned back by `k.beyond`. A product wraps by itself, so no two
    /// responses' angles are ever subtracted. The weight is the balance of the amplitudes,
    /// `|L R| / ((|L|^2 + |R|^2) / 2)`: one where both eyes see the same contrast, small where one
    /// of them sees something else.
    #[inline(always)]
    fn read_pixel<const LANES: usize>(
        &mut self,
        i: usize,
        eyes: &Eyes<'_>,
        warp: &Warp<'_>,
        (x, y): (usize, usize),
        place: Place,
        threshold: f32,
    ) {
        let left = eyes.left.pixel(x, y);
        let (le, lo) = (lanes::<LANES>(left.even), lanes::<LANES>(left.odd));
        let (re, ro) = warp.read::<LANES>(place);
        let turn = warp.turn::<LANES>(place);
        let mut phase = [0.0f32; LANES];
        let mut weight = [0.0f32; LANES];
        for q in 0..LANES {
            let (even, odd) = (le[q] * re[q] + lo[q] * ro[q], lo[q] * re[q] - le[q] * ro[q]);
            phase[q] = wrap(angle(odd, even) - turn[q]);
            let left = le[q] * le[q] + lo[q] * lo[q];
            let right = re[q] * re[q] + ro[q] * ro[q];
            let balance = (even * even + odd * odd).sqrt() / (0.5 * (left + right));
            weight[q] = if left.min(right) > threshold {
                balance
            } else {
                0.0
            };
        }
        let mut heard = 0;
        for q in 0..LANES {
            self.phase[q][i] = phase[q];
            self.weight[q][i] = weight[q];
            heard += u8::from(weight[q] > 0.0);
        }
        self.heard[i] = heard;
    }

    /// The remaining shift of each pixel: equation 3. `parent_dy` is the coarser scale's vertical
    /// shift, toward which the prior pulls.
    #[inline(always)]
    pub(crate) fn fit(
        &self,
        waves: &[WaveVector],
        parent_dy: &[f32],
        dy: &[f32],
        params: &MatchParams,
    ) -> Fit {
        let mut pull = [0.0f32; TILE];
        for (pull, (parent, dy)) in pull.iter_mut().zip(parent_dy.iter().zip(dy)) {
            *pull = parent - dy;
        }
        robust_fit(&self.phase, &self.weight, waves, &pull, params)
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
        if self.heard[i] < 3 {
            return Validity::NoEnergy;
        }
        let step = (fit.ux[i] * fit.ux[i] + fit.uy[i] * fit.uy[i]).sqrt();
        // Written so that a fit without a solution, NaN, is refused.
        let agreed = fit.coherence[i] > params.least_coherence && step < MOST_STEP_PX;
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
