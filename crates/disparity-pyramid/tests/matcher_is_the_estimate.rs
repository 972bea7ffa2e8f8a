//! The matcher that goes from images to field in one visit gives the bits of the two levels one after
//! the other, whatever the number of threads.
use disparity_pyramid::{
    DisparityField, MatchParams, MatchWorkspace, Mismatch, VectorMatcher, estimate,
    estimate_from_votes, estimate_into, estimate_near_first,
};
use ndarray::Array2;
use proptest::prelude::*;
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};

mod texture;

/// Two views of a texture, the right one turned a little and shifted, beside noise of which nothing is
/// to be known.
fn eyes(size: Size, seed: u64, (dx, dy): (f64, f64)) -> Binocular<LumaImage> {
    let texture = texture::Texture::new(seed);
    let mut state = seed | 1;
    let mut see = |turn: f64, dx: f64, dy: f64| {
        let plane = Array2::from_shape_fn(size.dim(), |(y, x)| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            if 3 * x > 2 * size.width {
                return (state >> 40) as f32 / (1u64 << 24) as f32;
            }
            let (x, y) = (x as f64, y as f64);
            texture.at(x - dx + turn * y, y - dy - turn * x)
        });
        LumaImage::new(plane).expect("textures are finite")
    };
    Binocular {
        left: see(0.0, 0.0, 0.0),
        right: see(0.01, dx, dy),
    }
}

/// Settings of which some need the finest responses once and some more than once.
fn settings(which: usize) -> MatchParams {
    let default = MatchParams::default();
    [
        default,
        MatchParams {
            covariance: true,
            ..default
        },
        MatchParams {
            left_right_px: None,
            warps: 1,
            ..default
        },
        MatchParams {
            finest_warps: 2,
            ..default
        },
        MatchParams {
            look_back_scale: 0,
            ..default
        },
        MatchParams {
            slanted_scales: 6,
            ..default
        },
        MatchParams::as_published(),
        MatchParams {
            sparse_scales: 0,
            ..default
        },
        MatchParams {
            sparse_scales: 1,
            covariance: true,
            ..default
        },
        MatchParams {
            sparse_scales: 9,
            look_back_scale: 0,
            ..default
        },
    ][which]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn in_one_visit_or_in_two(
        width in 20usize..150, height in 20usize..90, seed: u64, which in 0usize..10,
        scales in 1usize..5, threads in 1usize..4, dx in -3.0f64..3.0, dy in -6.0f64..6.0,
    ) {
        let size = Size { width, height };
        let eyes = eyes(size, seed, (dx, dy));
        let params = settings(which);
        let gabor = GaborParams { scales, ..GaborParams::default() }.fitted_to(size);
        let bank = FilterBank::plan(gabor, size).unwrap();
        let responses = eyes.as_ref().try_map(|eye| bank.respond(eye)).unwrap();
        let expected = estimate(&responses, params).unwrap();

        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let mut matcher = VectorMatcher::plan(bank, params).unwrap();
        let mut workspace = MatchWorkspace::new();
        let (mut field, mut other) = (DisparityField::default(), DisparityField::default());
        pool.install(|| {
            // What an earlier pair left behind means nothing to a later one.
            let swapped = Binocular { left: eyes.right.clone(), right: eyes.left.clone() };
            for eyes in [&eyes, &swapped, &eyes] {
                matcher.estimate_into(eyes, &mut field).unwrap();
            }
            for _ in 0..2 {
                estimate_into(&responses, params, &mut workspace, &mut other).unwrap();
            }
        });
        prop_assert!(field == expected, "the matcher differs");
        prop_assert!(other == expected, "a kept workspace differs");
    }
}

#[test]
fn an_image_of_another_size_is_refused() {
    let planned = Size {
        width: 64,
        height: 48,
    };
    let bank = FilterBank::plan(GaborParams::default().fitted_to(planned), planned).unwrap();
    let mut matcher = VectorMatcher::plan(bank, MatchParams::default()).unwrap();
    let given = Size {
        width: 64,
        height: 47,
    };
    let mut pair = eyes(planned, 1, (0.0, 0.0));
    pair.right = eyes(given, 1, (0.0, 0.0)).right;
    let refusal = matcher.estimate(&pair).unwrap_err();
    assert!(matches!(refusal, Mismatch::WrongSize(_)), "{refusal}");
    assert!(refusal.to_string().contains("47"), "{refusal}");
}

/// Searches of which little is known find in images what they find in responses, bit for bit: where the
/// first search is enough, and where a coarse look has to say where to start.
#[test]
fn searches_for_a_start_say_the_same_of_images_and_of_responses() {
    let sizes = [(200, 120), (90, 60)];
    for ((width, height), shift) in sizes
        .into_iter()
        .flat_map(|size| [(-6.0, 0.5), (-70.0, 2.0), (30.0, -4.0)].map(|shift| (size, shift)))
    {
        let size = Size { width, height };
        let eyes = eyes(size, 7, shift);
        let gabor = GaborParams::default();
        let gabor = GaborParams {
            scales: gabor.most_scales(size),
            ..gabor
        };
        let bank = FilterBank::plan(gabor, size).unwrap();
        let responses = eyes.as_ref().try_map(|eye| bank.respond(eye)).unwrap();
        for params in [0, 1, 3].map(settings) {
            let mut matcher = VectorMatcher::plan(bank.clone(), params).unwrap();
            // What an earlier pair left must not matter.
            let mut found = estimate_from_votes(&responses, params).unwrap();
            matcher.estimate_near_first_into(&eyes, &mut found).unwrap();
            let want = estimate_near_first(&responses, params).unwrap();
            assert!(found == want, "{size} {shift:?}");
            matcher.estimate_from_votes_into(&eyes, &mut found).unwrap();
            let want = estimate_from_votes(&responses, params).unwrap();
            assert!(found == want, "{size} {shift:?}");
        }
    }
}
