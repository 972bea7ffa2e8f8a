use pulp::{Arch, NullaryFnOnce, Scalar, Simd};
use rayon::prelude::*;
use v1_gabor::{Binocular, FilterBank, LumaImage, WrongSize};

use crate::SearchRange;
use crate::dense::bands::bands;
use crate::dense::bank_rows::BankRows;
use crate::dense::nearest::ROUNDER;
use crate::dense::padding::Padding;
use crate::dense::pixel_cost::{LANES, PixelCost, RowCost};
use crate::dense::wide::Wide;
use crate::rough::Rough;
use crate::vector::vector;

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
    /// The even parts of each orientation along the row, then the odd ones.
    samples: &'a [f32],
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
            Arch::V4(v4) => v4.vectorize(Compiled(self, v4)),
            #[cfg(target_arch = "x86_64")]
            Arch::V3(v3) => v3.vectorize(Compiled(self, v3)),
            _ => Compiled(self, Scalar).call(),
        }
    }

    #[inline(always)]
    fn walk<S: Rough>(self, simd: S) {
        let width = self.samples.len() / PARTS;
        let (even, odd) = self.samples.split_at(COST_ORIENTATIONS * width);
        let gain = Gain {
            silent: simd.splat_f32s(self.silent_energy),
            full: simd.splat_f32s(self.full),
        };
        for (q, codes) in self.rows.into_iter().enumerate() {
            let (even, odd) = (&even[q * width..][..width], &odd[q * width..][..width]);
            let codes = &mut codes[..width];
            let whole = width - width % S::F32_LANES;
            for x in (0..whole).step_by(S::F32_LANES) {
                let words = gain.words(simd, vector(simd, even, x), vector(simd, odd, x));
                spell(simd, words, &mut codes[x..x + S::F32_LANES]);
            }
            // The row ends within the lanes.
            let (mut last_even, mut last_odd) = ([0.0; MOST_LANES], [0.0; MOST_LANES]);
            last_even[..width - whole].copy_from_slice(&even[whole..]);
            last_odd[..width - whole].copy_from_slice(&odd[whole..]);
            let (even, odd) = (vector(simd, &last_even, 0), vector(simd, &last_odd, 0));
            spell(simd, gain.words(simd, even, odd), &mut codes[whole..]);
        }
    }
}

/// At least the lanes of the widest vector there is.
const MOST_LANES: usize = 16;

/// Brings responses to the modulus of a full one, and those near silence to less.
struct Gain<S: Simd> {
    silent: S::f32s,
    full: S::f32s,
}

impl<S: Rough> Gain<S> {
    /// Responses in units of codes, the even part in the lower bytes, the odd one in those above them.
    #[inline(always)]
    fn words(&self, simd: S, even: S::f32s, odd: S::f32s) -> S::u32s {
        let energy = simd.mul_add_e_f32s(odd, odd, self.silent);
        let energy = simd.mul_add_e_f32s(even, even, energy);
        // Silence over silence is silence.
        let energy = simd.max_f32s(energy, simd.splat_f32s(f32::MIN_POSITIVE));
        let gain = simd.mul_f32s(self.full, simd.rough_inverse_root(energy));
        // The nearest integer to a small number, and the bias more, is left in the lower bits.
        let rounder = simd.splat_f32s(ROUNDER + f32::from(BIAS));
        let even = simd.transmute_u32s_f32s(simd.mul_add_e_f32s(even, gain, rounder));
        let odd = simd.mul_add_e_f32s(odd, gain, rounder);
        let odd = simd.wrapping_dyn_shl_u32s(simd.transmute_u32s_f32s(odd), simd.splat_u32s(8));
        simd.add_u32s(even, odd)
    }
}

/// Writes the lower two bytes of as many words as there is room for.
#[inline(always)]
fn spell<S: Simd>(_: S, words: S::u32s, codes: &mut [[u8; 2]]) {
    let mut each = [0; MOST_LANES];
    S::as_mut_simd_u32s(&mut each).0[0] = words;
    for i in 0..codes.len().min(MOST_LANES) {
        codes[i] = (each[i] as u16).to_le_bytes();
    }
}

/// One row's work, compiled for one machine.
struct Compiled<'a, S>(NormalisedRow<'a>, S);

impl<S: Rough> NullaryFnOnce for Compiled<'_, S> {
    type Output = ();

    // Inlined into the function that is compiled for the vector unit; a call would leave it.
    #[inline(always)]
    fn call(self) {
        let Self(row, simd) = self;
        row.walk(simd);
    }
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
                let samples = room.parts(bank, eye, y)?;
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
