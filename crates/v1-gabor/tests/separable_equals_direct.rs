//! The separable bank, the direct two-dimensional sum and the way through the Fourier domain give
//! one answer.
use ndarray::{Array2, ArrayView2};
use num_complex::Complex32;
use proptest::prelude::*;
use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};

/// `sum_k I(x + k) h(k)`, borders replicated: the definition, tap by tap.
fn direct(image: ArrayView2<'_, f32>, filter: &Array2<Complex32>, x: usize, y: usize) -> Complex32 {
    let radius = filter.dim().0 / 2;
    let (height, width) = image.dim();
    let clamp =
        |at: usize, k: usize, length: usize| (at + k).saturating_sub(radius).min(length - 1);
    filter
        .indexed_iter()
        .map(|((ky, kx), tap)| image[[clamp(y, ky, height), clamp(x, kx, width)]] * tap)
        .sum()
}

fn noise(size: Size, seed: u64) -> LumaImage {
    let mut state = seed | 1;
    let plane = Array2::from_shape_simple_fn(size.dim(), || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f32 / (1u64 << 24) as f32
    });
    LumaImage::new(plane).expect("noise is finite")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn three_ways_one_answer(
        width in 1usize..60, height in 1usize..50, orientations in 4usize..13,
        radius in 5usize..8, seed: u64,
    ) {
        let size = Size { width, height };
        let params = GaborParams { orientations, radius, scales: 1, ..GaborParams::default() };
        let bank = FilterBank::plan(params, size).unwrap();
        let image = noise(size, seed);
        let separable = bank.respond(&image).unwrap();
        let fourier = bank.respond_by_fourier(&image).unwrap();
        for q in 0..orientations {
            let filter = bank.filter(q);
            for y in 0..height {
                for x in 0..width {
                    let expected = direct(image.plane(), &filter, x, y);
                    // Sums of some 150 products below 0.1: rounding stays near 1e-6.
                    let by_kernels = (separable.scales()[0].at(q, x, y) - expected).norm();
                    let by_spectra = (fourier.scales()[0].at(q, x, y) - expected).norm();
                    prop_assert!(by_kernels < 4e-6, "separable off by {by_kernels}");
                    prop_assert!(by_spectra < 4e-6, "Fourier off by {by_spectra}");
                }
            }
        }
    }
}

#[test]
fn every_scale_agrees_with_the_fourier_path() {
    let size = Size {
        width: 97,
        height: 75,
    };
    let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size).unwrap();
    let image = noise(size, 7);
    let separable = bank.respond(&image).unwrap();
    let fourier = bank.respond_by_fourier(&image).unwrap();
    assert_eq!(separable.scales().len(), 4);
    for (by_kernels, by_spectra) in separable.scales().iter().zip(fourier.scales()) {
        for q in 0..8 {
            let differences = by_kernels.plane(q) - by_spectra.plane(q);
            assert!(differences.iter().all(|d| d.norm() < 4e-6));
        }
    }
}
