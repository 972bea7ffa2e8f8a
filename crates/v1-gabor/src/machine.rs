use pulp::{Simd, f32x8, f32x16};

use crate::lanes::Lanes;

pub use crate::samples::Samples;

/// What the fast pass asks of a machine: arithmetic on `LANES` values at a time.
///
/// A trait of its own, and not the vector library's, since the portable machine works on several
/// lanes too, and since it has to turn rows into columns.
pub trait Machine<const LANES: usize>: Copy {
    /// As many values, in a register if the machine has one so wide.
    type Vector: Copy;

    /// The values as a vector.
    fn load(self, values: &Lanes<LANES>) -> Self::Vector;

    /// The vector's values.
    fn store(self, vector: Self::Vector) -> Lanes<LANES>;

    /// `a + b`.
    fn add(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;

    /// `a - b`.
    fn subtract(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;

    /// `a b`.
    fn multiply(self, a: Self::Vector, b: Self::Vector) -> Self::Vector;

    /// `a b + c`: in one rounding where there is an instruction for it.
    fn multiply_add(self, a: Self::Vector, b: Self::Vector, c: Self::Vector) -> Self::Vector;

    /// Rows become columns.
    fn turn(self, rows: [Self::Vector; LANES]) -> [Self::Vector; LANES];
}

/// Any machine that the target is compiled for.
impl Machine<8> for pulp::Scalar {
    type Vector = Lanes<8>;

    #[inline(always)]
    fn load(self, values: &Lanes<8>) -> Lanes<8> {
        *values
    }

    #[inline(always)]
    fn store(self, vector: Lanes<8>) -> Lanes<8> {
        vector
    }

    #[inline(always)]
    fn add(self, a: Lanes<8>, b: Lanes<8>) -> Lanes<8> {
        std::array::from_fn(|i| a[i] + b[i])
    }

    #[inline(always)]
    fn subtract(self, a: Lanes<8>, b: Lanes<8>) -> Lanes<8> {
        std::array::from_fn(|i| a[i] - b[i])
    }

    #[inline(always)]
    fn multiply(self, a: Lanes<8>, b: Lanes<8>) -> Lanes<8> {
        std::array::from_fn(|i| a[i] * b[i])
    }

    #[inline(always)]
    fn multiply_add(self, a: Lanes<8>, b: Lanes<8>, c: Lanes<8>) -> Lanes<8> {
        std::array::from_fn(|i| {
            // Where fusing is no instruction, it is a call, thirty times as slow.
            if cfg!(target_arch = "aarch64") {
                a[i].mul_add(b[i], c[i])
            } else {
                a[i] * b[i] + c[i]
            }
        })
    }

    #[inline(always)]
    fn turn(self, rows: [Lanes<8>; 8]) -> [Lanes<8>; 8] {
        std::array::from_fn(|y| std::array::from_fn(|x| rows[x][y]))
    }
}

#[cfg(target_arch = "x86_64")]
impl Machine<8> for pulp::x86::V3 {
    type Vector = f32x8;

    #[inline(always)]
    fn load(self, values: &Lanes<8>) -> f32x8 {
        pulp::cast(*values)
    }

    #[inline(always)]
    fn store(self, vector: f32x8) -> Lanes<8> {
        pulp::cast(vector)
    }

    #[inline(always)]
    fn add(self, a: f32x8, b: f32x8) -> f32x8 {
        self.add_f32s(a, b)
    }

    #[inline(always)]
    fn subtract(self, a: f32x8, b: f32x8) -> f32x8 {
        self.sub_f32s(a, b)
    }

    #[inline(always)]
    fn multiply(self, a: f32x8, b: f32x8) -> f32x8 {
        self.mul_f32s(a, b)
    }

    #[inline(always)]
    fn multiply_add(self, a: f32x8, b: f32x8, c: f32x8) -> f32x8 {
        self.mul_add_e_f32s(a, b, c)
    }

    /// Three rounds of pairwise shuffles, which the compiler does not find by itself. Plain loops,
    /// as the library's way to make an array may be a call, compiled without the vector unit.
    #[inline(always)]
    fn turn(self, rows: [f32x8; 8]) -> [f32x8; 8] {
        let avx = self.avx;
        let mut turned = [pulp::cast(rows[0]); 8];
        for i in 0..8 {
            turned[i] = pulp::cast(rows[i]);
        }
        let before = turned;
        for i in 0..4 {
            let (a, b) = (before[2 * i], before[2 * i + 1]);
            turned[2 * i] = avx._mm256_unpacklo_ps(a, b);
            turned[2 * i + 1] = avx._mm256_unpackhi_ps(a, b);
        }
        // Columns `c` and `c + 4` of the first four rows, then of the last four.
        let before = turned;
        for half in 0..2 {
            for i in 0..2 {
                let (a, b) = (before[4 * half + i], before[4 * half + 2 + i]);
                turned[4 * half + 2 * i] = avx._mm256_shuffle_ps::<0b01_00_01_00>(a, b);
                turned[4 * half + 2 * i + 1] = avx._mm256_shuffle_ps::<0b11_10_11_10>(a, b);
            }
        }
        let mut columns = rows;
        for i in 0..4 {
            let (a, b) = (turned[i], turned[4 + i]);
            columns[i] = pulp::cast(avx._mm256_permute2f128_ps::<0x20>(a, b));
            columns[4 + i] = pulp::cast(avx._mm256_permute2f128_ps::<0x31>(a, b));
        }
        columns
    }
}

#[cfg(target_arch = "x86_64")]
impl Machine<16> for pulp::x86::V4 {
    type Vector = f32x16;

    #[inline(always)]
    fn load(self, values: &Lanes<16>) -> f32x16 {
        pulp::cast(*values)
    }

    #[inline(always)]
    fn store(self, vector: f32x16) -> Lanes<16> {
        pulp::cast(vector)
    }

    #[inline(always)]
    fn add(self, a: f32x16, b: f32x16) -> f32x16 {
        self.add_f32s(a, b)
    }

    #[inline(always)]
    fn subtract(self, a: f32x16, b: f32x16) -> f32x16 {
        self.sub_f32s(a, b)
    }

    #[inline(always)]
    fn multiply(self, a: f32x16, b: f32x16) -> f32x16 {
        self.mul_f32s(a, b)
    }

    #[inline(always)]
    fn multiply_add(self, a: f32x16, b: f32x16, c: f32x16) -> f32x16 {
        self.mul_add_e_f32s(a, b, c)
    }

    /// Four rounds of pairwise shuffles.
    #[inline(always)]
    fn turn(self, rows: [f32x16; 16]) -> [f32x16; 16] {
        let avx512 = self.avx512f;
        let mut turned = [pulp::cast(rows[0]); 16];
        for i in 0..16 {
            turned[i] = pulp::cast(rows[i]);
        }
        let before = turned;
        for i in 0..8 {
            let (a, b) = (before[2 * i], before[2 * i + 1]);
            turned[2 * i] = avx512._mm512_unpacklo_ps(a, b);
            turned[2 * i + 1] = avx512._mm512_unpackhi_ps(a, b);
        }
        // In quarter `c` of vector `4 group + i`: column `4 c + i` of four rows.
        let before = turned;
        for group in 0..4 {
            for i in 0..2 {
                let (a, b) = (before[4 * group + i], before[4 * group + 2 + i]);
                turned[4 * group + 2 * i] = avx512._mm512_shuffle_ps::<0b01_00_01_00>(a, b);
                turned[4 * group + 2 * i + 1] = avx512._mm512_shuffle_ps::<0b11_10_11_10>(a, b);
            }
        }
        // Quarters 0 and 2, and then 1 and 3, of eight rows.
        let before = turned;
        for half in 0..2 {
            for i in 0..4 {
                let (a, b) = (before[8 * half + i], before[8 * half + 4 + i]);
                turned[8 * half + i] = avx512._mm512_shuffle_f32x4::<0b10_00_10_00>(a, b);
                turned[8 * half + 4 + i] = avx512._mm512_shuffle_f32x4::<0b11_01_11_01>(a, b);
            }
        }
        let before = turned;
        let mut columns = rows;
        for i in 0..8 {
            let (a, b) = (before[i], before[8 + i]);
            columns[i] = pulp::cast(avx512._mm512_shuffle_f32x4::<0b10_00_10_00>(a, b));
            columns[8 + i] = pulp::cast(avx512._mm512_shuffle_f32x4::<0b11_01_11_01>(a, b));
        }
        columns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turns<const LANES: usize>(machine: impl Machine<LANES>) {
        let rows: [Lanes<LANES>; LANES] =
            std::array::from_fn(|y| std::array::from_fn(|x| (y * LANES + x) as f32));
        let turned = machine.turn(std::array::from_fn(|y| machine.load(&rows[y])));
        for y in 0..LANES {
            for x in 0..LANES {
                assert_eq!(machine.store(turned[y])[x], rows[x][y]);
            }
        }
    }

    #[test]
    fn rows_become_columns() {
        turns(pulp::Scalar);
        #[cfg(target_arch = "x86_64")]
        {
            if let Some(v3) = pulp::x86::V3::try_new() {
                turns(v3);
            }
            if let Some(v4) = pulp::x86::V4::try_new() {
                turns(v4);
            }
        }
    }
}
