//! Time of matching two eyes' responses, with the default and the published steps.
#![allow(missing_docs, reason = "criterion's macros make undocumented items")]
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use disparity_pyramid::{MatchParams, estimate};
use ndarray::Array2;
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};

fn match_eyes(criterion: &mut Criterion) {
    let size = Size {
        width: 640,
        height: 480,
    };
    let bank = FilterBank::plan(GaborParams::default(), size).expect("a bank for this size");
    let eye = |shift: f32| {
        let plane = Array2::from_shape_fn(size.dim(), |(y, x)| {
            let (x, y) = (x as f32 + shift, y as f32);
            0.5 + 0.1 * ((0.9 * x + 0.4 * y).sin() + (0.2 * x).cos() + (1.3 * y - 0.7 * x).sin())
        });
        bank.respond(&LumaImage::new(plane).expect("finite samples"))
            .expect("the planned size")
    };
    let eyes = Binocular {
        left: eye(0.0),
        right: eye(3.7),
    };
    let mut group = criterion.benchmark_group("estimate");
    group
        .throughput(Throughput::Elements(size.area() as u64))
        .sample_size(10);
    for (name, params) in [
        ("default", MatchParams::default()),
        (
            "with covariance",
            MatchParams {
                covariance: true,
                ..MatchParams::default()
            },
        ),
        ("as published", MatchParams::as_published()),
    ] {
        group.bench_function(format!("{name}, 640 x 480"), |bencher| {
            bencher.iter(|| estimate(&eyes, params));
        });
    }
    group.finish();
}

criterion_group!(benches, match_eyes);
criterion_main!(benches);
