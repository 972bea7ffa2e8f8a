use std::f32::consts::FRAC_PI_2;
use std::ops::Range;

use ndarray::{Array2, ArrayView1, ArrayView2};
use pulp::{Arch, NullaryFnOnce, Scalar};
use rayon::prelude::*;
use v1_gabor::machine::Machine;
use v1_gabor::{Binocular, FilterBank, LumaImage, WaveVector, WrongSize};

use crate::Validity;
use crate::dense::bands::bands;
use crate::dense::bank_rows::BankRows;
use crate::dense::fitted::numbers;
use crate::dense::nearest::{ROUNDER, nearest, place};
use crate::phase::{angle, cosine, wrap};
use crate::rough::Rough;
use crate::vector::{store, vector};

/// The most that the phase may move a shift, in pixels: what is left of a whole pixel after the
/// parabola.
const MOST_STEP_PX: f32 = 0.4;

/// Beyond this a step is not told any more exactly, in pixels.
const FAR_STEP_PX: f32 = 4.0;

/// Least agreement of the phases with the shift that they give together.
const LEAST_COHERENCE: f32 = 0.5;

/// Largest difference of shifts within 5 x 5 pixels, in pixels: across the end of a surface a filter
/// sees both sides, and its phase is neither's.
const MOST_RANGE_PX: f32 = 1.5;

/// Most banks that are asked together.
pub(crate) const MOST_BANKS: usize = 2;

/// Most orientations of a bank.
const MOST_ORIENTATIONS: usize = 8;

/// At least the lanes of the widest vector there is.
const MOST_LANES: usize = 16;

/// Pixels and parts that are turned together.
const SQUARE: usize = 8;

/// Both eyes' responses of one bank along a row: for each pixel the even parts of all orientations,
/// then the odd ones.
#[derive(Clone, Copy, Debug)]
struct Band<'a> {
    eyes: Binocular<&'a [f32]>,
    /// The wave vectors, by orientation.
    waves: &'a [WaveVector],
}

/// Where a shift may move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gates<'a> {
    /// Largest difference of shifts around, in pixels.
    pub(crate) ranges: ArrayView2<'a, f32>,
    pub(crate) validity: ArrayView2<'a, Validity>,
}

/// What reading responses takes, for one band of rows: a pair for each bank.
pub(crate) type AcuityRoom = Vec<Binocular<BankRows>>;

/// Moves each shift by what the phases still differ there (hyperacuity), and says how well they
/// agree (`coherence`), from -1 to 1, 0 where nothing is heard.
///
/// With `z = Q_R(x + round dx) conj Q_L(x)` and `ph = arg z + w_x (dx - round dx)` (the phase grows
/// along x, and the right eye's is read `dx` further on), weights
/// `W = sqrt|z| (2 |z| / (|Q_L|^2 + |Q_R|^2))^2` for the energy and the balance of both eyes, the
/// shift still to add is `-sum W w_x ph / sum W w_x^2`. Only answers move, and only where `gates`
/// say that one surface is seen: without them the step hurts at the ends of surfaces.
///
/// # Errors
/// [`WrongSize`] if a bank was planned for other images.
pub(crate) fn sharpen(
    dx: &mut Array2<f32>,
    banks: &[FilterBank],
    eyes: Binocular<&LumaImage>,
    gates: Gates<'_>,
    (coherence, rooms): (&mut Array2<f32>, &mut Vec<AcuityRoom>),
) -> Result<(), WrongSize> {
    let (height, width) = dx.dim();
    let waves = banks.iter().map(|bank| bank.params().wave_vectors());
    let waves: Vec<Vec<WaveVector>> = waves.collect();
    let (rooms, of_band) = bands(rooms, height);
    let bands = numbers(dx)
        .par_chunks_mut(of_band * width)
        .zip(numbers(coherence).par_chunks_mut(of_band * width))
        .zip(rooms)
        .enumerate();
    bands.try_for_each(|(band, ((dx, coherence), room))| {
        room.resize_with(banks.len(), Binocular::default);
        let rows = dx
            .chunks_exact_mut(width)
            .zip(coherence.chunks_exact_mut(width));
        for (y, (dx, coherence)) in (band * of_band..).zip(rows) {
            let mut bands = Vec::with_capacity(banks.len());
            for ((bank, waves), space) in banks.iter().zip(&waves).zip(&mut *room) {
                let eyes = Binocular {
                    left: space.left.row(bank, eyes.left, y)?,
                    right: space.right.row(bank, eyes.right, y)?,
                };
                bands.push(Band { eyes, waves });
            }
            let row = Row {
                bands: &bands,
                dx,
                coherence,
                ranges: gates.ranges.row(y),
                validity: gates.validity.row(y),
            };
            row.dispatch();
        }
        Ok(())
    })
}

/// One row of pixels, of which as many as a vector holds are asked side by side.
struct Row<'a> {
    bands: &'a [Band<'a>],
    dx: &'a mut [f32],
    coherence: &'a mut [f32],
    ranges: ArrayView1<'a, f32>,
    validity: ArrayView1<'a, Validity>,
}

impl Row<'_> {
    /// Runs the row in the machine's vectors.
    fn dispatch(self) {
        match Arch::new() {
            #[cfg(target_arch = "x86_64")]
            Arch::V4(v4) => v4.vectorize(Compiled(self, v4, *v4)),
            #[cfg(target_arch = "x86_64")]
            Arch::V3(v3) => v3.vectorize(Compiled(self, v3, v3)),
            _ => Compiled(self, Scalar, Scalar).call(),
        }
    }

    #[inline(always)]
    fn walk<S: Rough, M: Machine<SQUARE>>(self, simd: S, machine: M) {
        let mut block = Block::default();
        let width = self.dx.len();
        for start in (0..width).step_by(S::F32_LANES) {
            let end = (start + S::F32_LANES).min(width);
            block.dx = [0.0; MOST_LANES];
            block.dx[..end - start].copy_from_slice(&self.dx[start..end]);
            let (steps, agreements) =
                residual(simd, machine, self.bands, (start..end, width), &mut block);
            for (i, x) in (start..end).enumerate() {
                let takes = self.validity[x].is_valid()
                    && self.ranges[x] < MOST_RANGE_PX
                    && agreements[i] > LEAST_COHERENCE
                    && steps[i].abs() < MOST_STEP_PX;
                self.coherence[x] = agreements[i];
                if takes {
                    self.dx[x] += steps[i];
                }
            }
        }
    }
}

/// One row's work, compiled for one machine.
struct Compiled<'a, S, M>(Row<'a>, S, M);

impl<S: Rough, M: Machine<SQUARE>> NullaryFnOnce for Compiled<'_, S, M> {
    type Output = ();

    // Inlined into the function that is compiled for the vector unit; a call would leave it.
    #[inline(always)]
    fn call(self) {
        let Self(row, simd, machine) = self;
        row.walk(simd, machine);
    }
}

/// What is known of a few neighbouring pixels, lane by lane.
struct Block {
    dx: [f32; MOST_LANES],
    /// Even and odd parts of each orientation of both eyes, the right ones at the shifted pixel.
    left: [[f32; MOST_LANES]; 2 * MOST_ORIENTATIONS],
    right: [[f32; MOST_LANES]; 2 * MOST_ORIENTATIONS],
    /// Phases and weights of all orientations of all bands.
    phases: [[f32; MOST_LANES]; MOST_BANKS * MOST_ORIENTATIONS],
    weights: [[f32; MOST_LANES]; MOST_BANKS * MOST_ORIENTATIONS],
}

impl Default for Block {
    fn default() -> Self {
        Self {
            dx: [0.0; MOST_LANES],
            left: [[0.0; MOST_LANES]; 2 * MOST_ORIENTATIONS],
            right: [[0.0; MOST_LANES]; 2 * MOST_ORIENTATIONS],
            phases: [[0.0; MOST_LANES]; MOST_BANKS * MOST_ORIENTATIONS],
            weights: [[0.0; MOST_LANES]; MOST_BANKS * MOST_ORIENTATIONS],
        }
    }
}

impl Block {
    /// Reads what both eyes say of a few pixels of a row.
    #[inline(always)]
    fn read<M: Machine<SQUARE>>(
        &mut self,
        machine: M,
        band: &Band<'_>,
        pixels: &Range<usize>,
        width: usize,
    ) {
        // Where each shift leads, beyond the end of the row if it is out of view.
        let mut seen = [usize::MAX; MOST_LANES];
        for (lane, x) in pixels.clone().enumerate() {
            seen[lane] = place(x as f32 + nearest(self.dx[lane]));
        }
        let Binocular { left, right } = band.eyes;
        let parts = 2 * band.waves.len();
        // Squares of pixels and parts are turned in registers: written part by part, they would have to be
        // in the cache before vectors of them are read.
        let squares = if parts.is_multiple_of(SQUARE) {
            pixels.len() / SQUARE
        } else {
            0
        };
        for lane in (0..squares * SQUARE).step_by(SQUARE) {
            for part in (0..parts).step_by(SQUARE) {
                // What is out of view answers nothing.
                let silence = machine.load(&[0.0; SQUARE]);
                let (mut own, mut other) = ([silence; SQUARE], [silence; SQUARE]);
                for i in 0..SQUARE {
                    let x = pixels.start + lane + i;
                    own[i] = machine.load(square(left, x * parts + part));
                    if seen[lane + i] < width {
                        other[i] = machine.load(square(right, seen[lane + i] * parts + part));
                    }
                }
                let (own, other) = (machine.turn(own), machine.turn(other));
                for i in 0..SQUARE {
                    *square_mut(&mut self.left[part + i], lane) = machine.store(own[i]);
                    *square_mut(&mut self.right[part + i], lane) = machine.store(other[i]);
                }
            }
        }
        for lane in squares * SQUARE..pixels.len() {
            let own = &left[(pixels.start + lane) * parts..][..parts];
            let (seen, view) = if seen[lane] < width {
                (seen[lane], 1.0)
            } else {
                (0, 0.0)
            };
            let other = &right[seen * parts..][..parts];
            for part in 0..parts {
                self.left[part][lane] = own[part];
                self.right[part][lane] = view * other[part];
            }
        }
    }
}

/// The numbers of a side of a square, from `start` on.
#[inline(always)]
fn square(numbers: &[f32], start: usize) -> &[f32; SQUARE] {
    numbers[start..].first_chunk().expect(WHOLE)
}

/// The same, to be written.
#[inline(always)]
fn square_mut(numbers: &mut [f32], start: usize) -> &mut [f32; SQUARE] {
    numbers[start..].first_chunk_mut().expect(WHOLE)
}

const WHOLE: &str = "squares are whole";

/// The shifts that the phases at a few pixels still ask for, and their agreement with them.
#[inline(always)]
fn residual<S: Rough, M: Machine<SQUARE>>(
    simd: S,
    machine: M,
    bands: &[Band<'_>],
    (pixels, width): (Range<usize>, usize),
    block: &mut Block,
) -> ([f32; MOST_LANES], [f32; MOST_LANES]) {
    let splat = |value| simd.splat_f32s(value);
    let (zero, tiny) = (splat(0.0), splat(f32::MIN_POSITIVE));
    let dx = vector(simd, &block.dx, 0);
    let rounder = splat(ROUNDER);
    let whole = simd.sub_f32s(simd.add_f32s(dx, rounder), rounder);
    let beyond = simd.sub_f32s(dx, whole);
    let (mut numerator, mut denominator, mut heard) = (zero, zero, zero);
    let mut channel = 0;
    for band in bands.iter().take(MOST_BANKS) {
        block.read(machine, band, &pixels, width);
        for (q, wave) in band.waves.iter().enumerate() {
            let read = |parts: &[[f32; MOST_LANES]], part: usize| vector(simd, &parts[part], 0);
            let odd_part = band.waves.len() + q;
            let (le, lo) = (read(&block.left, q), read(&block.left, odd_part));
            let (re, ro) = (read(&block.right, q), read(&block.right, odd_part));
            let two = |a, b, c, d| simd.mul_add_e_f32s(a, b, simd.mul_f32s(c, d));
            let even = two(re, le, ro, lo);
            let odd = simd.sub_f32s(simd.mul_f32s(ro, le), simd.mul_f32s(re, lo));
            let wave_x = splat(wave.x);
            let turned = simd.mul_add_e_f32s(wave_x, beyond, angle(simd, odd, even));
            let phase = wrap(simd, turned);
            let squared = two(even, even, odd, odd);
            let product = simd.rough_root(simd.max_f32s(squared, tiny));
            let energy = simd.add_f32s(two(le, le, lo, lo), two(re, re, ro, ro));
            let twice = simd.add_f32s(product, product);
            let balance = simd.mul_f32s(twice, simd.rough_reciprocal(simd.max_f32s(energy, tiny)));
            let weight = simd.mul_f32s(simd.rough_root(product), simd.mul_f32s(balance, balance));
            let opposed = simd.less_than_f32s(splat(FRAC_PI_2), simd.abs_f32s(phase));
            let weight = simd.select_f32s(opposed, zero, weight);
            let weight = simd.select_f32s(simd.less_than_f32s(tiny, squared), weight, zero);
            let weighed = simd.mul_f32s(weight, wave_x);
            numerator = simd.mul_add_e_f32s(weighed, phase, numerator);
            denominator = simd.mul_add_e_f32s(weighed, wave_x, denominator);
            heard = simd.add_f32s(heard, weight);
            store(simd, &mut block.phases[channel], 0, phase);
            store(simd, &mut block.weights[channel], 0, weight);
            channel += 1;
        }
    }
    let anything = simd.less_than_f32s(tiny, denominator);
    let step = simd.div_f32s(simd.neg_f32s(numerator), simd.max_f32s(denominator, tiny));
    // Where only the orientation along the rows is heard, a step can be anything; so far it is
    // refused, and a cosine would lose its angle.
    let far = simd.min_f32s(simd.max_f32s(step, splat(-FAR_STEP_PX)), splat(FAR_STEP_PX));
    let step = simd.select_f32s(anything, far, zero);
    let mut agreement = zero;
    let waves = bands.iter().take(MOST_BANKS).flat_map(|band| band.waves);
    for ((phase, weight), wave) in block.phases.iter().zip(&block.weights).zip(waves) {
        let left_over = simd.mul_add_e_f32s(splat(wave.x), step, vector(simd, phase, 0));
        let agrees = cosine(simd, left_over);
        agreement = simd.mul_add_e_f32s(vector(simd, weight, 0), agrees, agreement);
    }
    let agreement = simd.div_f32s(agreement, simd.max_f32s(heard, tiny));
    let agreement = simd.select_f32s(anything, agreement, zero);
    let (mut steps, mut agreements) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
    store(simd, &mut steps, 0, step);
    store(simd, &mut agreements, 0, agreement);
    (steps, agreements)
}

#[cfg(test)]
mod tests {
    use v1_gabor::{GaborParams, Size};

    use super::*;

    /// The step and the coherence at one pixel, by the library's angle, number by number.
    fn plainly(
        banks: &[FilterBank],
        eyes: Binocular<&LumaImage>,
        (x, y): (usize, usize),
        dx: f32,
    ) -> (f64, f64) {
        let whole = dx.round();
        let mut heard = Vec::new();
        for bank in banks {
            let responses = eyes.map(|eye| bank.respond(eye).unwrap());
            let finest = responses.as_ref().map(|eye| &eye.scales()[0]);
            let seen = x as f32 + whole;
            let in_view = seen >= 0.0 && seen < bank.size().width as f32;
            for (q, wave) in bank.params().wave_vectors().into_iter().enumerate() {
                let own = finest.left.at(q, x, y);
                let other = match in_view {
                    true => finest.right.at(q, seen as usize, y),
                    false => 0.0.into(),
                };
                let product = other * own.conj();
                let modulus = f64::from(product.norm());
                let phase = f64::from(product.arg()) + f64::from(wave.x * (dx - whole));
                let turns = (phase / std::f64::consts::TAU).round();
                let phase = phase - turns * std::f64::consts::TAU;
                let energy = f64::from(own.norm_sqr() + other.norm_sqr());
                let balance = 2.0 * modulus / energy.max(1e-30);
                if phase.abs() <= std::f64::consts::FRAC_PI_2 {
                    heard.push((modulus.sqrt() * balance * balance, f64::from(wave.x), phase));
                }
            }
        }
        let sum = |of: &dyn Fn(f64, f64, f64) -> f64| -> f64 {
            heard
                .iter()
                .map(|(weight, wave, phase)| of(*weight, *wave, *phase))
                .sum()
        };
        let step = -sum(&|weight, wave, phase| weight * wave * phase)
            / sum(&|weight, wave, _| weight * wave * wave);
        let agreement = sum(&|weight, wave, phase| weight * (phase + wave * step).cos())
            / sum(&|weight, _, _| weight);
        (step, agreement)
    }

    /// Side by side and one by one pixels move alike, all but those at a gate, where the last bit
    /// of an angle decides.
    #[test]
    fn fast_and_plain_agree() {
        let size = Size {
            width: 45,
            height: 12,
        };
        let see = |shift: f32| {
            let luma = |(y, x): (usize, usize)| {
                let (x, y) = (x as f32 + shift, y as f32);
                0.5 + 0.1 * (1.3 * x).sin()
                    + 0.1 * (1.1 * x + 0.9 * y).sin()
                    + 0.1 * (0.7 * x - 1.2 * y).cos()
            };
            LumaImage::new(Array2::from_shape_fn(size.dim(), luma)).unwrap()
        };
        let (left, right) = (see(0.0), see(3.2));
        let eyes = Binocular {
            left: &left,
            right: &right,
        };
        let bank = |orientations| {
            let params = GaborParams {
                orientations,
                scales: 1,
                ..GaborParams::default()
            };
            FilterBank::plan(params, size).unwrap()
        };
        let (four, eight) = (bank(4), bank(8));
        for banks in [vec![four.clone()], vec![eight, four]] {
            // Guesses within half a pixel of the truth, and a hole that may not move.
            let guess = |(y, x): (usize, usize)| -3.2 + 0.45 * ((7 * x + 13 * y) as f32).sin();
            let before = Array2::from_shape_fn(size.dim(), guess);
            let steady = |x: usize| match x % 7 {
                0 => Validity::Occluded,
                _ => Validity::Valid,
            };
            let validity = Array2::from_shape_fn(size.dim(), |(_, x)| steady(x));
            let ranges = Array2::from_shape_fn(size.dim(), |(y, _)| if y == 5 { 2.0 } else { 0.9 });
            let mut dx = before.clone();
            let gates = Gates {
                ranges: ranges.view(),
                validity: validity.view(),
            };
            let mut coherence = Array2::zeros(size.dim());
            let room = (&mut coherence, &mut Vec::new());
            sharpen(&mut dx, &banks, eyes, gates, room).unwrap();
            let mut differing = 0;
            for ((y, x), &found) in dx.indexed_iter() {
                let own = before[[y, x]];
                let (step, agreement) = plainly(&banks, eyes, (x, y), own);
                let takes = validity[[y, x]].is_valid()
                    && ranges[[y, x]] < MOST_RANGE_PX
                    && agreement > f64::from(LEAST_COHERENCE)
                    && step.abs() < f64::from(MOST_STEP_PX);
                let want = if takes {
                    f64::from(own) + step
                } else {
                    f64::from(own)
                };
                let same = (f64::from(found) - want).abs() < 2e-3
                    && (!agreement.is_finite()
                        || (f64::from(coherence[[y, x]]) - agreement).abs() < 2e-3);
                differing += usize::from(!same);
            }
            assert!(
                differing * 100 <= size.area(),
                "{differing} of {}",
                size.area()
            );
        }
    }
}
