use ndarray::{Array2, Zip};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;
use v1_gabor::{Responses, WaveVector};

use crate::phase::{angle, wrap};
use crate::robust_fit::{Fit, robust_fit};
use crate::warp::Warp;
use crate::{MatchParams, Validity};

/// Pixels that one visit of the kernel treats together, side by side in vector registers.
pub(crate) const TILE: usize = 16;

/// Most orientations of a bank; what the tile's buffers hold.
pub(crate) const MOST_ORIENTATIONS: usize = 32;

/// Shifts of one scale, and what the last warp thought of each.
#[derive(Debug)]
pub(crate) struct Shifts {
    pub(crate) dx: Array2<f32>,
    pub(crate) dy: Array2<f32>,
    pub(crate) validity: Array2<Validity>,
    /// Root mean square of what the orientations leave unexplained, in pixels of this scale.
    pub(crate) residual: Array2<f32>,
}

/// The two eyes at one scale.
pub(crate) struct Eyes<'a> {
    pub(crate) left: &'a Responses,
    pub(crate) right: &'a Responses,
    pub(crate) waves: &'a [WaveVector],
}

/// One warp: reads the right responses at the present shifts, turns each orientation's phase
/// difference into a component disparity (equation 2), fits the remaining shift to all of them
/// (equation 3) and adds it (equation 4). Pixels without an answer keep their shift and get the
/// reason.
pub(crate) fn refine(
    eyes: &Eyes<'_>,
    shifts: &mut Shifts,
    parent_dy: &Array2<f32>,
    params: &MatchParams,
) {
    const CONTIGUOUS: &str = "planes are made in row-major order";
    let warp = Warp::new(eyes.right, eyes.waves);
    let width = shifts.dx.dim().1;
    let dx = shifts
        .dx
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width);
    let dy = shifts
        .dy
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width);
    let validity = shifts
        .validity
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width);
    let residual = shifts
        .residual
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width);
    let parent_dy = parent_dy.as_slice().expect(CONTIGUOUS).par_chunks(width);
    (dx, dy, validity, residual, parent_dy)
        .into_par_iter()
        .enumerate()
        .for_each_init(
            Tile::new,
            |tile, (y, (dx, dy, validity, residual, parent_dy))| {
                let (warp, eyes) = (&warp, eyes);
                Arch::new().dispatch(Row {
                    eyes,
                    warp,
                    params,
                    tile,
                    y,
                    dx,
                    dy,
                    validity,
                    residual,
                    parent_dy,
                });
            },
        );
}

/// One row's work, compiled once for each vector width and run at the machine's widest. Products
/// and sums stay separate at every width, so the bits do too.
struct Row<'a> {
    eyes: &'a Eyes<'a>,
    warp: &'a Warp<'a>,
    params: &'a MatchParams,
    tile: &'a mut Tile,
    y: usize,
    dx: &'a mut [f32],
    dy: &'a mut [f32],
    validity: &'a mut [Validity],
    residual: &'a mut [f32],
    parent_dy: &'a [f32],
}

impl NullaryFnOnce for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self {
            eyes,
            warp,
            params,
            tile,
            y,
            dx,
            dy,
            validity,
            residual,
            parent_dy,
        } = self;
        for start in (0..dx.len()).step_by(TILE) {
            let end = (start + TILE).min(dx.len());
            let (dx, dy) = (&mut dx[start..end], &mut dy[start..end]);
            tile.load(eyes, warp, (start, y), dx, dy, params.energy_threshold);
            tile.look(eyes.waves);
            let fit = tile.fit(eyes.waves, &parent_dy[start..end], dy, params);
            for i in 0..end - start {
                let verdict = tile.verdict(i, &fit, params, (start + i, y), (dx[i], dy[i]), warp);
                validity[start + i] = verdict;
                residual[start + i] = fit.residual_px[i];
                if verdict.is_valid() {
                    dx[i] += fit.ux[i];
                    dy[i] += fit.uy[i];
                }
            }
        }
    }
}

/// A few neighbouring pixels of one row: everything the fit needs, by orientation and pixel.
pub(crate) struct Tile {
    /// Left response times the conjugate of the warped right one; later its phase.
    product_even: [[f32; TILE]; MOST_ORIENTATIONS],
    product_odd: [[f32; TILE]; MOST_ORIENTATIONS],
    /// Mean of the two eyes' energies; zero where one of them is below the threshold.
    energy: [[f32; TILE]; MOST_ORIENTATIONS],
    pub(crate) phase: [[f32; TILE]; MOST_ORIENTATIONS],
    pub(crate) weight: [[f32; TILE]; MOST_ORIENTATIONS],
    /// How far the right place lies beyond its pixel.
    beyond_x: [f32; TILE],
    beyond_y: [f32; TILE],
    in_view: [bool; TILE],
    heard: [u8; TILE],
}

impl Tile {
    fn new() -> Self {
        Self {
            product_even: [[0.0; TILE]; MOST_ORIENTATIONS],
            product_odd: [[0.0; TILE]; MOST_ORIENTATIONS],
            energy: [[0.0; TILE]; MOST_ORIENTATIONS],
            phase: [[0.0; TILE]; MOST_ORIENTATIONS],
            weight: [[0.0; TILE]; MOST_ORIENTATIONS],
            beyond_x: [0.0; TILE],
            beyond_y: [0.0; TILE],
            in_view: [false; TILE],
            heard: [0; TILE],
        }
    }

    /// Reads both eyes' responses for each pixel and keeps their products.
    #[inline(always)]
    fn load(
        &mut self,
        eyes: &Eyes<'_>,
        warp: &Warp<'_>,
        (start, y): (usize, usize),
        dx: &[f32],
        dy: &[f32],
        threshold: f32,
    ) {
        let orientations = eyes.waves.len();
        let mut even = [0.0f32; MOST_ORIENTATIONS];
        let mut odd = [0.0f32; MOST_ORIENTATIONS];
        let (even, odd) = (&mut even[..orientations], &mut odd[..orientations]);
        for i in 0..TILE {
            let place = dx
                .get(i)
                .and_then(|dx| warp.place((start + i) as f32 + dx, y as f32 + dy[i]));
            self.in_view[i] = place.is_some();
            self.heard[i] = 0;
            let Some(place) = place else {
                for q in 0..orientations {
                    self.product_even[q][i] = 0.0;
                    self.product_odd[q][i] = 0.0;
                    self.energy[q][i] = 0.0;
                }
                continue;
            };
            self.beyond_x[i] = place.beyond_x;
            self.beyond_y[i] = place.beyond_y;
            warp.read(place, even, odd);
            let left = eyes.left.pixel(start + i, y);
            let (left_even, left_odd) = (&left.even[..orientations], &left.odd[..orientations]);
            for q in 0..orientations {
                let (le, lo, re, ro) = (left_even[q], left_odd[q], even[q], odd[q]);
                self.product_even[q][i] = le * re + lo * ro;
                self.product_odd[q][i] = lo * re - le * ro;
                let (left, right) = (le * le + lo * lo, re * re + ro * ro);
                let audible = left.min(right) > threshold;
                self.energy[q][i] = if audible { 0.5 * (left + right) } else { 0.0 };
                self.heard[i] += u8::from(audible);
            }
        }
    }

    /// Phases and weights of all orientations.
    ///
    /// The phase is that of the left response over the warped right one, which [`Warp`] left turned
    /// back by `k.beyond`; a product wraps by itself, so no two angles are ever subtracted. The
    /// weight is the balance of the amplitudes, `|L R| / ((|L|^2 + |R|^2) / 2)`: one where both
    /// eyes see the same contrast, small where one of them sees something else.
    #[inline(always)]
    fn look(&mut self, waves: &[WaveVector]) {
        for (q, wave) in waves.iter().enumerate() {
            let (even, odd) = (&self.product_even[q], &self.product_odd[q]);
            let energy = &self.energy[q];
            let (phase, weight) = (&mut self.phase[q], &mut self.weight[q]);
            for i in 0..TILE {
                let turn = wave.x * self.beyond_x[i] + wave.y * self.beyond_y[i];
                phase[i] = wrap(angle(odd[i], even[i]) - turn);
                let amplitudes = (even[i] * even[i] + odd[i] * odd[i]).sqrt();
                weight[i] = if energy[i] > 0.0 {
                    amplitudes / energy[i]
                } else {
                    0.0
                };
            }
        }
    }

    #[inline(always)]
    fn fit(
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
    fn verdict(
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

impl Shifts {
    /// The shifts known at this scale: NaN where no answer was found.
    pub(crate) fn known(&self, plane: &Array2<f32>) -> Array2<f32> {
        Zip::from(plane)
            .and(&self.validity)
            .map_collect(|&shift, validity| if validity.is_valid() { shift } else { f32::NAN })
    }
}
