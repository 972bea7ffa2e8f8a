//! Time of one image through the bank beside the port-bound floor: the bank's 264 multiplications
//! and additions a pixel at the rate of a loop of fused ones in 256-bit vectors.
//!
//! CPU time, the best of forty. Three ways: the responses row by row, as a fused pass takes them; one whole scale, whose 50 MB
//! go to memory; and six scales.
#![allow(missing_docs, reason = "criterion's macros make undocumented items")]
#![allow(
    clippy::print_stdout,
    reason = "the ratio to the floor is what this bench is for"
)]
use std::hint::black_box;
use std::time::Duration;

use cpu_time::ProcessTime;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use ndarray::Array2;
use pulp::{Arch, NullaryFnOnce, Simd};
use rayon::ThreadPoolBuilder;
use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};

/// Fused multiplications and additions in ten independent chains of vectors.
struct FusedLoop<S>(S);

/// Rounds of ten vectors each.
const ROUNDS: usize = 200_000;

impl<S: Simd> NullaryFnOnce for FusedLoop<S> {
    /// Results a second.
    type Output = f64;

    #[inline(always)]
    fn call(self) -> f64 {
        let simd = self.0;
        let mut chains = [simd.splat_f32s(1.0); 10];
        let factor = simd.splat_f32s(black_box(0.999));
        let summand = simd.splat_f32s(black_box(0.001));
        let start = ProcessTime::now();
        for _ in 0..ROUNDS {
            for chain in &mut chains {
                *chain = simd.mul_add_e_f32s(*chain, factor, summand);
            }
        }
        black_box(chains);
        (ROUNDS * chains.len() * S::F32_LANES) as f64 / start.elapsed().as_secs_f64()
    }
}

/// Results a second of the fused loop in vectors of 256 bits, which is the peak of every x86 core
/// whose wider vectors take two turns; on others, in the machine's own.
fn fused_rate() -> f64 {
    match Arch::new() {
        #[cfg(target_arch = "x86_64")]
        Arch::V4(v4) => v4.vectorize(FusedLoop(*v4)),
        #[cfg(target_arch = "x86_64")]
        Arch::V3(v3) => v3.vectorize(FusedLoop(v3)),
        _ => FusedLoop(pulp::Scalar).call(),
    }
}

fn respond(criterion: &mut Criterion) {
    let size = Size {
        width: 1024,
        height: 768,
    };
    let plane = Array2::from_shape_fn(size.dim(), |(y, x)| ((x * 7 + y * 13) % 101) as f32 / 101.0);
    let image = LumaImage::new(plane).expect("finite samples");
    let one_thread = ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a pool of one thread");
    let plan = |scales| {
        let params = GaborParams {
            scales,
            ..GaborParams::default()
        };
        FilterBank::plan(params, size).expect("a bank for this size")
    };
    let mut group = criterion.benchmark_group("respond");
    group
        .throughput(Throughput::Elements(size.area() as u64))
        .sample_size(20);
    let mut measure = |name: &str, pixels: usize, frame: &mut dyn FnMut()| {
        group.bench_function(format!("{name}, 1024 x 768"), |bencher| {
            bencher.iter(&mut *frame);
        });
        // Interleaved, and the best of each: neighbours that share the memory's bus then slow both
        // alike.
        let (mut time, mut rate) = (Duration::MAX, 0.0f64);
        for _ in 0..40 {
            let start = ProcessTime::now();
            frame();
            time = time.min(start.elapsed());
            rate = rate.max(fused_rate());
        }
        let floor = 264.0 * pixels as f64 / rate;
        println!(
            "{name}: {:.2} ms, floor {:.2} ms, ratio {:.2}",
            time.as_secs_f64() * 1e3,
            floor * 1e3,
            time.as_secs_f64() / floor
        );
    };
    let bank = plan(1);
    let mut workspace = one_thread.install(|| bank.workspace());
    measure("row by row", size.area(), &mut || {
        bank.respond_by_rows(&image, &mut workspace, |_, row| {
            black_box(row);
        })
        .expect("the planned size");
    });
    for scales in [1, 6] {
        let bank = plan(scales);
        let mut workspace = one_thread.install(|| bank.workspace());
        let mut responses = bank.silence();
        let pixels = responses.scales().iter().map(|scale| scale.size().area());
        let pixels = pixels.sum();
        measure(&format!("{scales} scales, kept"), pixels, &mut || {
            one_thread.install(|| {
                bank.respond_into(&image, &mut workspace, &mut responses)
                    .expect("the planned size");
            });
        });
    }
    group.finish();
}

criterion_group!(benches, respond);
criterion_main!(benches);
