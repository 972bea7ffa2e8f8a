use pulp::{Arch, NullaryFnOnce};

use crate::dense::pixel_cost::LANES;

/// Thirty-two bytes side by side, or as many words or pairs of bytes: what costs and paths are made
/// of, in the machine's own registers.
///
/// The compiler finds vectors in plain loops over arrays too, but keeps what a loop carries along in
/// memory; that is most of a path.
pub(crate) trait Wide: Copy {
    /// [`LANES`] bytes.
    type Bytes: Copy;
    /// [`LANES`] integers of 16 bits, or pairs of bytes.
    type Words: Copy;

    fn splat(self, value: u8) -> Self::Bytes;
    fn load(self, run: &[u8; LANES]) -> Self::Bytes;
    fn store(self, values: Self::Bytes, run: &mut [u8; LANES]);
    /// The sum, or 255 if that is more.
    fn add(self, a: Self::Bytes, b: Self::Bytes) -> Self::Bytes;
    /// The difference, or 0 if that is less.
    fn sub(self, a: Self::Bytes, b: Self::Bytes) -> Self::Bytes;
    fn min(self, a: Self::Bytes, b: Self::Bytes) -> Self::Bytes;
    /// `then` where `a < b`, `otherwise` elsewhere.
    fn if_less(
        self,
        a: Self::Bytes,
        b: Self::Bytes,
        then: Self::Bytes,
        otherwise: Self::Bytes,
    ) -> Self::Bytes;
    /// The bytes one place further on, the last of `before` in the first place.
    fn after(self, before: Self::Bytes, values: Self::Bytes) -> Self::Bytes;
    /// The bytes one place back, the first of `next` in the last place.
    fn ahead(self, values: Self::Bytes, next: Self::Bytes) -> Self::Bytes;
    /// The least of the bytes.
    fn least(self, values: Self::Bytes) -> u8;
    /// The first place that holds a value.
    fn first_equal(self, values: Self::Bytes, value: u8) -> Option<usize>;

    fn splat_word(self, value: i16) -> Self::Words;
    fn add_words(self, a: Self::Words, b: Self::Words) -> Self::Words;
    fn sub_words(self, a: Self::Words, b: Self::Words) -> Self::Words;
    fn load_pairs(self, run: &[[u8; 2]; LANES]) -> Self::Words;
    /// The same pair everywhere, its bytes less `bias`, with a sign.
    fn splat_pair(self, pair: [u8; 2], bias: u8) -> Self::Words;
    /// The sums of the products of pairs, bytes without a sign with bytes with one; they must fit in
    /// 16 bits.
    fn dot_pairs(self, pairs: Self::Words, with_sign: Self::Words) -> Self::Words;
    /// The upper 6 bits of words without sign.
    fn upper_6(self, words: Self::Words) -> Self::Bytes;
}

/// Any machine that the target is compiled for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain;

impl Wide for Plain {
    type Bytes = [u8; LANES];
    type Words = [i16; LANES];

    #[inline(always)]
    fn splat(self, value: u8) -> Self::Bytes {
        [value; LANES]
    }

    #[inline(always)]
    fn load(self, run: &[u8; LANES]) -> Self::Bytes {
        *run
    }

    #[inline(always)]
    fn store(self, values: Self::Bytes, run: &mut [u8; LANES]) {
        *run = values;
    }

    #[inline(always)]
    fn add(self, a: Self::Bytes, b: Self::Bytes) -> Self::Bytes {
        std::array::from_fn(|i| a[i].saturating_add(b[i]))
    }

    #[inline(always)]
    fn sub(self, a: Self::Bytes, b: Self::Bytes) -> Self::Bytes {
        std::array::from_fn(|i| a[i].saturating_sub(b[i]))
    }

    #[inline(always)]
    fn min(self, a: Self::Bytes, b: Self::Bytes) -> Self::Bytes {
        std::array::from_fn(|i| a[i].min(b[i]))
    }

    #[inline(always)]
    fn if_less(
        self,
        a: Self::Bytes,
        b: Self::Bytes,
        then: Self::Bytes,
        otherwise: Self::Bytes,
    ) -> Self::Bytes {
        std::array::from_fn(|i| if a[i] < b[i] { then[i] } else { otherwise[i] })
    }

    #[inline(always)]
    fn after(self, before: Self::Bytes, values: Self::Bytes) -> Self::Bytes {
        std::array::from_fn(|i| match i.checked_sub(1) {
            None => before[LANES - 1],
            Some(i) => values[i],
        })
    }

    #[inline(always)]
    fn ahead(self, values: Self::Bytes, next: Self::Bytes) -> Self::Bytes {
        std::array::from_fn(|i| values.get(i + 1).copied().unwrap_or(next[0]))
    }

    #[inline(always)]
    fn least(self, values: Self::Bytes) -> u8 {
        values.into_iter().fold(u8::MAX, u8::min)
    }

    #[inline(always)]
    fn first_equal(self, values: Self::Bytes, value: u8) -> Option<usize> {
        values.into_iter().position(|other| other == value)
    }

    #[inline(always)]
    fn splat_word(self, value: i16) -> Self::Words {
        [value; LANES]
    }

    #[inline(always)]
    fn add_words(self, a: Self::Words, b: Self::Words) -> Self::Words {
        std::array::from_fn(|i| a[i].wrapping_add(b[i]))
    }

    #[inline(always)]
    fn sub_words(self, a: Self::Words, b: Self::Words) -> Self::Words {
        std::array::from_fn(|i| a[i].wrapping_sub(b[i]))
    }

    #[inline(always)]
    fn load_pairs(self, run: &[[u8; 2]; LANES]) -> Self::Words {
        run.map(i16::from_le_bytes)
    }

    #[inline(always)]
    fn splat_pair(self, pair: [u8; 2], bias: u8) -> Self::Words {
        [i16::from_le_bytes(pair.map(|part| part.wrapping_sub(bias))); LANES]
    }

    #[inline(always)]
    fn dot_pairs(self, pairs: Self::Words, with_sign: Self::Words) -> Self::Words {
        let product = |byte: u8, with: u8| i16::from(byte) * i16::from(with.cast_signed());
        std::array::from_fn(|i| {
            let ([a, b], [c, d]) = (pairs[i].to_le_bytes(), with_sign[i].to_le_bytes());
            product(a, c) + product(b, d)
        })
    }

    #[inline(always)]
    fn upper_6(self, words: Self::Words) -> Self::Bytes {
        words.map(|word| (word.cast_unsigned() >> 10) as u8)
    }
}

#[cfg(target_arch = "x86_64")]
impl Wide for pulp::x86::V3 {
    type Bytes = core::arch::x86_64::__m256i;
    /// Two halves.
    type Words = [core::arch::x86_64::__m256i; 2];

    #[inline(always)]
    fn splat(self, value: u8) -> Self::Bytes {
        self.avx._mm256_set1_epi8(value.cast_signed())
    }

    #[inline(always)]
    fn load(self, run: &[u8; LANES]) -> Self::Bytes {
        pulp::cast(*run)
    }

    #[inline(always)]
    fn store(self, values: Self::Bytes, run: &mut [u8; LANES]) {
        *run = pulp::cast(values);
    }

    #[inline(always)]
    fn add(self, a: Self::Bytes, b: Self::Bytes) -> Self::Bytes {
        self.avx2._mm256_adds_epu8(a, b)
    }

    #[inline(always)]
    fn sub(self, a: Self::Bytes, b: Self::Bytes) -> Self::Bytes {
        self.avx2._mm256_subs_epu8(a, b)
    }

    #[inline(always)]
    fn min(self, a: Self::Bytes, b: Self::Bytes) -> Self::Bytes {
        self.avx2._mm256_min_epu8(a, b)
    }

    #[inline(always)]
    fn if_less(
        self,
        a: Self::Bytes,
        b: Self::Bytes,
        then: Self::Bytes,
        otherwise: Self::Bytes,
    ) -> Self::Bytes {
        // The machine compares bytes with a sign only.
        let not_less = self.avx2._mm256_cmpeq_epi8(self.min(a, b), b);
        self.avx2._mm256_blendv_epi8(then, otherwise, not_less)
    }

    #[inline(always)]
    fn after(self, before: Self::Bytes, values: Self::Bytes) -> Self::Bytes {
        let halves = self.avx2._mm256_permute2x128_si256::<0x21>(before, values);
        self.avx2._mm256_alignr_epi8::<15>(values, halves)
    }

    #[inline(always)]
    fn ahead(self, values: Self::Bytes, next: Self::Bytes) -> Self::Bytes {
        let halves = self.avx2._mm256_permute2x128_si256::<0x21>(values, next);
        self.avx2._mm256_alignr_epi8::<1>(halves, values)
    }

    #[inline(always)]
    fn least(self, values: Self::Bytes) -> u8 {
        let low = self.avx._mm256_castsi256_si128(values);
        let high = self.avx2._mm256_extracti128_si256::<1>(values);
        let halves = self.sse2._mm_min_epu8(low, high);
        // The lesser of each two bytes, as a word.
        let odd = self.sse2._mm_srli_epi16::<8>(halves);
        let words = self.sse2._mm_min_epu8(halves, odd);
        let least = self.sse4_1._mm_minpos_epu16(words);
        self.sse2._mm_cvtsi128_si32(least) as u8
    }

    #[inline(always)]
    fn first_equal(self, values: Self::Bytes, value: u8) -> Option<usize> {
        let same = self.avx2._mm256_cmpeq_epi8(values, self.splat(value));
        let bits = self.avx2._mm256_movemask_epi8(same);
        (bits != 0).then(|| bits.trailing_zeros() as usize)
    }

    #[inline(always)]
    fn splat_word(self, value: i16) -> Self::Words {
        [self.avx._mm256_set1_epi16(value); 2]
    }

    #[inline(always)]
    fn add_words(self, a: Self::Words, b: Self::Words) -> Self::Words {
        let ([a, b], [c, d]) = (a, b);
        [
            self.avx2._mm256_add_epi16(a, c),
            self.avx2._mm256_add_epi16(b, d),
        ]
    }

    #[inline(always)]
    fn sub_words(self, a: Self::Words, b: Self::Words) -> Self::Words {
        let ([a, b], [c, d]) = (a, b);
        [
            self.avx2._mm256_sub_epi16(a, c),
            self.avx2._mm256_sub_epi16(b, d),
        ]
    }

    #[inline(always)]
    fn load_pairs(self, run: &[[u8; 2]; LANES]) -> Self::Words {
        pulp::cast(*run)
    }

    #[inline(always)]
    fn splat_pair(self, pair: [u8; 2], bias: u8) -> Self::Words {
        let same = self.avx._mm256_set1_epi16(i16::from_le_bytes(pair));
        [self.avx2._mm256_sub_epi8(same, self.splat(bias)); 2]
    }

    #[inline(always)]
    fn dot_pairs(self, pairs: Self::Words, with_sign: Self::Words) -> Self::Words {
        let ([a, b], [c, d]) = (pairs, with_sign);
        [
            self.avx2._mm256_maddubs_epi16(a, c),
            self.avx2._mm256_maddubs_epi16(b, d),
        ]
    }

    #[inline(always)]
    fn upper_6(self, words: Self::Words) -> Self::Bytes {
        let [first, second] = words;
        let first = self.avx2._mm256_srli_epi16::<10>(first);
        let second = self.avx2._mm256_srli_epi16::<10>(second);
        let packed = self.avx2._mm256_packus_epi16(first, second);
        // Each half has packed its own eight of both.
        self.avx2._mm256_permute4x64_epi64::<0b11_01_10_00>(packed)
    }
}

/// The same bytes, compared into masks, and words in one register.
#[cfg(target_arch = "x86_64")]
impl Wide for pulp::x86::V4 {
    type Bytes = core::arch::x86_64::__m256i;
    type Words = core::arch::x86_64::__m512i;

    #[inline(always)]
    fn splat(self, value: u8) -> Self::Bytes {
        Wide::splat(*self, value)
    }

    #[inline(always)]
    fn load(self, run: &[u8; LANES]) -> Self::Bytes {
        Wide::load(*self, run)
    }

    #[inline(always)]
    fn store(self, values: Self::Bytes, run: &mut [u8; LANES]) {
        Wide::store(*self, values, run);
    }

    #[inline(always)]
    fn add(self, a: Self::Bytes, b: Self::Bytes) -> Self::Bytes {
        Wide::add(*self, a, b)
    }

    #[inline(always)]
    fn sub(self, a: Self::Bytes, b: Self::Bytes) -> Self::Bytes {
        Wide::sub(*self, a, b)
    }

    #[inline(always)]
    fn min(self, a: Self::Bytes, b: Self::Bytes) -> Self::Bytes {
        Wide::min(*self, a, b)
    }

    #[inline(always)]
    fn if_less(
        self,
        a: Self::Bytes,
        b: Self::Bytes,
        then: Self::Bytes,
        otherwise: Self::Bytes,
    ) -> Self::Bytes {
        let less = self.avx512bw._mm256_cmplt_epu8_mask(a, b);
        self.avx512bw._mm256_mask_blend_epi8(less, otherwise, then)
    }

    #[inline(always)]
    fn after(self, before: Self::Bytes, values: Self::Bytes) -> Self::Bytes {
        Wide::after(*self, before, values)
    }

    #[inline(always)]
    fn ahead(self, values: Self::Bytes, next: Self::Bytes) -> Self::Bytes {
        Wide::ahead(*self, values, next)
    }

    #[inline(always)]
    fn least(self, values: Self::Bytes) -> u8 {
        Wide::least(*self, values)
    }

    #[inline(always)]
    fn first_equal(self, values: Self::Bytes, value: u8) -> Option<usize> {
        let same = self
            .avx512bw
            ._mm256_cmpeq_epi8_mask(values, self.splat(value));
        (same != 0).then(|| same.trailing_zeros() as usize)
    }

    #[inline(always)]
    fn splat_word(self, value: i16) -> Self::Words {
        self.avx512f._mm512_set1_epi16(value)
    }

    #[inline(always)]
    fn add_words(self, a: Self::Words, b: Self::Words) -> Self::Words {
        self.avx512bw._mm512_add_epi16(a, b)
    }

    #[inline(always)]
    fn sub_words(self, a: Self::Words, b: Self::Words) -> Self::Words {
        self.avx512bw._mm512_sub_epi16(a, b)
    }

    #[inline(always)]
    fn load_pairs(self, run: &[[u8; 2]; LANES]) -> Self::Words {
        pulp::cast(*run)
    }

    #[inline(always)]
    fn splat_pair(self, pair: [u8; 2], bias: u8) -> Self::Words {
        let same = self.splat_word(i16::from_le_bytes(pair));
        let bias = self.avx512f._mm512_set1_epi8(bias.cast_signed());
        self.avx512bw._mm512_sub_epi8(same, bias)
    }

    #[inline(always)]
    fn dot_pairs(self, pairs: Self::Words, with_sign: Self::Words) -> Self::Words {
        self.avx512bw._mm512_maddubs_epi16(pairs, with_sign)
    }

    #[inline(always)]
    fn upper_6(self, words: Self::Words) -> Self::Bytes {
        let upper = self.avx512bw._mm512_srli_epi16::<10>(words);
        self.avx512bw._mm512_cvtepi16_epi8(upper)
    }
}

/// Work that is compiled for each width.
pub(crate) trait WideWork {
    fn work<W: Wide>(self, wide: W);
}

/// Does the work in the machine's widest registers.
pub(crate) fn widest(work: impl WideWork) {
    match Arch::new() {
        #[cfg(target_arch = "x86_64")]
        Arch::V3(v3) => v3.vectorize(Compiled(work, v3)),
        #[cfg(target_arch = "x86_64")]
        Arch::V4(v4) => v4.vectorize(Compiled(work, v4)),
        _ => Compiled(work, Plain).call(),
    }
}

struct Compiled<T, W>(T, W);

impl<T: WideWork, W: Wide> NullaryFnOnce for Compiled<T, W> {
    type Output = ();

    // Inlined into the function that is compiled for the vector unit; a call would leave it.
    #[inline(always)]
    fn call(self) {
        self.0.work(self.1);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Everything that a width can do, as plain arrays.
    fn all<W: Wide>(wide: W, a: [u8; LANES], b: [u8; LANES], pair: [u8; 2]) -> Vec<u8> {
        let (va, vb) = (wide.load(&a), wide.load(&b));
        let place = |value| wide.first_equal(va, value).map_or(99, |place| place as u8);
        let mut said = vec![wide.least(va), place(a[5]), place(100)];
        let pairs = wide.load_pairs(&std::array::from_fn(|i| [a[i], a[LANES - 1 - i]]));
        let product = wide.dot_pairs(pairs, wide.splat_pair(pair, 90));
        let words = wide.sub_words(wide.splat_word(999), wide.add_words(product, product));
        let runs = [
            wide.splat(a[3]),
            wide.add(va, vb),
            wide.sub(va, vb),
            wide.min(va, vb),
            wide.after(va, vb),
            wide.ahead(va, vb),
            wide.if_less(va, vb, wide.splat(1), wide.splat(2)),
            wide.upper_6(words),
            wide.upper_6(product),
        ];
        for run in runs {
            let mut out = [0; LANES];
            wide.store(run, &mut out);
            said.extend(out);
        }
        said
    }

    proptest! {
        #[test]
        fn every_width_says_the_same(
            a in prop::array::uniform32(0u8..180), b in prop::array::uniform32(0u8..),
            pair in prop::array::uniform2(0u8..180),
        ) {
            struct Check([u8; LANES], [u8; LANES], [u8; 2]);
            impl WideWork for Check {
                fn work<W: Wide>(self, wide: W) {
                    let Self(a, b, pair) = self;
                    assert_eq!(all(wide, a, b, pair), all(Plain, a, b, pair));
                }
            }
            widest(Check(a, b, pair));
            #[cfg(target_arch = "x86_64")]
            if let Some(v3) = pulp::x86::V3::try_new() {
                v3.vectorize(Compiled(Check(a, b, pair), v3));
            }
        }
    }
}
