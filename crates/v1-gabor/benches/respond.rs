//! Time of one image through the bank, at one scale and at six.
#![allow(missing_docs, reason = "criterion's macros make undocumented items")]
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use ndarray::Array2;
use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};

fn respond(criterion: &mut Criterion) {
    let size = Size {
        width: 1024,
        height: 768,
    };
    let plane = Array2::from_shape_fn(size.dim(), |(y, x)| ((x * 7 + y * 13) % 101) as f32 / 101.0);
    let image = LumaImage::new(plane).expect("finite samples");
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
        group.bench_function(format!("{scales} scales, 1024 x 768"), |bencher| {
            bencher.iter(|| bank.respond(&image));
        });
    }
    group.finish();
}

criterion_group!(benches, respond);
criterion_main!(benches);
