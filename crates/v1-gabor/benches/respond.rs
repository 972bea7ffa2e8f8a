//! Time of one image through the bank, at one scale and at six, beside the port-bound floor: the
//! bank's 264 multiplications and additions a pixel at the rate of a loop that does nothing else.
#![allow(missing_docs, reason = "criterion's macros make undocumented items")]
#![allow(
    clippy::print_stdout,
    reason = "the ratio to the floor is what this bench is for"
)]
use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use ndarray::Array2;
use pulp::{Arch, Simd, WithSimd};
use rayon::ThreadPoolBuilder;
use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};

/// Fused multiplications and additions in ten independent chains of vectors.
struct FusedLoop;

/// Rounds of ten vectors each.
const ROUNDS: usize = 200_000;

impl WithSimd for FusedLoop {
    /// Results a second.
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let mut chains = [simd.splat_f32s(1.0); 10];
        let factor = simd.splat_f32s(black_box(0.999));
        let summand = simd.splat_f32s(black_box(0.001));
        let start = Instant::now();
        for _ in 0..ROUNDS {
            for chain in &mut chains {
                *chain = simd.mul_add_e_f32s(*chain, factor, summand);
            }
        }
        black_box(chains);
        (ROUNDS * chains.len() * S::F32_LANES) as f64 / start.elapsed().as_secs_f64()
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
    let mut group = criterion.benchmark_group("respond");
    group
        .throughput(Throughput::Elements(size.area() as u64))
        .sample_size(20);
    for scales in [1, 6] {
        let params = GaborParams {
            scales,
            ..GaborParams::default()
        };
        let bank = FilterBank::plan(params, size).expect("a bank for this size");
        let mut workspace = one_thread.install(|| bank.workspace());
        let mut responses = bank.silence();
        let mut frame = || {
            one_thread.install(|| {
                bank.respond_into(&image, &mut workspace, &mut responses)
                    .expect("the planned size");
            });
        };
        group.bench_function(format!("{scales} scales, 1024 x 768"), |bencher| {
            bencher.iter(&mut frame);
        });
        // Interleaved, and the best of each: a busy machine then slows both alike.
        let (mut time, mut rate) = (Duration::MAX, 0.0f64);
        for _ in 0..40 {
            let start = Instant::now();
            frame();
            time = time.min(start.elapsed());
            rate = rate.max(Arch::new().dispatch(FusedLoop));
        }
        let pixels: usize = responses
            .scales()
            .iter()
            .map(|scale| scale.size().area())
            .sum();
        let floor = 264.0 * pixels as f64 / rate;
        println!(
            "{scales} scales: {:.2} ms, floor {:.2} ms, ratio {:.2}",
            time.as_secs_f64() * 1e3,
            floor * 1e3,
            time.as_secs_f64() / floor
        );
    }
    group.finish();
}

criterion_group!(benches, respond);
criterion_main!(benches);
