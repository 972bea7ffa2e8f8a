use rayon::prelude::*;
use v1_gabor::{Binocular, Responses};

use crate::SearchRange;
use crate::dense::padding::Padding;
use crate::dense::pixel_cost::{LANES, PixelCost};
use crate::dense::wide::Wide;

/// Orientations of the bank that the cost is taken from: more change nothing.
pub(crate) const COST_ORIENTATIONS: usize = 4;

/// Even and odd parts of all orientations.
const PARTS: usize = 2 * COST_ORIENTATIONS;

/// The largest modulus of a coded response. The sum over the orientations of the product of two of
/// them, rounding of the parts included, stays within 15 bits.
const FULL: f32 = 89.0;

/// The energy of position-shifted binocular cells:
/// `C(x, dx) = 1 - sum_q Re(u_q^L(x) conj u_q^R(x + dx))`, from 0 (all phases agree) to 2.
///
/// The responses are normalised channel by channel, `u_q = Q_q / sqrt(|Q_q|^2 + eps) / sqrt K`, to
/// nearly pure phase: a gain or an offset between the cameras drops out. No angle is computed; the
/// real part of the product is the cosine of the phase difference. Sixteen shifts are compared side
/// by side in 16-bit integers, which hold the sum exactly.
#[derive(Debug)]
pub(crate) struct PhaseAgreement {
    eyes: Binocular<NormalisedResponses>,
    padding: Padding,
}

/// Normalised responses `[[y, part, padded x]]`, in units of 1 / (2 FULL).
#[derive(Clone, Debug)]
struct NormalisedResponses {
    stride: usize,
    parts: Vec<i16>,
}

impl PhaseAgreement {
    /// Takes the finest responses of both eyes, of [`COST_ORIENTATIONS`] orientations each.
    pub(crate) fn new(
        eyes: Binocular<&Responses>,
        silent_energy: f32,
        search: SearchRange,
    ) -> Self {
        let padding = Padding::of(search);
        Self {
            eyes: eyes.map(|eye| NormalisedResponses::of(eye, silent_energy, padding)),
            padding,
        }
    }
}

impl PixelCost for PhaseAgreement {
    #[inline(always)]
    fn costs<W: Wide>(&self, wide: W, x: usize, y: usize, costs: &mut [u8]) {
        let place = self.padding.place(x);
        let first = self.padding.first(x);
        let (left, right) = (&self.eyes.left, &self.eyes.right);
        let part = |part: usize| {
            let run = &right.row(y, part)[first..first + costs.len()];
            let runs = run.as_chunks::<LANES>().0;
            (wide.splat(left.row(y, part)[place]), runs)
        };
        // One by one, since an array of them would live in memory.
        let ((a, runs_a), (b, runs_b)) = (part(0), part(1));
        let ((c, runs_c), (d, runs_d)) = (part(2), part(3));
        let ((e, runs_e), (f, runs_f)) = (part(4), part(5));
        let ((g, runs_g), (h, runs_h)) = (part(6), part(7));
        let first_half = runs_a.iter().zip(runs_b).zip(runs_c).zip(runs_d);
        let second_half = runs_e.iter().zip(runs_f).zip(runs_g).zip(runs_h);
        let blocks = costs.as_chunks_mut::<LANES>().0;
        for ((one, other), costs) in first_half.zip(second_half).zip(blocks) {
            let (((ra, rb), rc), rd) = one;
            let (((re, rf), rg), rh) = other;
            let four = |(a, ra), (b, rb), (c, rc), (d, rd)| {
                let ab = wide.add(wide.mul(a, wide.load(ra)), wide.mul(b, wide.load(rb)));
                let cd = wide.add(wide.mul(c, wide.load(rc)), wide.mul(d, wide.load(rd)));
                wide.add(ab, cd)
            };
            let agreement = wide.add(
                four((a, ra), (b, rb), (c, rc), (d, rd)),
                four((e, re), (f, rf), (g, rg), (h, rh)),
            );
            // From 0 to 2 in 16 bits, of which the upper 7 are kept.
            wide.store_upper_7(wide.sub(wide.splat(i16::MAX), agreement), costs);
        }
    }

    fn seen_by_the_other_eye(&self) -> Self {
        Self {
            eyes: Binocular {
                left: self.eyes.right.mirrored(self.padding),
                right: self.eyes.left.mirrored(self.padding),
            },
            padding: self.padding,
        }
    }
}

/// The nearest integer to a number of at most four digits, without a call: adding 1.5 * 2^23 leaves
/// it in the lower bits.
#[inline(always)]
fn nearest(value: f32) -> i16 {
    (value + 12_582_912.0).to_bits() as i16
}

impl NormalisedResponses {
    fn of(responses: &Responses, silent_energy: f32, padding: Padding) -> Self {
        let size = responses.size();
        let stride = padding.stride(size.width);
        let mut parts = vec![0; size.height * PARTS * stride];
        parts
            .par_chunks_mut(PARTS * stride)
            .enumerate()
            .for_each(|(y, rows)| {
                for x in 0..size.width {
                    let pixel = responses.pixel(x, y);
                    for q in 0..COST_ORIENTATIONS {
                        let (even, odd) = (pixel.even[q], pixel.odd[q]);
                        let energy = even * even + odd * odd;
                        // Silence over silence is silence.
                        let gain = FULL / (energy + silent_energy).max(f32::MIN_POSITIVE).sqrt();
                        let place = padding.place(x);
                        rows[q * stride + place] = nearest(even * gain);
                        rows[(COST_ORIENTATIONS + q) * stride + place] = nearest(odd * gain);
                    }
                }
                for row in rows.chunks_mut(stride) {
                    padding.replicate(row);
                }
            });
        Self { stride, parts }
    }

    #[inline(always)]
    fn row(&self, y: usize, part: usize) -> &[i16] {
        let start = (y * PARTS + part) * self.stride;
        &self.parts[start..start + self.stride]
    }

    fn mirrored(&self, padding: Padding) -> Self {
        let mut mirrored = self.clone();
        mirrored
            .parts
            .par_chunks_mut(self.stride)
            .for_each(|row| padding.mirror(row));
        mirrored
    }
}
