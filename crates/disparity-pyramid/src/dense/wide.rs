use pulp::{Arch, NullaryFnOnce};

use crate::dense::pixel_cost::LANES;

/// Sixteen 16-bit integers side by side: what the paths are made of, in the machine's own registers.
///
/// The compiler finds vectors in plain loops over arrays too, but keeps what a loop carries along in
/// memory; that is most of a path.
pub(crate) trait Wide: Copy {
    /// Sixteen integers.
    type Run: Copy;

    fn splat(self, value: i16) -> Self::Run;
    fn load(self, run: &[i16; LANES]) -> Self::Run;
    fn load_bytes(self, run: &[u8; LANES]) -> Self::Run;
    fn store(self, values: Self::Run, run: &mut [i16; LANES]);
    fn add(self, a: Self::Run, b: Self::Run) -> Self::Run;
    fn sub(self, a: Self::Run, b: Self::Run) -> Self::Run;
    fn mul(self, a: Self::Run, b: Self::Run) -> Self::Run;
    fn min(self, a: Self::Run, b: Self::Run) -> Self::Run;
    /// Stores the upper 7 bits of sixteen integers from 0 to 2^16 - 1.
    fn store_upper_7(self, values: Self::Run, run: &mut [u8; LANES]);
    /// `then` where `a < b`, `otherwise` elsewhere.
    fn if_less(
        self,
        a: Self::Run,
        b: Self::Run,
        then: Self::Run,
        otherwise: Self::Run,
    ) -> Self::Run;
    /// The least of sixteen integers that are not negative.
    fn least(self, values: Self::Run) -> i16;
    /// The first of sixteen places that holds a value.
    fn first_equal(self, values: Self::Run, value: i16) -> Option<usize>;
}

/// Any machine that the target is compiled for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain;

impl Wide for Plain {
    type Run = [i16; LANES];

    #[inline(always)]
    fn splat(self, value: i16) -> Self::Run {
        [value; LANES]
    }

    #[inline(always)]
    fn load(self, run: &[i16; LANES]) -> Self::Run {
        *run
    }

    #[inline(always)]
    fn load_bytes(self, run: &[u8; LANES]) -> Self::Run {
        run.map(i16::from)
    }

    #[inline(always)]
    fn store(self, values: Self::Run, run: &mut [i16; LANES]) {
        *run = values;
    }

    #[inline(always)]
    fn add(self, a: Self::Run, b: Self::Run) -> Self::Run {
        std::array::from_fn(|i| a[i].wrapping_add(b[i]))
    }

    #[inline(always)]
    fn sub(self, a: Self::Run, b: Self::Run) -> Self::Run {
        std::array::from_fn(|i| a[i].wrapping_sub(b[i]))
    }

    #[inline(always)]
    fn mul(self, a: Self::Run, b: Self::Run) -> Self::Run {
        std::array::from_fn(|i| a[i].wrapping_mul(b[i]))
    }

    #[inline(always)]
    fn store_upper_7(self, values: Self::Run, run: &mut [u8; LANES]) {
        *run = values.map(|value| (value as u16 >> 9) as u8);
    }

    #[inline(always)]
    fn min(self, a: Self::Run, b: Self::Run) -> Self::Run {
        std::array::from_fn(|i| a[i].min(b[i]))
    }

    #[inline(always)]
    fn if_less(
        self,
        a: Self::Run,
        b: Self::Run,
        then: Self::Run,
        otherwise: Self::Run,
    ) -> Self::Run {
        std::array::from_fn(|i| if a[i] < b[i] { then[i] } else { otherwise[i] })
    }

    #[inline(always)]
    fn least(self, values: Self::Run) -> i16 {
        values.into_iter().fold(i16::MAX, i16::min)
    }

    #[inline(always)]
    fn first_equal(self, values: Self::Run, value: i16) -> Option<usize> {
        values.into_iter().position(|other| other == value)
    }
}

#[cfg(target_arch = "x86_64")]
impl Wide for pulp::x86::V3 {
    type Run = core::arch::x86_64::__m256i;

    #[inline(always)]
    fn splat(self, value: i16) -> Self::Run {
        self.avx._mm256_set1_epi16(value)
    }

    #[inline(always)]
    fn load(self, run: &[i16; LANES]) -> Self::Run {
        pulp::cast(*run)
    }

    #[inline(always)]
    fn load_bytes(self, run: &[u8; LANES]) -> Self::Run {
        self.avx2._mm256_cvtepu8_epi16(pulp::cast(*run))
    }

    #[inline(always)]
    fn store(self, values: Self::Run, run: &mut [i16; LANES]) {
        *run = pulp::cast(values);
    }

    #[inline(always)]
    fn add(self, a: Self::Run, b: Self::Run) -> Self::Run {
        self.avx2._mm256_add_epi16(a, b)
    }

    #[inline(always)]
    fn sub(self, a: Self::Run, b: Self::Run) -> Self::Run {
        self.avx2._mm256_sub_epi16(a, b)
    }

    #[inline(always)]
    fn mul(self, a: Self::Run, b: Self::Run) -> Self::Run {
        self.avx2._mm256_mullo_epi16(a, b)
    }

    #[inline(always)]
    fn store_upper_7(self, values: Self::Run, run: &mut [u8; LANES]) {
        let upper = self.avx2._mm256_srli_epi16::<9>(values);
        let packed = self.avx2._mm256_packus_epi16(upper, upper);
        // Each half has packed its own eight.
        let joined = self.avx2._mm256_permute4x64_epi64::<0b10_00>(packed);
        *run = pulp::cast(self.avx._mm256_castsi256_si128(joined));
    }

    #[inline(always)]
    fn min(self, a: Self::Run, b: Self::Run) -> Self::Run {
        self.avx2._mm256_min_epi16(a, b)
    }

    #[inline(always)]
    fn if_less(
        self,
        a: Self::Run,
        b: Self::Run,
        then: Self::Run,
        otherwise: Self::Run,
    ) -> Self::Run {
        let less = self.avx2._mm256_cmpgt_epi16(b, a);
        self.avx2._mm256_blendv_epi8(otherwise, then, less)
    }

    #[inline(always)]
    fn least(self, values: Self::Run) -> i16 {
        let low = self.avx._mm256_castsi256_si128(values);
        let high = self.avx2._mm256_extracti128_si256::<1>(values);
        let halves = self.sse2._mm_min_epi16(low, high);
        // Not negative, so the order without signs is the same.
        let least = self.sse4_1._mm_minpos_epu16(halves);
        self.sse2._mm_cvtsi128_si32(least) as i16
    }

    #[inline(always)]
    fn first_equal(self, values: Self::Run, value: i16) -> Option<usize> {
        let same = self.avx2._mm256_cmpeq_epi16(values, self.splat(value));
        // Two equal bits a lane.
        let bits = self.avx2._mm256_movemask_epi8(same);
        (bits != 0).then(|| bits.trailing_zeros() as usize / 2)
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
    fn all<W: Wide>(wide: W, a: [i16; LANES], b: [i16; LANES], bytes: [u8; LANES]) -> Vec<i16> {
        let (va, vb) = (wide.load(&a), wide.load(&b));
        let runs = [
            wide.splat(a[3]),
            wide.load_bytes(&bytes),
            wide.add(va, vb),
            wide.sub(va, vb),
            wide.min(va, vb),
            wide.mul(va, vb),
            wide.if_less(va, vb, wide.splat(1), wide.splat(2)),
        ];
        let place = |value| wide.first_equal(va, value).map_or(-1, |place| place as i16);
        let mut said = vec![wide.least(va), place(a[5]), place(100)];
        let mut upper = [0; LANES];
        wide.store_upper_7(wide.mul(va, wide.splat(-4099)), &mut upper);
        said.extend(upper.map(i16::from));
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
            a in prop::array::uniform16(0i16..9), b in prop::array::uniform16(0i16..9),
            bytes in prop::array::uniform16(0u8..),
        ) {
            struct Check([i16; LANES], [i16; LANES], [u8; LANES]);
            impl WideWork for Check {
                fn work<W: Wide>(self, wide: W) {
                    let Self(a, b, bytes) = self;
                    assert_eq!(all(wide, a, b, bytes), all(Plain, a, b, bytes));
                }
            }
            widest(Check(a, b, bytes));
        }
    }
}
