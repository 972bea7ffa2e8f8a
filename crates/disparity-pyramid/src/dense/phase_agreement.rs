use pulp::{Arch, NullaryFnOnce, Scalar};
use rayon::prelude::*;
use v1_gabor::machine::Machine;
use v1_gabor::{Binocular, FilterBank, LumaImage, WrongSize};

use crate::SearchRange;
use crate::dense::bands::bands;
use crate::dense::bank_rows::BankRows;
use crate::dense::padding::Padding;
use crate::dense::pixel_cost::{LANES, PixelCost, RowCost};
use crate::dense::wide::Wide;
use crate::rough::Rough;

/// Orientations of the bank that the cost is taken from: more change nothing.
pub(crate) const COST_ORIENTATIONS: usize = 4;

/// Parts of a response: two an orientation.
const PARTS: usize = 2 * COST_ORIENTATIONS;

/// What is added to a part so that it has no sign: more than any part.
pub(crate) const BIAS: u8 = 90;

/// Where the sum of the products of two pixels' parts is cut off: the rest is the cost.
const CUT: f32 = 1024.0;

/// The energy of position-shifted binocular cells:
/// `C(x, dx) = 1 - sum_q Re(u_q^L(x) conj u_q^R(x + dx))`, from 0 (all phases agree) to 2.
///
/// The responses are normalised channel by channel, `u_q = Q_q / sqrt(|Q_q|^2 + eps) / sqrt K`, to
/// nearly pure phase: a gain or an offset between the cameras drops out. No angle is computed; the
/// real part of the product is the cosine of the phase difference. Parts are bytes; thirty-two shifts
/// are compared side by side, and 16-bit integers hold the sums of their products exactly.
#[derive(Clone, Debug, Default)]
pub(crate) struct PhaseAgreement {
    eyes: Binocular<NormalisedResponses>,
    padding: Padding,
    /// The largest sum of products that two pixels can have.
    most: i16,
}

/// Normalised responses `[[y, orientation, padded x, part]]`, in units of 1 / (2 sqrt(256 unit)), and
/// [`BIAS`] more.
#[derive(Clone, Debug, Default)]
struct NormalisedResponses {
    stride: usize,
    parts: Vec<[u8; 2]>,
}

impl PhaseAgreement {
    /// Takes in what a bank of [`COST_ORIENTATIONS`] orientations says of both eyes. `unit` is what a
    /// unit of cost is.
    ///
    /// # Errors
    /// [`WrongSize`] if the bank was planned for others.
    pub(crate) fn take_in(
        &mut self,
        bank: &FilterBank,
        eyes: Binocular<&LumaImage>,
        silent_energy: f32,
        (search, unit): (SearchRange, u8),
        rooms: &mut Vec<BankRows>,
    ) -> Result<(), WrongSize> {
        self.padding = Padding::of(search);
        // The sum over the orientations of the products of full responses is a unit, cut off.
        let full = (f32::from(unit) * CUT / COST_ORIENTATIONS as f32).sqrt();
        // Rounding lengthens a pixel's vector of eight parts by at most half of sqrt 8.
        let longest = (COST_ORIENTATIONS as f32).sqrt() * full + 2.0f32.sqrt();
        self.most = (longest * longest).ceil() as i16;
        let Binocular { left, right } = &mut self.eyes;
        for (responses, eye) in [(left, eyes.left), (right, eyes.right)] {
            responses.take_in(bank, eye, (silent_energy, full), self.padding, rooms)?;
        }
        Ok(())
    }
}

impl PixelCost for PhaseAgreement {
    type Row<'a> = AgreementRow<'a>;

    #[inline(always)]
    fn row(&self, y: usize) -> AgreementRow<'_> {
        AgreementRow {
            left: self.eyes.left.rows(y),
            right: self.eyes.right.rows(y),
            padding: self.padding,
            most: self.most,
        }
    }

    fn change_eyes(&mut self) {
        let Binocular { left, right } = &mut self.eyes;
        std::mem::swap(left, right);
        left.mirror(self.padding);
        right.mirror(self.padding);
    }
}

/// The parts of one eye along a row, by orientation: even and odd, and [`BIAS`] more.
pub(crate) type RowParts<'a> = [&'a [[u8; 2]]; COST_ORIENTATIONS];

/// Both eyes' parts along one row, orientation by orientation.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AgreementRow<'a> {
    pub(crate) left: RowParts<'a>,
    pub(crate) right: RowParts<'a>,
    pub(crate) padding: Padding,
    most: i16,
}

impl RowCost for AgreementRow<'_> {
    #[inline(always)]
    fn costs<W: Wide>(self, wide: W, x: usize, first: usize, costs: &mut [u8]) {
        let place = self.padding.place(x);
        let first = self.padding.first(x) + first;
        let run = first..first + costs.len();
        let [a, b, c, d] = self.left;
        let left = Left::of(wide, [a[place], b[place], c[place], d[place]], self.most);
        let [a, b, c, d] = self.right;
        let (a, b) = (blocks(a, &run), blocks(b, &run));
        let (c, d) = (blocks(c, &run), blocks(d, &run));
        let runs = a.iter().zip(b).zip(c.iter().zip(d));
        for (costs, ((a, b), (c, d))) in costs.as_chunks_mut::<LANES>().0.iter_mut().zip(runs) {
            let cost = left.disagreement(wide, [a, b, c, d]);
            wide.store(wide.upper_6(cost), costs);
        }
    }
}

/// A run of a row in blocks of as many pixels as are compared side by side.
#[inline(always)]
fn blocks<'a>(row: &'a [[u8; 2]], run: &std::ops::Range<usize>) -> &'a [[[u8; 2]; LANES]] {
    row[run.clone()].as_chunks().0
}

/// A pixel of the reference, side by side for all shifts.
struct Left<W: Wide> {
    /// The largest disagreement, and what the bias of the other eye's parts takes away from it.
    base: W::Words,
    pairs: [W::Words; COST_ORIENTATIONS],
}

// No closure may stand here: it would be compiled without the vector unit's features.
impl<W: Wide> Left<W> {
    #[inline(always)]
    fn of(wide: W, own: [[u8; 2]; COST_ORIENTATIONS], most: i16) -> Self {
        let bias = wide.splat_pair([BIAS; 2], 0);
        let mut base = wide.splat_word(most);
        let mut pairs = [base; COST_ORIENTATIONS];
        for q in 0..COST_ORIENTATIONS {
            pairs[q] = wide.splat_pair(own[q], BIAS);
            base = wide.add_words(base, wide.dot_pairs(bias, pairs[q]));
        }
        Self { base, pairs }
    }

    /// How little the phases agree at a block of shifts, from 0 to 2 in 16 bits without sign.
    #[inline(always)]
    fn disagreement(&self, wide: W, runs: [&[[u8; 2]; LANES]; COST_ORIENTATIONS]) -> W::Words {
        let a = wide.dot_pairs(wide.load_pairs(runs[0]), self.pairs[0]);
        let b = wide.dot_pairs(wide.load_pairs(runs[1]), self.pairs[1]);
        let c = wide.dot_pairs(wide.load_pairs(runs[2]), self.pairs[2]);
        let d = wide.dot_pairs(wide.load_pairs(runs[3]), self.pairs[3]);
        let sum = wide.add_words(wide.add_words(a, b), wide.add_words(c, d));
        wide.sub_words(self.base, sum)
    }
}

/// One row of responses of four orientations.
struct NormalisedRow<'a> {
    /// Even and odd parts of each pixel.
    samples: &'a [[f32; PARTS]],
    silent_energy: f32,
    /// The modulus of a full response.
    full: f32,
    rows: [&'a mut [[u8; 2]]; COST_ORIENTATIONS],
}

impl NormalisedRow<'_> {
    /// Runs the row in the machine's vectors.
    fn dispatch(self) {
        match Arch::new() {
            #[cfg(target_arch = "x86_64")]
            Arch::V4(v4) => v4.vectorize(Compiled(self, *v4, v4)),
            #[cfg(target_arch = "x86_64")]
            Arch::V3(v3) => v3.vectorize(Compiled(self, v3, v3)),
            _ => Compiled(self, Scalar, Scalar).call(),
        }
    }

    /// Codes of as many pixels as they have parts: turned, so that the same part of all lies side by side.
    #[inline(always)]
    fn code_square<M: Machine<PARTS>, S: Rough>(
        &mut self,
        (machine, simd): (M, S),
        x: usize,
        square: &[[f32; PARTS]; PARTS],
    ) {
        let mut parts = [machine.load(&square[0]); PARTS];
        for i in 1..PARTS {
            parts[i] = machine.load(&square[i]);
        }
        let parts = machine.turn(parts);
        let mut gains = [0.0; COST_ORIENTATIONS * PARTS];
        let (each, _) = gains.as_chunks_mut::<PARTS>();
        for q in 0..COST_ORIENTATIONS {
            let even = machine.store(parts[q]);
            let odd = machine.store(parts[COST_ORIENTATIONS + q]);
            for i in 0..PARTS {
                each[q][i] = self.tells(even[i], odd[i]);
            }
        }
        let full = simd.splat_f32s(self.full);
        for gains in S::as_mut_simd_f32s(&mut gains).0 {
            *gains = simd.mul_f32s(full, simd.rough_inverse_root(*gains));
        }
        let (each, _) = gains.as_chunks::<PARTS>();
        for q in 0..COST_ORIENTATIONS {
            let even = machine.store(parts[q]);
            let odd = machine.store(parts[COST_ORIENTATIONS + q]);
            let mut codes = [[0; 2]; PARTS];
            for i in 0..PARTS {
                let gain = each[q][i];
                codes[i] = [byte(even[i] * gain), byte(odd[i] * gain)];
            }
            let out = self.rows[q][x..].first_chunk_mut::<PARTS>();
            *out.expect("a row has as many pixels as there are samples") = codes;
        }
    }

    /// The energy over whose root a response is taken. Silence over silence is silence.
    #[inline(always)]
    fn tells(&self, even: f32, odd: f32) -> f32 {
        (even * even + odd * odd + self.silent_energy).max(f32::MIN_POSITIVE)
    }
}

/// One row's work, compiled for one machine.
struct Compiled<'a, M, S>(NormalisedRow<'a>, M, S);

impl<M: Machine<PARTS>, S: Rough> NullaryFnOnce for Compiled<'_, M, S> {
    type Output = ();

    // Inlined into the function that is compiled for the vector unit; a call would leave it.
    #[inline(always)]
    fn call(self) {
        let Self(mut row, machine, simd) = self;
        let (squares, rest) = row.samples.as_chunks::<PARTS>();
        for (i, square) in squares.iter().enumerate() {
            row.code_square((machine, simd), i * PARTS, square);
        }
        for (i, sample) in rest.iter().enumerate() {
            for q in 0..COST_ORIENTATIONS {
                let (even, odd) = (sample[q], sample[COST_ORIENTATIONS + q]);
                let gain = row.full / row.tells(even, odd).sqrt();
                row.rows[q][squares.len() * PARTS + i] = [byte(even * gain), byte(odd * gain)];
            }
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
    fn take_in(
        &mut self,
        bank: &FilterBank,
        eye: &LumaImage,
        (silent_energy, full): (f32, f32),
        padding: Padding,
        rooms: &mut Vec<BankRows>,
    ) -> Result<(), WrongSize> {
        let size = bank.size();
        let stride = padding.stride(size.width);
        let of_row = COST_ORIENTATIONS * stride;
        self.stride = stride;
        self.parts.resize(size.height * of_row, [0; 2]);
        let (rooms, rows) = bands(rooms, size.height);
        let bands = self.parts.par_chunks_mut(rows * of_row).zip(rooms);
        bands.enumerate().try_for_each(|(band, (parts, room))| {
            for (y, parts) in (band * rows..).zip(parts.chunks_exact_mut(of_row)) {
                let samples = room.row(bank, eye, y)?.as_chunks().0;
                let own = padding.place(0)..padding.place(size.width);
                let mut each = parts.chunks_exact_mut(stride);
                let rows: [&mut [[u8; 2]]; COST_ORIENTATIONS] = std::array::from_fn(|_| {
                    let row: &mut [[u8; 2]] = each.next().unwrap_or_default();
                    row.get_mut(own.clone()).unwrap_or_default()
                });
                let row = NormalisedRow {
                    samples,
                    silent_energy,
                    full,
                    rows,
                };
                row.dispatch();
                for row in parts.chunks_exact_mut(stride) {
                    padding.replicate(row);
                }
            }
            Ok(())
        })
    }

    /// One row of each orientation, padded.
    #[inline(always)]
    fn rows(&self, y: usize) -> RowParts<'_> {
        let stride = self.stride;
        let rows = &self.parts[y * COST_ORIENTATIONS * stride..][..COST_ORIENTATIONS * stride];
        let (first, second) = rows.split_at(2 * stride);
        let ((a, b), (c, d)) = (first.split_at(stride), second.split_at(stride));
        [a, b, c, d]
    }

    /// Exchanges left and right.
    fn mirror(&mut self, padding: Padding) {
        self.parts
            .par_chunks_mut(self.stride)
            .for_each(|row| padding.mirror(row));
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;
    use num_complex::Complex;
    use proptest::prelude::*;
    use v1_gabor::{GaborParams, Size};

    use super::*;
    use crate::dense::wide::Plain;

    /// An eye's normalised responses, by orientation, of whole images and in double precision.
    fn normalised(
        bank: &FilterBank,
        eye: &LumaImage,
        silent: f32,
    ) -> impl Fn(usize, usize, usize) -> Complex<f64> {
        let responses = bank.respond(eye).unwrap();
        move |q, x, y| {
            let heard = responses.scales()[0].at(q, x, y);
            let heard = Complex::new(f64::from(heard.re), f64::from(heard.im));
            let silent = f64::from(silent).max(f64::MIN_POSITIVE);
            heard / (heard.norm_sqr() + silent).sqrt() / (COST_ORIENTATIONS as f64).sqrt()
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Costs in bytes are those of the equation, to one: parts and cost are rounded; with the eyes
        /// exchanged they are those of the mirrored pair.
        #[test]
        fn fast_and_plain_agree(
            width in 1usize..40, height in 1usize..5, least in -30i32..10, more in 0i32..40,
            unit in 5u8..=30, silence in 0usize..3, seed: u64,
        ) {
            let size = Size { width, height };
            let mut state = seed | 1;
            let mut see = || {
                LumaImage::new(Array2::from_shape_simple_fn(size.dim(), || {
                    state ^= state << 13;
                    state ^= state >> 7;
                    state ^= state << 17;
                    ((state >> 20) % 256) as f32 / 255.0
                }))
                .unwrap()
            };
            let (left, right) = (see(), see());
            let params =
                GaborParams { orientations: COST_ORIENTATIONS, scales: 1, ..GaborParams::default() };
            let bank = FilterBank::plan(params, size).unwrap();
            let search = SearchRange::new(least, least + more).unwrap();
            let silent = [0.0, 3e-7, 1e-3][silence];
            let eyes = Binocular { left: &left, right: &right };
            let mut cost = PhaseAgreement::default();
            cost.take_in(&bank, eyes, silent, (search, unit), &mut Vec::new()).unwrap();
            let own = normalised(&bank, &left, silent);
            let other = normalised(&bank, &right, silent);
            let mut costs = vec![0; search.shifts().next_multiple_of(LANES)];
            for changed in [false, true] {
                if changed {
                    cost.change_eyes();
                }
                for y in 0..height {
                    for x in 0..width {
                        cost.row(y).costs(Plain, x, 0, &mut costs);
                        for (dx, cost) in (least..=least + more).zip(&costs) {
                            let seen = (x as i32 + dx).clamp(0, width as i32 - 1) as usize;
                            let agreement: f64 = (0..COST_ORIENTATIONS)
                                .map(|q| match changed {
                                    false => own(q, x, y) * other(q, seen, y).conj(),
                                    true => {
                                        other(q, width - 1 - x, y) * own(q, width - 1 - seen, y).conj()
                                    }
                                })
                                .map(|product| product.re)
                                .sum();
                            let want = f64::from(unit) * (1.0 - agreement);
                            prop_assert!((f64::from(*cost) - want).abs() <= 1.0, "{cost}, {want}");
                        }
                    }
                }
            }
        }
    }
}
