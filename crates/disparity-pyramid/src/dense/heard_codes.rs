use std::ops::Range;

use ndarray::Array2;
use rayon::prelude::*;
use v1_gabor::WaveVector;
use v1_gabor::machine::Machine;

use crate::dense::fitted::numbers;
use crate::dense::hyperacuity::{Block, Gates, MOST_LANES, PhaseSource, Row, SQUARE, lanes};
use crate::dense::phase_agreement::{AgreementRow, BIAS, COST_ORIENTATIONS, PhaseAgreement};
use crate::dense::pixel_cost::PixelCost;
use crate::rough::Rough;

/// Both eyes' codes along a row, and the wave vectors of the bank that they are of.
#[derive(Clone, Copy, Debug)]
struct Codes<'a> {
    row: AgreementRow<'a>,
    waves: &'a [WaveVector],
}

/// Sharpens every shift by the codes that the cost is made of (see [`Row`]), and says how well they agree
/// (`coherence`); `waves` are those of the cost's bank.
///
/// A code's modulus is that of what it tells, next to 1 unless all is silent, so that the orientations
/// count alike, `W = |z|^2`; level 1 is not asked again.
pub(crate) fn sharpen_by_codes(
    dx: &mut Array2<f32>,
    agreement: &PhaseAgreement,
    waves: &[WaveVector],
    gates: Gates<'_>,
    coherence: &mut Array2<f32>,
) {
    let width = dx.ncols();
    numbers(dx)
        .par_chunks_mut(width)
        .zip(numbers(coherence).par_chunks_mut(width))
        .enumerate()
        .for_each(|(y, (dx, coherence))| {
            let codes = Codes {
                row: agreement.row(y),
                waves,
            };
            let (ranges, validity) = gates.row(y);
            let row = Row {
                sources: &[codes],
                dx,
                coherence,
                ranges,
                validity,
            };
            row.sharpen();
        });
}

impl PhaseSource for Codes<'_> {
    #[inline(always)]
    fn waves(&self) -> &[WaveVector] {
        self.waves
    }

    #[inline(always)]
    fn read<M: Machine<SQUARE>>(
        &self,
        _: M,
        pixels: &Range<usize>,
        width: usize,
        block: &mut Block,
    ) {
        let seen = block.seen(pixels);
        let AgreementRow {
            left,
            right,
            padding,
            ..
        } = self.row;
        let first = padding.place(pixels.start);
        let straight = straight(&seen, width);
        for q in 0..COST_ORIENTATIONS {
            // What is out of view, or beyond the end of the row, answers nothing.
            let own = lanes(&left[q][first..][..pixels.len()], [BIAS; 2]);
            let right = &right[q][padding.place(0)..][..width];
            let other = match straight {
                Some(seen) => lanes(&right[seen..], [BIAS; 2]),
                None => {
                    let mut other = [[BIAS; 2]; MOST_LANES];
                    for lane in 0..MOST_LANES {
                        if let Some(code) = right.get(seen[lane]) {
                            other[lane] = *code;
                        }
                    }
                    other
                }
            };
            let odd = COST_ORIENTATIONS + q;
            for lane in 0..MOST_LANES {
                block.left[q][lane] = part(own[lane][0]);
                block.left[odd][lane] = part(own[lane][1]);
                block.right[q][lane] = part(other[lane][0]);
                block.right[odd][lane] = part(other[lane][1]);
            }
        }
    }

    #[inline(always)]
    fn weight<S: Rough>(&self, _: S, squared: S::f32s, _: S::f32s) -> S::f32s {
        squared
    }
}

/// The first place that is seen, if all are in view and lie side by side as the pixels do: most shifts are
/// their neighbours', and what lies side by side is read at once.
#[inline(always)]
fn straight(seen: &[usize; MOST_LANES], width: usize) -> Option<usize> {
    let first = seen[0];
    let mut apart = 0;
    for lane in 0..MOST_LANES {
        apart |= seen[lane] ^ first.wrapping_add(lane);
    }
    let all = apart == 0 && first.saturating_add(MOST_LANES) <= width;
    all.then_some(first)
}

/// The part that a byte stands for.
#[inline(always)]
fn part(byte: u8) -> f32 {
    f32::from(byte) - f32::from(BIAS)
}

#[cfg(test)]
mod tests {
    use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};

    use super::*;
    use crate::dense::heard_responses::sharpen;
    use crate::dense::phase_agreement::{Loudness, Seen};
    use crate::{SearchRange, Validity};

    /// Codes say what the responses say that they are made of.
    #[test]
    fn codes_and_responses_agree() {
        let size = Size {
            width: 61,
            height: 12,
        };
        let see = |shift: f32| {
            let luma = |(y, x): (usize, usize)| {
                let (x, y) = (x as f32 + shift, y as f32);
                let wave = |a: f32, b: f32| 0.05 * (a * x + b * y).sin();
                0.5 + wave(1.4, 0.0) + wave(1.1, 1.0) + wave(0.9, -1.2) + wave(0.3, 1.5)
            };
            LumaImage::new(Array2::from_shape_fn(size.dim(), luma)).unwrap()
        };
        let (left, right) = (see(0.0), see(-3.2));
        let eyes = Binocular {
            left: &left,
            right: &right,
        };
        let loudness = Loudness {
            silent_energy: 1e-9,
            opponent: 0.0,
            opponent_silent_energy: 0.0,
        };
        let params = GaborParams {
            orientations: COST_ORIENTATIONS,
            scales: 1,
            ..GaborParams::default()
        };
        let bank = FilterBank::plan(params, size).unwrap();
        let search = SearchRange::new(-9, 9).unwrap();
        let mut agreement = PhaseAgreement::default();
        agreement
            .take_in(
                &bank,
                eyes.map(Seen::luma),
                loudness,
                (search, 30),
                &mut Vec::new(),
            )
            .unwrap();
        let guess = |(y, x): (usize, usize)| 3.2 + 0.35 * ((7 * x + 13 * y) as f32).sin();
        let before = Array2::from_shape_fn(size.dim(), guess);
        let validity = Array2::from_elem(size.dim(), Validity::Valid);
        let ranges = Array2::zeros(size.dim());
        let gates = Gates {
            ranges: &ranges,
            validity: &validity,
        };
        let (mut by_codes, mut by_responses) = (before.clone(), before.clone());
        let mut coherences = [Array2::zeros(size.dim()), Array2::zeros(size.dim())];
        let [of_codes, of_responses] = &mut coherences;
        let waves = params.wave_vectors();
        sharpen_by_codes(&mut by_codes, &agreement, &waves, gates, of_codes);
        let room = (of_responses, &mut Vec::new());
        sharpen(&mut by_responses, &[bank], eyes, gates, room).unwrap();
        // A filter at the border sees the border repeated, in one eye sooner than in the other.
        let inside = (0..size.height).flat_map(|y| (8..size.width - 8).map(move |x| [y, x]));
        let mean = |of: &dyn Fn([usize; 2]) -> f32| {
            let values: Vec<f32> = inside.clone().map(of).collect();
            values.iter().sum::<f32>() / values.len() as f32
        };
        // Orientations that are heard less count less among responses; what they say is the same.
        let apart = mean(&|at| (by_codes[at] - by_responses[at]).abs());
        assert!(apart < 0.01, "{apart}");
        let agreements_apart = mean(&|at| (coherences[0][at] - coherences[1][at]).abs());
        assert!(agreements_apart < 0.01, "{agreements_apart}");
        let errors = [&before, &by_responses, &by_codes]
            .map(|dx| mean(&|at: [usize; 2]| (dx[at] - 3.2).abs()));
        assert!(
            errors[1] < 0.3 * errors[0] && errors[2] < 0.3 * errors[0],
            "{errors:?}"
        );
    }
}
