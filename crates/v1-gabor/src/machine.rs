use crate::strip_kernel::{LANES, Lanes};

/// What the fast pass leaves to the machine's own instructions; everything else the compiler finds.
pub(crate) trait Machine: Copy {
    /// `a b + c`: in one rounding where there is an instruction for it.
    fn multiply_add(a: Lanes, b: Lanes, c: Lanes) -> Lanes;

    /// Rows become columns.
    #[inline(always)]
    fn turn(self, rows: [Lanes; LANES]) -> [Lanes; LANES] {
        std::array::from_fn(|y| std::array::from_fn(|x| rows[x][y]))
    }
}

/// Any machine that the target is compiled for.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plain;

impl Machine for Plain {
    #[inline(always)]
    fn multiply_add(a: Lanes, b: Lanes, c: Lanes) -> Lanes {
        std::array::from_fn(|i| {
            // Where fusing is no instruction, it is a call, thirty times as slow.
            if cfg!(target_arch = "aarch64") {
                a[i].mul_add(b[i], c[i])
            } else {
                a[i] * b[i] + c[i]
            }
        })
    }
}

#[cfg(target_arch = "x86_64")]
impl Machine for pulp::x86::V3 {
    #[inline(always)]
    fn multiply_add(a: Lanes, b: Lanes, c: Lanes) -> Lanes {
        std::array::from_fn(|i| a[i].mul_add(b[i], c[i]))
    }

    /// Three rounds of pairwise shuffles, which the compiler does not find by itself.
    #[inline(always)]
    fn turn(self, rows: [Lanes; LANES]) -> [Lanes; LANES] {
        let avx = self.avx;
        let rows = rows.map(pulp::cast);
        let pairs: [_; LANES] = std::array::from_fn(|i| {
            let (a, b) = (rows[i / 2 * 2], rows[i / 2 * 2 + 1]);
            match i % 2 {
                0 => avx._mm256_unpacklo_ps(a, b),
                _ => avx._mm256_unpackhi_ps(a, b),
            }
        });
        // Columns `c` and `c + 4` of the first four rows, then of the last four.
        let fours: [_; LANES] = std::array::from_fn(|i| {
            let pair = i / 4 * 4 + i % 4 / 2;
            let (a, b) = (pairs[pair], pairs[pair + 2]);
            match i % 2 {
                0 => avx._mm256_shuffle_ps::<0b01_00_01_00>(a, b),
                _ => avx._mm256_shuffle_ps::<0b11_10_11_10>(a, b),
            }
        });
        std::array::from_fn(|i| {
            let (a, b) = (fours[i % 4], fours[i % 4 + 4]);
            pulp::cast(match i / 4 {
                0 => avx._mm256_permute2f128_ps::<0x20>(a, b),
                _ => avx._mm256_permute2f128_ps::<0x31>(a, b),
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turns(machine: impl Machine) {
        let rows: [Lanes; LANES] =
            std::array::from_fn(|y| std::array::from_fn(|x| (y * LANES + x) as f32));
        let turned = machine.turn(rows);
        for y in 0..LANES {
            for x in 0..LANES {
                assert_eq!(turned[y][x], rows[x][y]);
            }
        }
    }

    #[test]
    fn rows_become_columns() {
        turns(Plain);
        #[cfg(target_arch = "x86_64")]
        if let pulp::Arch::V3(v3) = pulp::Arch::new() {
            turns(v3);
        }
    }
}
