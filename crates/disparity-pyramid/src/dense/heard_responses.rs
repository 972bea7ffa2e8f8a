use std::ops::Range;

use ndarray::Array2;
use rayon::prelude::*;
use v1_gabor::machine::Machine;
use v1_gabor::{Binocular, FilterBank, LumaImage, WaveVector, WrongSize};

use crate::dense::bands::bands;
use crate::dense::bank_rows::BankRows;
use crate::dense::fitted::numbers;
use crate::dense::hyperacuity::{Block, Gates, PhaseSource, Row, SQUARE};
use crate::rough::Rough;

/// Both eyes' responses of one bank along a row: for each pixel the even parts of all orientations,
/// then the odd ones.
#[derive(Clone, Copy, Debug)]
struct Band<'a> {
    eyes: Binocular<&'a [f32]>,
    /// The wave vectors, by orientation.
    waves: &'a [WaveVector],
}

/// What reading responses takes, for one band of rows: a pair for each bank.
pub(crate) type AcuityRoom = Vec<Binocular<BankRows>>;

/// Sharpens every shift by what banks say (see [`Row`]), and says how well they agree (`coherence`).
///
/// The weights of an orientation are `W = sqrt|z| (2 |z| / (|Q_L|^2 + |Q_R|^2))^2`, for the energy and the
/// balance of both eyes.
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
            let (ranges, validity) = gates.row(y);
            let row = Row {
                sources: &bands,
                dx,
                coherence,
                ranges,
                validity,
            };
            row.sharpen();
        }
        Ok(())
    })
}

impl PhaseSource for Band<'_> {
    #[inline(always)]
    fn waves(&self) -> &[WaveVector] {
        self.waves
    }

    #[inline(always)]
    fn read<M: Machine<SQUARE>>(
        &self,
        machine: M,
        pixels: &Range<usize>,
        width: usize,
        block: &mut Block,
    ) {
        let seen = block.seen(pixels);
        let Binocular { left, right } = self.eyes;
        let parts = 2 * self.waves.len();
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
                    *square_mut(&mut block.left[part + i], lane) = machine.store(own[i]);
                    *square_mut(&mut block.right[part + i], lane) = machine.store(other[i]);
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
                block.left[part][lane] = own[part];
                block.right[part][lane] = view * other[part];
            }
        }
    }

    #[inline(always)]
    fn weight<S: Rough>(&self, simd: S, squared: S::f32s, energy: S::f32s) -> S::f32s {
        let tiny = simd.splat_f32s(f32::MIN_POSITIVE);
        let product = simd.rough_root(simd.max_f32s(squared, tiny));
        let twice = simd.add_f32s(product, product);
        let balance = simd.mul_f32s(twice, simd.rough_reciprocal(simd.max_f32s(energy, tiny)));
        simd.mul_f32s(simd.rough_root(product), simd.mul_f32s(balance, balance))
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

#[cfg(test)]
mod tests {
    use v1_gabor::{GaborParams, Size};

    use super::*;
    use crate::Validity;
    use crate::dense::hyperacuity::{LEAST_COHERENCE, MOST_RANGE_PX, MOST_STEP_PX};

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
                ranges: &ranges,
                validity: &validity,
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
