use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;
use v1_gabor::{Binocular, Responses};

use crate::SearchRange;
use crate::dense::padding::Padding;
use crate::dense::pixel_cost::{LANES, PixelCost};
use crate::dense::wide::Wide;

/// Orientations of the bank that the cost is taken from: more change nothing.
pub(crate) const COST_ORIENTATIONS: usize = 4;

/// The largest modulus of a coded response. The sum over the orientations of the product of two of
/// them, rounding of the parts included, stays within 15 bits, and twice that within 16.
const FULL: f32 = 89.0;

/// What is added to a part so that it has no sign.
const BIAS: u8 = 90;

/// The energy of position-shifted binocular cells:
/// `C(x, dx) = 1 - sum_q Re(u_q^L(x) conj u_q^R(x + dx))`, from 0 (all phases agree) to 2.
///
/// The responses are normalised channel by channel, `u_q = Q_q / sqrt(|Q_q|^2 + eps) / sqrt K`, to
/// nearly pure phase: a gain or an offset between the cameras drops out. No angle is computed; the
/// real part of the product is the cosine of the phase difference. Parts are bytes; thirty-two shifts
/// are compared side by side, and 16-bit integers hold the sums of their products exactly.
#[derive(Debug)]
pub(crate) struct PhaseAgreement {
    eyes: Binocular<NormalisedResponses>,
    padding: Padding,
    /// What 2^16 times a step of the sums of products costs.
    factor: i16,
}

/// Normalised responses `[[y, orientation, padded x, part]]`, in units of 1 / (2 FULL), and
/// [`BIAS`] more.
#[derive(Clone, Debug)]
struct NormalisedResponses {
    stride: usize,
    parts: Vec<[u8; 2]>,
}

impl PhaseAgreement {
    /// Takes the finest responses of both eyes, of [`COST_ORIENTATIONS`] orientations each. `unit`
    /// is what a unit of cost is.
    pub(crate) fn new(
        eyes: Binocular<&Responses>,
        silent_energy: f32,
        search: SearchRange,
        unit: u8,
    ) -> Self {
        const AGREEMENT: f32 = COST_ORIENTATIONS as f32 * FULL * FULL;
        let padding = Padding::of(search);
        Self {
            eyes: eyes.map(|eye| NormalisedResponses::of(eye, silent_energy, padding)),
            padding,
            factor: (f32::from(unit) * 65536.0 / AGREEMENT).round() as i16,
        }
    }
}

impl PixelCost for PhaseAgreement {
    #[inline(always)]
    fn costs<W: Wide>(&self, wide: W, x: usize, y: usize, costs: &mut [u8]) {
        let place = self.padding.place(x);
        let run = self.padding.first(x)..self.padding.first(x) + costs.len();
        let (left, right) = (&self.eyes.left, &self.eyes.right);
        let mut without_bias = i16::MAX;
        let mut orientation = |q: usize| {
            let own = left.row(y, q)[place].map(|part| part.wrapping_sub(BIAS).cast_signed());
            for part in own {
                without_bias = without_bias.wrapping_add(i16::from(BIAS) * i16::from(part));
            }
            let runs = right.row(y, q)[run.clone()].as_flattened();
            (wide.splat_pair(own), runs.as_chunks::<LANES>().0)
        };
        // One by one, since an array of them would live in memory.
        let ((a, runs_a), (b, runs_b)) = (orientation(0), orientation(1));
        let ((c, runs_c), (d, runs_d)) = (orientation(2), orientation(3));
        let (base, factor) = (wide.splat_word(without_bias), wide.splat_word(self.factor));
        let disagreement = |[ra, rb, rc, rd]: [&[u8; LANES]; 4]| {
            let dot = |pair, run| wide.dot_pairs(wide.load(run), pair);
            let ab = wide.add_words(dot(a, ra), dot(b, rb));
            let cd = wide.add_words(dot(c, rc), dot(d, rd));
            // From 0 to 2 in 16 bits without sign.
            wide.sub_words(base, wide.add_words(ab, cd))
        };
        let runs = runs_a.chunks_exact(2).zip(runs_b.chunks_exact(2));
        let runs = runs.zip(runs_c.chunks_exact(2).zip(runs_d.chunks_exact(2)));
        let blocks = costs.as_chunks_mut::<LANES>().0;
        for (costs, ((a, b), (c, d))) in blocks.iter_mut().zip(runs) {
            let first = disagreement([&a[0], &b[0], &c[0], &d[0]]);
            let second = disagreement([&a[1], &b[1], &c[1], &d[1]]);
            wide.store(wide.upper_products(first, second, factor), costs);
        }
    }

    fn seen_by_the_other_eye(&self) -> Self {
        Self {
            eyes: Binocular {
                left: self.eyes.right.mirrored(self.padding),
                right: self.eyes.left.mirrored(self.padding),
            },
            ..*self
        }
    }
}

/// One row of responses of four orientations.
struct NormalisedRow<'a> {
    /// Even and odd parts of each pixel.
    samples: &'a [[f32; 2 * COST_ORIENTATIONS]],
    silent_energy: f32,
    rows: [&'a mut [[u8; 2]]; COST_ORIENTATIONS],
}

impl NullaryFnOnce for NormalisedRow<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let [a, b, c, d] = self.rows;
        let rows = a.iter_mut().zip(b).zip(c.iter_mut().zip(d));
        for (sample, ((a, b), (c, d))) in self.samples.iter().zip(rows) {
            let energy: [f32; COST_ORIENTATIONS] = std::array::from_fn(|q| {
                let (even, odd) = (sample[q], sample[COST_ORIENTATIONS + q]);
                even * even + odd * odd
            });
            // Silence over silence is silence.
            let gain = energy
                .map(|energy| FULL / (energy + self.silent_energy).max(f32::MIN_POSITIVE).sqrt());
            let code = |part: usize| byte(sample[part] * gain[part % COST_ORIENTATIONS]);
            let codes: [u8; 2 * COST_ORIENTATIONS] = std::array::from_fn(code);
            *a = [codes[0], codes[4]];
            *b = [codes[1], codes[5]];
            *c = [codes[2], codes[6]];
            *d = [codes[3], codes[7]];
        }
    }
}

/// The nearest integer to a small number, and [`BIAS`] more, without a call: adding 1.5 * 2^23
/// leaves it in the lower bits.
#[inline(always)]
fn byte(value: f32) -> u8 {
    (value + (12_582_912.0 + BIAS as f32)).to_bits() as u8
}

impl NormalisedResponses {
    fn of(responses: &Responses, silent_energy: f32, padding: Padding) -> Self {
        let size = responses.size();
        let stride = padding.stride(size.width);
        let mut parts = vec![[BIAS; 2]; size.height * COST_ORIENTATIONS * stride];
        let samples = responses.samples().as_chunks().0;
        parts
            .par_chunks_mut(COST_ORIENTATIONS * stride)
            .zip(samples.par_chunks(size.width))
            .for_each(|(rows, samples)| {
                let own = padding.place(0)..padding.place(size.width);
                let mut each = rows.chunks_exact_mut(stride);
                let rows: [&mut [[u8; 2]]; COST_ORIENTATIONS] = std::array::from_fn(|_| {
                    let row: &mut [[u8; 2]] = each.next().unwrap_or_default();
                    row.get_mut(own.clone()).unwrap_or_default()
                });
                Arch::new().dispatch(NormalisedRow {
                    samples,
                    silent_energy,
                    rows,
                });
            });
        for row in parts.chunks_exact_mut(stride) {
            padding.replicate(row);
        }
        Self { stride, parts }
    }

    /// One row of one orientation, padded.
    #[inline(always)]
    fn row(&self, y: usize, orientation: usize) -> &[[u8; 2]] {
        let start = (y * COST_ORIENTATIONS + orientation) * self.stride;
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
