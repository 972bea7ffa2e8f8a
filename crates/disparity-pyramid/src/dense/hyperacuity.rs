use std::f32::consts::FRAC_PI_2;

use ndarray::{Array2, ArrayView2, Axis};
use pulp::{Arch, NullaryFnOnce, Scalar};
use rayon::prelude::*;
use v1_gabor::{Binocular, Responses, WaveVector};

use crate::dense::nearest::nearest;
use crate::phase::{angle, cosine, wrap};
use crate::vector::lanes;

/// The most that the phase may move a shift, in pixels: what is left of a whole pixel after the
/// parabola.
const MOST_STEP_PX: f32 = 0.4;

/// Least agreement of the phases with the shift that they give together.
const LEAST_COHERENCE: f32 = 0.5;

/// Largest difference of shifts within 5 x 5 pixels, in pixels: across the end of a surface a filter
/// sees both sides, and its phase is neither's.
const MOST_RANGE_PX: f32 = 1.5;

/// Most banks that are asked together.
pub(crate) const MOST_BANKS: usize = 2;

/// Both eyes' responses of one bank.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Band<'a> {
    pub(crate) eyes: Binocular<&'a Responses>,
    /// The wave vectors, by orientation.
    pub(crate) waves: &'a [WaveVector],
}

/// Moves each shift by what the phases still differ there (hyperacuity), and returns how well they
/// agree, from -1 to 1, 0 where nothing is heard.
///
/// With `z = Q_R(x + round dx) conj Q_L(x)` and `ph = arg z + w_x (dx - round dx)` (the phase grows
/// along x, and the right eye's is read `dx` further on), weights
/// `W = sqrt|z| (2 |z| / (|Q_L|^2 + |Q_R|^2))^2` for the energy and the balance of both eyes, the
/// shift still to add is `-sum W w_x ph / sum W w_x^2`. `steady` says where a shift may move:
/// without these gates the step hurts at the ends of surfaces.
pub(crate) fn sharpen(
    dx: &mut Array2<f32>,
    bands: &[Band<'_>],
    ranges: ArrayView2<'_, f32>,
    steady: ArrayView2<'_, bool>,
) -> Array2<f32> {
    let mut coherence = Array2::zeros(dx.dim());
    let rows = dx.axis_iter_mut(Axis(0)).into_par_iter();
    let coherences = coherence.axis_iter_mut(Axis(0)).into_par_iter();
    rows.zip(coherences)
        .enumerate()
        .for_each(|(y, (mut dx, mut coherence))| {
            let row = Row {
                bands,
                y,
                dx: dx.iter_mut().zip(coherence.iter_mut()),
                gates: ranges.row(y).into_iter().zip(steady.row(y)),
            };
            // Loops over orientations have a known length: those of the cost, or the paper's.
            if bands.iter().all(|band| band.waves.len() <= 4) {
                Arch::new().dispatch(InLanes::<4, _>(row));
            } else {
                Arch::new().dispatch(InLanes::<8, _>(row));
            }
        });
    coherence
}

struct Row<'a, I, J> {
    bands: &'a [Band<'a>],
    y: usize,
    dx: I,
    gates: J,
}

/// One row with the orientations in `LANES` lanes.
struct InLanes<const LANES: usize, R>(R);

impl<'a, const LANES: usize, I, J> NullaryFnOnce for InLanes<LANES, Row<'_, I, J>>
where
    I: Iterator<Item = (&'a mut f32, &'a mut f32)>,
    J: Iterator<Item = (&'a f32, &'a bool)>,
{
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Row {
            bands,
            y,
            dx,
            gates,
        } = self.0;
        for (x, ((dx, coherence), (range, steady))) in dx.zip(gates).enumerate() {
            let (step, agreement) = residual::<LANES>(bands, x, y, *dx);
            *coherence = agreement;
            let takes = *steady
                && *range < MOST_RANGE_PX
                && agreement > LEAST_COHERENCE
                && step.abs() < MOST_STEP_PX;
            if takes {
                *dx += step;
            }
        }
    }
}

/// The shift that the phases at a pixel still ask for, and their agreement with it.
#[inline(always)]
fn residual<const LANES: usize>(bands: &[Band<'_>], x: usize, y: usize, dx: f32) -> (f32, f32) {
    let whole = nearest(dx);
    let seen = x as f32 + whole;
    let width = bands.first().map_or(0, |band| band.eyes.right.size().width);
    if !(seen >= 0.0 && seen < width as f32) {
        return (0.0, 0.0);
    }
    let mut phases = [[0.0; LANES]; MOST_BANKS];
    let mut weights = [[0.0; LANES]; MOST_BANKS];
    let mut waves = [[0.0; LANES]; MOST_BANKS];
    let (mut numerator, mut denominator, mut heard) = (0.0, 0.0, 0.0);
    for (i, band) in bands.iter().take(MOST_BANKS).enumerate() {
        let left = band.eyes.left.pixel(x, y);
        let right = band.eyes.right.pixel(seen as usize, y);
        let (le, lo) = (lanes::<LANES>(left.even), lanes::<LANES>(left.odd));
        let (re, ro) = (lanes::<LANES>(right.even), lanes::<LANES>(right.odd));
        for (lane, wave) in waves[i].iter_mut().zip(band.waves) {
            *lane = wave.x;
        }
        for q in 0..LANES {
            let even = re[q] * le[q] + ro[q] * lo[q];
            let odd = ro[q] * le[q] - re[q] * lo[q];
            let moved = waves[i][q] * (dx - whole);
            let phase = wrap(Scalar, angle(Scalar, odd, even) + moved);
            let product = (even * even + odd * odd).sqrt();
            let energy = le[q] * le[q] + lo[q] * lo[q] + re[q] * re[q] + ro[q] * ro[q];
            let balance = 2.0 * product / energy.max(f32::MIN_POSITIVE);
            let weight = product.sqrt() * balance * balance;
            let weight = if phase.abs() > FRAC_PI_2 { 0.0 } else { weight };
            phases[i][q] = phase;
            weights[i][q] = weight;
        }
        for q in 0..LANES {
            numerator += weights[i][q] * waves[i][q] * phases[i][q];
            denominator += weights[i][q] * waves[i][q] * waves[i][q];
            heard += weights[i][q];
        }
    }
    if denominator <= f32::MIN_POSITIVE {
        return (0.0, 0.0);
    }
    let step = -numerator / denominator;
    let mut agreement = 0.0;
    for i in 0..bands.len().min(MOST_BANKS) {
        for q in 0..LANES {
            agreement += weights[i][q] * cosine(Scalar, phases[i][q] + waves[i][q] * step);
        }
    }
    (step, agreement / heard)
}
