//! Images of any size are filtered by every family, or refused with a reason that says what to do.
use ndarray::Array2;
use v1_gabor::{
    BadParams, Family, FilterBank, GaborParams, LumaImage, MonogenicBank, MonogenicParams, Size,
    SteerableOrder, SteerableParams,
};

/// A point, smaller than half a filter, long and thin, smaller than a filter, of odd sides, and one
/// that carries six scales.
const SIZES: [(usize, usize); 7] = [
    (1, 1),
    (7, 3),
    (10_000, 2),
    (2, 10_000),
    (10, 10),
    (33, 21),
    (192, 187),
];

fn families(scales: usize) -> [Family; 3] {
    let steerable = |order| SteerableParams {
        order,
        scales,
        ..SteerableParams::default()
    };
    let gabor = GaborParams {
        scales,
        ..GaborParams::default()
    };
    [
        gabor.into(),
        steerable(SteerableOrder::Second).into(),
        steerable(SteerableOrder::Fourth).into(),
    ]
}

fn size((width, height): (usize, usize)) -> Size {
    Size { width, height }
}

/// Something in every direction, from 0 to 1.
fn image(size: Size) -> LumaImage {
    let luma = |(y, x): (usize, usize)| {
        let (x, y) = (x as f32, y as f32);
        0.5 + 0.25 * (1.3 * x + 0.4 * y).sin() + 0.25 * (0.5 * x - 1.1 * y).cos()
    };
    LumaImage::new(Array2::from_shape_fn(size.dim(), luma)).expect("waves are finite")
}

/// Whether an image of this size has so many scales, by halving it: the coarsest needs six pixels,
/// half a filter of eleven taps, either way; the finest needs nothing.
fn carries(size: Size, scales: usize) -> bool {
    let coarsest = (1..scales).fold(size, |size, _| size.halved());
    scales == 1 || coarsest.width.min(coarsest.height) >= 6
}

#[track_caller]
fn refused_with_a_reason(refused: BadParams, size: Size, scales: usize) {
    assert!(matches!(refused, BadParams::TooManyScales { .. }));
    let reason = refused.to_string();
    for word in [
        size.to_string(),
        format!("{scales} scales"),
        "at most".into(),
    ] {
        assert!(reason.contains(&word), "no '{word}' in: {reason}");
    }
}

#[test]
fn oriented_filters() {
    for dim in SIZES {
        let size = size(dim);
        for family in [1, 6].into_iter().flat_map(families) {
            let scales = family.as_gabor().scales;
            let bank = match FilterBank::plan(family, size) {
                Ok(bank) => bank,
                Err(reason) => {
                    assert!(!carries(size, scales), "{family:?} {size}: {reason}");
                    refused_with_a_reason(reason, size, scales);
                    // What the size carries is planned, and at least one scale is.
                    FilterBank::plan(family.fitted_to(size), size).unwrap()
                }
            };
            let seen = bank.respond(&image(size)).unwrap();
            assert_eq!(
                (seen.size(), seen.scales().len()),
                (size, bank.params().scales)
            );
            let mut coarser = size;
            for responses in seen.scales() {
                assert_eq!(responses.size(), coarser);
                let loudest = (0..responses.orientations())
                    .flat_map(|q| responses.amplitude(q).into_iter())
                    .fold(0.0, f32::max);
                // A gain of 1 at the peak and of 2 where the second order folds; no NaN either.
                assert!(loudest.is_finite() && loudest < 2.0, "{family:?} {size}");
                coarser = coarser.halved();
            }
        }
    }
}

#[test]
fn spherical_filters() {
    for dim in SIZES {
        let size = size(dim);
        for scales in [1, 6] {
            let params = MonogenicParams {
                scales,
                ..MonogenicParams::default()
            };
            let bank = match MonogenicBank::plan(params, size) {
                Ok(bank) => bank,
                Err(reason) => {
                    assert!(!carries(size, scales), "{size}: {reason}");
                    refused_with_a_reason(reason, size, scales);
                    MonogenicBank::plan(params.fitted_to(size), size).unwrap()
                }
            };
            let seen = bank.respond(&image(size)).unwrap();
            assert_eq!(
                (seen.size(), seen.scales().len()),
                (size, bank.params().scales)
            );
            for planes in seen.scales() {
                let parts = [planes.even(), planes.along_x(), planes.along_y()];
                assert!(
                    parts.iter().flatten().all(|part| part.abs() < 2.0),
                    "{size}"
                );
            }
        }
    }
}

/// The two ways through a bank agree on the smallest images too, where most of what a filter sees
/// is the replicated border.
#[test]
fn both_ways_agree_on_small_images() {
    for dim in [(1, 1), (7, 3), (10, 10), (40, 2)] {
        let size = size(dim);
        for family in families(1) {
            let bank = FilterBank::plan(family, size).unwrap();
            let image = image(size);
            let (fast, fourier) = (bank.respond(&image), bank.respond_by_fourier(&image));
            let (fast, fourier) = (fast.unwrap(), fourier.unwrap());
            for q in 0..bank.params().orientations {
                for y in 0..size.height {
                    for x in 0..size.width {
                        let [a, b] = [&fast, &fourier].map(|seen| seen.scales()[0].at(q, x, y));
                        // Rounding of a transform of some thousands of values below one.
                        assert!((a - b).norm() < 1e-5, "{family:?} {size}: {a} {b}");
                    }
                }
            }
        }
    }
}

#[test]
fn no_pixel_is_no_image() {
    let nothing = Size {
        width: 5,
        height: 0,
    };
    for family in families(1) {
        let refused = FilterBank::plan(family, nothing).unwrap_err();
        assert_eq!(refused, BadParams::EmptyImage(nothing));
    }
    let refused = MonogenicBank::plan(MonogenicParams::default(), nothing).unwrap_err();
    assert_eq!(refused, BadParams::EmptyImage(nothing));
    assert!(LumaImage::new(Array2::zeros((0, 5))).is_err());
}
