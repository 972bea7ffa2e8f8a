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
/// nearly pure phase: a gain or an offset between the cameras drops out. Where the eyes have an
/// [opponent](crate::dense::opponent) colour too, its responses `O_q` are heard beside those of luma, in each
/// channel as loud as they are: `u_q = (Q_q, P_q) / sqrt(|Q_q|^2 + |P_q|^2 + eps) / sqrt K` with
/// `P_q = w O_q |w O_q|^2 / (|w O_q|^2 + eps_o)`, so that the noise of colours says little. No angle is computed; the
/// real part of the product is the cosine of the phase difference. Parts are bytes; thirty-two shifts
/// are compared side by side, and 16-bit integers hold the sums of their products exactly.
#[derive(Clone, Debug, Default)]
pub(crate) struct PhaseAgreement {
    eyes: Binocular<NormalisedResponses>,
    padding: Padding,
    /// The largest sum of products that two pixels can have.
    most: i16,
}

/// What one eye sees: the luma, and an opponent colour if that is compared too.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen<'a> {
    pub(crate) luma: &'a LumaImage,
    pub(crate) opponent: Option<&'a LumaImage>,
}

impl<'a> Seen<'a> {
    /// Luma alone.
    #[cfg(test)]
    pub(crate) const fn luma(luma: &'a LumaImage) -> Self {
        Self {
            luma,
            opponent: None,
        }
    }
}

/// How loud responses are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Loudness {
    /// The energy at which a response to luma counts half (`eps`).
    pub(crate) silent_energy: f32,
    /// How much a response to the opponent colour counts against one to luma (`w`), and the energy, counted
    /// so, at which it counts half of that (`eps_o`).
    pub(crate) opponent: f32,
    pub(crate) opponent_silent_energy: f32,
}

/// Rooms for the responses to luma and to an opponent colour.
pub(crate) type PictureRows = [BankRows; 2];

/// Normalised responses `[[y, picture, orientation, padded x, part]]`, in units of 1 / (2 sqrt(256 unit)),
/// and [`BIAS`] more.
#[derive(Clone, Debug, Default)]
struct NormalisedResponses {
    stride: usize,
    /// Luma, or luma and an opponent colour.
    pictures: usize,
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
        eyes: Binocular<Seen<'_>>,
        loudness: Loudness,
        (search, unit): (SearchRange, u8),
        rooms: &mut Vec<PictureRows>,
    ) -> Result<(), WrongSize> {
        self.padding = Padding::of(search);
        // The sum over the orientations of the products of full responses is a unit, cut off.
        let full = (f32::from(unit) * CUT / COST_ORIENTATIONS as f32).sqrt();
        // One eye's opponent colour has nothing to be compared with.
        let both = eyes.left.opponent.is_some() && eyes.right.opponent.is_some();
        let pictures = 1 + usize::from(both);
        // Rounding lengthens a pixel's vector of parts by at most half of the root of their number.
        let longest =
            (COST_ORIENTATIONS as f32).sqrt() * full + 0.5 * ((pictures * PARTS) as f32).sqrt();
        self.most = (longest * longest).ceil() as i16;
        let Binocular { left, right } = &mut self.eyes;
        for (responses, eye) in [(left, eyes.left), (right, eyes.right)] {
            let opponent = eye.opponent.filter(|_| both);
            let eye = Seen { opponent, ..eye };
            responses.take_in(bank, eye, (loudness, full), self.padding, rooms)?;
        }
        Ok(())
    }
}

impl PixelCost for PhaseAgreement {
    type Row<'a> = AgreementRow<'a>;

    #[inline(always)]
    fn row(&self, y: usize) -> AgreementRow<'_> {
        AgreementRow {
            left: self.eyes.left.rows(y, 0),
            right: self.eyes.right.rows(y, 0),
            opponents: (self.eyes.left.pictures > 1).then(|| Binocular {
                left: self.eyes.left.rows(y, 1),
                right: self.eyes.right.rows(y, 1),
            }),
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
    /// The same of the opponent colour.
    opponents: Option<Binocular<RowParts<'a>>>,
    pub(crate) padding: Padding,
    most: i16,
}

impl RowCost for AgreementRow<'_> {
    #[inline(always)]
    fn costs<W: Wide>(self, wide: W, x: usize, first: usize, costs: &mut [u8]) {
        let place = self.padding.place(x);
        let first = self.padding.first(x) + first;
        let run = first..first + costs.len();
        let left = Left::of(wide, pixel(self.left, place), self.most);
        let [a, b, c, d] = runs(self.right, &run);
        let costs = costs.as_chunks_mut::<LANES>().0;
        let Some(opponents) = self.opponents else {
            let runs = a.iter().zip(b).zip(c.iter().zip(d));
            for (costs, ((a, b), (c, d))) in costs.iter_mut().zip(runs) {
                let cost = left.disagreement(wide, [a, b, c, d]);
                wide.store(wide.upper_6(cost), costs);
            }
            return;
        };
        // The largest disagreement is that of both together.
        let opponent = Left::of(wide, pixel(opponents.left, place), 0);
        let others = runs(opponents.right, &run);
        for (i, costs) in costs.iter_mut().enumerate() {
            let of_luma = left.disagreement(wide, [&a[i], &b[i], &c[i], &d[i]]);
            let [a, b, c, d] = others;
            let of_colour = opponent.disagreement(wide, [&a[i], &b[i], &c[i], &d[i]]);
            wide.store(wide.upper_6(wide.add_words(of_luma, of_colour)), costs);
        }
    }
}

/// The parts of one pixel, by orientation.
#[inline(always)]
fn pixel([a, b, c, d]: RowParts<'_>, place: usize) -> [[u8; 2]; COST_ORIENTATIONS] {
    [a[place], b[place], c[place], d[place]]
}

/// A run of a row, by orientation.
#[inline(always)]
fn runs<'a>(
    [a, b, c, d]: RowParts<'a>,
    run: &std::ops::Range<usize>,
) -> [&'a [[[u8; 2]; LANES]]; COST_ORIENTATIONS] {
    [
        blocks(a, run),
        blocks(b, run),
        blocks(c, run),
        blocks(d, run),
    ]
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
    luma: &'a [f32],
    opponent: Option<&'a [f32]>,
    loudness: Loudness,
    /// The modulus of a full response.
    full: f32,
    /// Luma's, then the opponent colour's if there is one.
    rows: [&'a mut [[u8; 2]]; PARTS],
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
    fn walk<S: Rough>(mut self, simd: S) {
        let width = self.luma.len() / PARTS;
        let gain = Gain {
            silent: simd.splat_f32s(self.loudness.silent_energy),
            full: simd.splat_f32s(self.full),
            opponent: simd.splat_f32s(self.loudness.opponent),
            opponent_silent: simd.splat_f32s(self.loudness.opponent_silent_energy),
        };
        let (luma_rows, opponent_rows) = self.rows.split_at_mut(COST_ORIENTATIONS);
        for (q, codes) in luma_rows.iter_mut().enumerate() {
            let (even, odd) = orientation(self.luma, q, width);
            let codes = &mut codes[..width];
            for x in (0..width).step_by(S::F32_LANES) {
                let end = (x + S::F32_LANES).min(width);
                let heard = (some(simd, even, x), some(simd, odd, x));
                let Some(opponent) = self.opponent else {
                    let gains = gain.alone(simd, heard);
                    spell(simd, words(simd, heard, gains), &mut codes[x..end]);
                    continue;
                };
                let (even, odd) = orientation(opponent, q, width);
                let opponent = (some(simd, even, x), some(simd, odd, x));
                let (opponent, gains) = gain.beside(simd, heard, opponent);
                spell(simd, words(simd, heard, gains), &mut codes[x..end]);
                let codes = &mut opponent_rows[q][x..end];
                spell(simd, words(simd, opponent, gains), codes);
            }
        }
    }
}

/// The even and the odd part of an orientation along a row.
#[inline(always)]
fn orientation(samples: &[f32], q: usize, width: usize) -> (&[f32], &[f32]) {
    let odd = COST_ORIENTATIONS + q;
    (
        &samples[q * width..][..width],
        &samples[odd * width..][..width],
    )
}

/// As many numbers as a vector holds, from a place on, and nothing where the row ends before.
#[inline(always)]
fn some<S: Simd>(simd: S, numbers: &[f32], start: usize) -> S::f32s {
    if start + S::F32_LANES <= numbers.len() {
        return vector(simd, numbers, start);
    }
    let mut last = [0.0; MOST_LANES];
    let rest = &numbers[start..];
    last[..rest.len()].copy_from_slice(rest);
    vector(simd, &last, 0)
}

/// At least the lanes of the widest vector there is.
const MOST_LANES: usize = 16;

/// Brings responses to the modulus of a full one, and those near silence to less.
struct Gain<S: Simd> {
    silent: S::f32s,
    full: S::f32s,
    opponent: S::f32s,
    opponent_silent: S::f32s,
}

impl<S: Rough> Gain<S> {
    /// That of responses to luma.
    #[inline(always)]
    fn alone(&self, simd: S, (even, odd): (S::f32s, S::f32s)) -> S::f32s {
        let energy = simd.mul_add_e_f32s(odd, odd, self.silent);
        self.over(simd, simd.mul_add_e_f32s(even, even, energy))
    }

    /// What is heard of an opponent colour, and the gain of both.
    #[inline(always)]
    fn beside(
        &self,
        simd: S,
        (even, odd): (S::f32s, S::f32s),
        (opponent_even, opponent_odd): (S::f32s, S::f32s),
    ) -> ((S::f32s, S::f32s), S::f32s) {
        let tiny = simd.splat_f32s(f32::MIN_POSITIVE);
        let (even_o, odd_o) = (
            simd.mul_f32s(self.opponent, opponent_even),
            simd.mul_f32s(self.opponent, opponent_odd),
        );
        let energy = simd.mul_add_e_f32s(odd_o, odd_o, simd.mul_f32s(even_o, even_o));
        let with_silence = simd.max_f32s(simd.add_f32s(energy, self.opponent_silent), tiny);
        let share = simd.quotient(energy, with_silence);
        let (even_o, odd_o) = (simd.mul_f32s(even_o, share), simd.mul_f32s(odd_o, share));
        let energy = simd.mul_add_e_f32s(odd, odd, self.silent);
        let energy = simd.mul_add_e_f32s(even, even, energy);
        let energy = simd.mul_add_e_f32s(even_o, even_o, energy);
        let energy = simd.mul_add_e_f32s(odd_o, odd_o, energy);
        ((even_o, odd_o), self.over(simd, energy))
    }

    /// One over the root of an energy, in units of codes. Silence over silence is silence.
    #[inline(always)]
    fn over(&self, simd: S, energy: S::f32s) -> S::f32s {
        let energy = simd.max_f32s(energy, simd.splat_f32s(f32::MIN_POSITIVE));
        simd.mul_f32s(self.full, simd.rough_inverse_root(energy))
    }
}

/// Responses in units of codes, the even part in the lower bytes, the odd one in those above them.
#[inline(always)]
fn words<S: Simd>(simd: S, (even, odd): (S::f32s, S::f32s), gain: S::f32s) -> S::u32s {
    // The nearest integer to a small number, and the bias more, is left in the lower bits.
    let rounder = simd.splat_f32s(ROUNDER + f32::from(BIAS));
    let even = simd.transmute_u32s_f32s(simd.mul_add_e_f32s(even, gain, rounder));
    let odd = simd.transmute_u32s_f32s(simd.mul_add_e_f32s(odd, gain, rounder));
    simd.add_u32s(even, simd.wrapping_dyn_shl_u32s(odd, simd.splat_u32s(8)))
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
        eye: Seen<'_>,
        (loudness, full): (Loudness, f32),
        padding: Padding,
        rooms: &mut Vec<PictureRows>,
    ) -> Result<(), WrongSize> {
        let size = bank.size();
        let stride = padding.stride(size.width);
        self.stride = stride;
        self.pictures = 1 + usize::from(eye.opponent.is_some());
        let of_row = self.pictures * COST_ORIENTATIONS * stride;
        self.parts.resize(size.height * of_row, [0; 2]);
        let (rooms, rows) = bands(rooms, size.height);
        let bands = self.parts.par_chunks_mut(rows * of_row).zip(rooms);
        bands.enumerate().try_for_each(|(band, (parts, room))| {
            let [luma_room, opponent_room] = room;
            for (y, parts) in (band * rows..).zip(parts.chunks_exact_mut(of_row)) {
                let luma = luma_room.parts(bank, eye.luma, y)?;
                let opponent = match eye.opponent {
                    Some(opponent) => Some(opponent_room.parts(bank, opponent, y)?),
                    None => None,
                };
                let own = padding.place(0)..padding.place(size.width);
                let mut each = parts.chunks_exact_mut(stride);
                let rows: [&mut [[u8; 2]]; PARTS] = std::array::from_fn(|_| {
                    let row: &mut [[u8; 2]] = each.next().unwrap_or_default();
                    row.get_mut(own.clone()).unwrap_or_default()
                });
                let row = NormalisedRow {
                    luma,
                    opponent,
                    loudness,
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

    /// One row of each orientation of a picture, padded.
    #[inline(always)]
    fn rows(&self, y: usize, picture: usize) -> RowParts<'_> {
        let stride = self.stride;
        let of_picture = COST_ORIENTATIONS * stride;
        let rows = &self.parts[(y * self.pictures + picture) * of_picture..][..of_picture];
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
    use v1_gabor::{GaborParams, Size, V1Responses};

    use super::*;
    use crate::dense::wide::Plain;

    /// An eye's normalised responses to luma and to an opponent colour, by orientation, of whole images and in
    /// double precision.
    fn normalised(
        bank: &FilterBank,
        eye: Seen<'_>,
        loudness: Loudness,
    ) -> impl Fn(usize, usize, usize) -> [Complex<f64>; 2] {
        let luma = bank.respond(eye.luma).unwrap();
        let opponent = eye.opponent.map(|opponent| bank.respond(opponent).unwrap());
        move |q, x, y| {
            let at = |responses: &V1Responses| {
                let heard = responses.scales()[0].at(q, x, y);
                Complex::new(f64::from(heard.re), f64::from(heard.im))
            };
            let luma = at(&luma);
            let weighed =
                opponent.as_ref().map_or(Complex::ZERO, at) * f64::from(loudness.opponent);
            let silent = f64::from(loudness.opponent_silent_energy);
            let energy = weighed.norm_sqr();
            let opponent = weighed * (energy / (energy + silent).max(f64::MIN_POSITIVE));
            let silent = f64::from(loudness.silent_energy).max(f64::MIN_POSITIVE);
            let energy = luma.norm_sqr() + opponent.norm_sqr() + silent;
            let gain = 1.0 / energy.sqrt() / (COST_ORIENTATIONS as f64).sqrt();
            [luma * gain, opponent * gain]
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Costs in bytes are those of the equation, to one: parts and cost are rounded; with the eyes
        /// exchanged they are those of the mirrored pair.
        #[test]
        fn fast_and_plain_agree(
            width in 1usize..40, height in 1usize..5, least in -30i32..10, more in 0i32..40,
            unit in 5u8..=30, silence in 0usize..3, colours: bool, seed: u64,
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
            let pictures = [see(), see(), see(), see()];
            let [left, right, left_opponent, right_opponent] = &pictures;
            let params =
                GaborParams { orientations: COST_ORIENTATIONS, scales: 1, ..GaborParams::default() };
            let bank = FilterBank::plan(params, size).unwrap();
            let search = SearchRange::new(least, least + more).unwrap();
            let loudness = Loudness {
                silent_energy: [0.0, 3e-7, 1e-3][silence],
                opponent: 1.5,
                opponent_silent_energy: [1e-3, 0.0, 1e-4][silence],
            };
            let eyes = Binocular {
                left: Seen { luma: left, opponent: colours.then_some(left_opponent) },
                right: Seen { luma: right, opponent: colours.then_some(right_opponent) },
            };
            let mut cost = PhaseAgreement::default();
            cost.take_in(&bank, eyes, loudness, (search, unit), &mut Vec::new()).unwrap();
            let own = normalised(&bank, eyes.left, loudness);
            let other = normalised(&bank, eyes.right, loudness);
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
                                    false => (own(q, x, y), other(q, seen, y)),
                                    true => (other(q, width - 1 - x, y), own(q, width - 1 - seen, y)),
                                })
                                .map(|(a, b)| (a[0] * b[0].conj() + a[1] * b[1].conj()).re)
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
