use std::hint::black_box;

use pulp::{Arch, Simd, WithSimd};
use serde::Serialize;

use super::median::median;
use crate::clocked::clocked;

/// What one core of this machine can do, measured in the same rounds as the contestants.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Ceilings {
    /// Fused multiplications and additions in the widest vectors, in 10^9 operations a second, two to
    /// each.
    pub(crate) fma_gflops: f64,
    /// The same in vectors of eight lanes (AVX2), where the machine has wider ones.
    pub(crate) eight_lanes_gflops: Option<f64>,
    /// Bytes read and written by a copy that no cache holds, in 10^9 a second.
    pub(crate) copy_gb_s: f64,
}

/// Measures the ceilings round after round.
pub(super) struct Roof {
    from: Vec<f32>,
    to: Vec<f32>,
    gflops: Vec<f64>,
    eight_lanes: Vec<f64>,
    gb_s: Vec<f64>,
}

/// Numbers of a copy: several times what the caches hold.
const COPIED: usize = 16 << 20;

/// Sums that do not wait for one another: more than twice as many as steps that one takes, and not
/// more than there are registers.
const SUMS: usize = 12;

/// Steps of each sum.
const STEPS: usize = 1 << 21;

impl Roof {
    pub(super) fn new() -> Self {
        Self {
            from: vec![1.0; COPIED],
            to: vec![0.0; COPIED],
            gflops: Vec::new(),
            eight_lanes: Vec::new(),
            gb_s: Vec::new(),
        }
    }

    /// One measurement of each.
    pub(super) fn measure(&mut self) {
        let arch = Arch::new();
        self.gflops.push(gflops(|| arch.dispatch(Fma)));
        #[cfg(target_arch = "x86_64")]
        if let Arch::V4(v4) = arch {
            self.eight_lanes.push(gflops(|| Simd::vectorize(*v4, Fma)));
        }
        let Self { from, to, .. } = self;
        let ((), took) = clocked(|| {
            black_box(&mut *to).copy_from_slice(black_box(from));
        });
        black_box(to);
        let bytes = (2 * COPIED * size_of::<f32>()) as f64;
        self.gb_s.push(bytes / took.cpu.as_secs_f64() / 1e9);
    }

    /// The medians.
    pub(super) fn ceilings(self) -> Ceilings {
        Ceilings {
            fma_gflops: median(self.gflops),
            eight_lanes_gflops: (!self.eight_lanes.is_empty()).then(|| median(self.eight_lanes)),
            copy_gb_s: median(self.gb_s),
        }
    }
}

/// How fast a run goes of which its number of lanes is known afterwards.
fn gflops(run: impl FnOnce() -> usize) -> f64 {
    let (lanes, took) = clocked(run);
    (2 * SUMS * STEPS * lanes) as f64 / took.cpu.as_secs_f64() / 1e9
}

/// Independent sums in the machine's vectors; gives how many lanes these have.
struct Fma;

impl WithSimd for Fma {
    type Output = usize;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> usize {
        let factor = simd.splat_f32s(black_box(0.999));
        let term = simd.splat_f32s(black_box(0.001));
        let mut sums = [term; SUMS];
        for _ in 0..STEPS {
            for i in 0..SUMS {
                sums[i] = simd.mul_add_e_f32s(sums[i], factor, term);
            }
        }
        let mut sum = 0.0;
        for i in 0..SUMS {
            sum += simd.reduce_sum_f32s(sums[i]);
        }
        black_box(sum);
        S::F32_LANES
    }
}
