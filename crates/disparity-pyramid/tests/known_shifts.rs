//! Shifts that are known exactly are found, in both components, with the estimator's own word on
//! where it knows.
mod texture;

use disparity_pyramid::{DisparityField, MatchParams, Validity, estimate};
use proptest::prelude::*;
use texture::{Texture, respond};
use v1_gabor::{Binocular, Size};

const SIZE: Size = Size {
    width: 160,
    height: 120,
};

/// Mean absolute errors of both components on valid pixels, and the part of the pixels valid, away
/// from the border that the shift itself uncovers.
fn errors(
    field: &DisparityField,
    truth: impl Fn(f64, f64) -> (f64, f64),
    margin: usize,
) -> (f64, f64, f64) {
    let (mut along_x, mut along_y, mut valid, mut all) = (0.0, 0.0, 0.0, 0.0);
    for y in margin..SIZE.height - margin {
        for x in margin..SIZE.width - margin {
            all += 1.0;
            if let Some(found) = field.at(x, y) {
                let (dx, dy) = truth(x as f64, y as f64);
                along_x += (f64::from(found.dx) - dx).abs();
                along_y += (f64::from(found.dy) - dy).abs();
                valid += 1.0;
            }
        }
    }
    (along_x / valid, along_y / valid, valid / all)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// A constant shift, far beyond one filter's reach, in both components at once.
    #[test]
    fn a_constant_shift(seed in 0u64..1000, dx in -11.0f64..11.0, dy in -4.0f64..4.0) {
        let texture = Texture::new(seed);
        let eyes = respond(SIZE, |x, y| texture.at(x, y), |x, y| texture.at(x - dx, y - dy));
        let field = estimate(&eyes, MatchParams::default()).unwrap();
        let (along_x, along_y, density) = errors(&field, |_, _| (dx, dy), 16);
        // 0.02 px is what the issue of accuracy asks of constant shifts.
        prop_assert!(along_x < 0.02 && along_y < 0.02, "MAE {along_x}, {along_y} px");
        prop_assert!(density > 0.9, "density {density}");
    }

    /// A slanted plane: the shift changes along the row, and the eyes see different frequencies.
    #[test]
    fn a_slant(seed in 0u64..1000, slope in -0.06f64..0.06, tilt in -0.06f64..0.06, rise in -0.02f64..0.02) {
        let texture = Texture::new(seed);
        let (cx, cy) = (80.0, 60.0);
        let shift = |x: f64, y: f64| (slope * (x - cx) + tilt * (y - cy), rise * (x - cx));
        // Right (x + dx, y + dy) shows what left (x, y) shows; the inverse map by fixed point.
        let back = |u: f64, v: f64| {
            let (mut x, mut y) = (u, v);
            for _ in 0..40 {
                let (dx, dy) = shift(x, y);
                (x, y) = (u - dx, v - dy);
            }
            (x, y)
        };
        let eyes = respond(SIZE, |x, y| texture.at(x, y), |u, v| {
            let (x, y) = back(u, v);
            texture.at(x, y)
        });
        let field = estimate(&eyes, MatchParams::default()).unwrap();
        let (along_x, along_y, density) = errors(&field, shift, 16);
        // The shift varies by up to 0.3 px within one filter, and the eyes see frequencies that differ
        // by the slope: measured 0.034 px at a slope of 0.06.
        prop_assert!(along_x < 0.05 && along_y < 0.03, "MAE {along_x}, {along_y} px");
        prop_assert!(density > 0.85, "density {density}");
    }

    /// Fitting every second pixel of every second row says what fitting every pixel does.
    #[test]
    fn every_second_pixel_is_enough(seed in 0u64..1000, dx in -5.0f64..5.0, slope in -0.02f64..0.02) {
        let texture = Texture::new(seed);
        let shift = |x: f64| dx + slope * x;
        // Right x + dx shows what left x shows.
        let back = |u: f64| (u - dx) / (1.0 + slope);
        let eyes = respond(SIZE, |x, y| texture.at(x, y), |x, y| texture.at(back(x), y));
        let fitted = |sparse_scales| {
            let params = MatchParams { sparse_scales, ..MatchParams::default() };
            errors(&estimate(&eyes, params).unwrap(), |x, _| (shift(x), 0.0), 16)
        };
        let (every, second) = (fitted(0), fitted(2));
        // Wider medians make up for fewer samples: neither error grows by more than what a mean over
        // 10 000 pixels scatters by itself, and the answers are as many.
        prop_assert!(second.0 < every.0 + 0.003 && second.1 < every.1 + 0.003, "{every:?} {second:?}");
        prop_assert!(second.2 > every.2 - 0.02, "{every:?} {second:?}");
    }

    /// The other eye's field, looked up where a pixel goes, undoes it.
    #[test]
    fn swapping_the_eyes_negates_the_field(seed in 0u64..1000, dx in -6.0f64..6.0, dy in -2.0f64..2.0) {
        let texture = Texture::new(seed);
        let eyes = respond(SIZE, |x, y| texture.at(x, y), |x, y| texture.at(x - dx, y - dy));
        let there = estimate(&eyes, MatchParams::default()).unwrap();
        let back = estimate(&eyes.swapped(), MatchParams::default()).unwrap();
        let mut compared = 0;
        for y in 20..100 {
            for x in 20..140 {
                let Some(out) = there.at(x, y) else { continue };
                let (u, v) = ((x as f32 + out.dx).round(), (y as f32 + out.dy).round());
                if let Some(home) = back.at(u as usize, v as usize) {
                    prop_assert!((out.dx + home.dx).abs() < 0.1 && (out.dy + home.dy).abs() < 0.1);
                    compared += 1;
                }
            }
        }
        prop_assert!(compared > 7000, "{compared} pixels consistent");
    }

    /// Another gain and offset of one eye's camera changes the answer by little: phase does not see
    /// contrast, only the energy threshold does.
    #[test]
    fn the_gain_of_one_eye_does_not_matter(seed in 0u64..1000, gain in 0.5f32..1.5, offset in -0.2f32..0.2) {
        let texture = Texture::new(seed);
        let shift = 3.3;
        let plain = respond(SIZE, |x, y| texture.at(x, y), |x, y| texture.at(x + shift, y));
        let changed = respond(SIZE, |x, y| texture.at(x, y), |x, y| gain * texture.at(x + shift, y) + offset);
        let plain = estimate(&plain, MatchParams::default()).unwrap();
        let changed = estimate(&changed, MatchParams::default()).unwrap();
        for y in 20..100 {
            for x in 20..140 {
                if let (Some(a), Some(b)) = (plain.at(x, y), changed.at(x, y)) {
                    // The balance of amplitudes weighs orientations a little differently.
                    prop_assert!((a.dx - b.dx).abs() < 0.05);
                }
            }
        }
        prop_assert!((plain.density() - changed.density()).abs() < 0.05);
    }
}

#[test]
fn one_image_seen_twice_has_no_disparity() {
    let texture = Texture::new(3);
    let eyes = respond(SIZE, |x, y| texture.at(x, y), |x, y| texture.at(x, y));
    let field = estimate(&eyes, MatchParams::default()).unwrap();
    assert!(
        field
            .dx()
            .iter()
            .chain(field.dy())
            .all(|shift| shift.abs() < 1e-4)
    );
    assert!(field.density() > 0.97);
}

#[test]
fn a_blank_wall_has_no_answer_and_says_why() {
    let eyes = respond(SIZE, |_, _| 0.4, |_, _| 0.4);
    let field = estimate(&eyes, MatchParams::default()).unwrap();
    assert!(field.validity().iter().all(|v| *v == Validity::NoEnergy));
    assert_eq!(field.at(80, 60), None);
    assert!(field.only_valid(field.dx()).iter().all(|dx| dx.is_nan()));
}

/// A near square before a far ground: to its left lies what only the left eye sees.
#[test]
fn what_one_eye_alone_sees_is_not_valid() {
    let (near, far) = (Texture::new(5), Texture::new(6));
    let in_square = |x: f64, y: f64| (50.0..110.0).contains(&x) && (30.0..90.0).contains(&y);
    let (near_dx, far_dx) = (-8.0, 0.0);
    let left = |x: f64, y: f64| {
        if in_square(x, y) {
            near.at(x, y)
        } else {
            far.at(x, y)
        }
    };
    let right = |x: f64, y: f64| {
        if in_square(x - near_dx, y) {
            near.at(x - near_dx, y)
        } else {
            far.at(x - far_dx, y)
        }
    };
    let field = estimate(&respond(SIZE, left, right), MatchParams::default()).unwrap();
    // The right eye's square covers columns 42 to 102, so the left eye's 42 to 50 are hidden.
    let hidden = (40..80).flat_map(|y| (43..49).map(move |x| (x, y)));
    let valid = hidden
        .clone()
        .filter(|&(x, y)| field.at(x, y).is_some())
        .count();
    assert!(
        valid * 3 < hidden.count(),
        "{valid} hidden pixels pass for seen"
    );
    let middle = field.at(80, 60).unwrap();
    assert!((middle.dx - near_dx as f32).abs() < 0.05, "{middle:?}");
    let ground = field.at(140, 60).unwrap();
    assert!((ground.dx - far_dx as f32).abs() < 0.05, "{ground:?}");
}

#[test]
fn a_start_far_from_zero_finds_shifts_beyond_reach() {
    let texture = Texture::new(9);
    let far = -80.0;
    let eyes = respond(SIZE, |x, y| texture.at(x, y), |x, y| texture.at(x - far, y));
    let params = MatchParams {
        zero_disparity_px: (-76.0, 0.0),
        ..MatchParams::default()
    };
    let field = estimate(&eyes, params).unwrap();
    let found = field.at(130, 60).unwrap();
    assert!((f64::from(found.dx) - far).abs() < 0.03, "{found:?}");
}

#[test]
fn the_published_steps_find_the_same_shift() {
    let texture = Texture::new(11);
    let eyes = respond(
        SIZE,
        |x, y| texture.at(x, y),
        |x, y| texture.at(x + 2.6, y - 0.7),
    );
    let field = estimate(&eyes, MatchParams::as_published()).unwrap();
    let (along_x, along_y, density) = errors(&field, |_, _| (-2.6, 0.7), 16);
    // One warp a scale leaves a part of each residual behind.
    assert!(
        along_x < 0.1 && along_y < 0.1,
        "MAE {along_x}, {along_y} px"
    );
    assert!(density > 0.95);
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let texture = Texture::new(13);
    let eyes = respond(
        SIZE,
        |x, y| texture.at(x, y),
        |x, y| texture.at(x + 0.02 * y, y),
    );
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| estimate(&eyes, MatchParams::default()).unwrap())
    };
    let one = with(1);
    for threads in [2, 3, 8] {
        assert_eq!(one, with(threads));
    }
}

#[test]
fn eyes_that_do_not_fit_together_are_refused() {
    let small = Size {
        width: 40,
        height: 30,
    };
    let texture = Texture::new(1);
    let pair = respond(SIZE, |x, y| texture.at(x, y), |x, y| texture.at(x, y));
    let other = respond(small, |x, y| texture.at(x, y), |x, y| texture.at(x, y));
    let eyes = Binocular {
        left: pair.left.clone(),
        right: other.right,
    };
    let refused = estimate(&eyes, MatchParams::default())
        .unwrap_err()
        .to_string();
    assert!(
        refused.contains("160 x 120") && refused.contains("40 x 30"),
        "{refused}"
    );
    for params in [
        MatchParams {
            energy_threshold: f32::NAN,
            ..MatchParams::default()
        },
        MatchParams {
            warps: 0,
            ..MatchParams::default()
        },
        MatchParams {
            left_right_px: Some(-1.0),
            ..MatchParams::default()
        },
        MatchParams {
            zero_disparity_px: (f32::INFINITY, 0.0),
            ..MatchParams::default()
        },
    ] {
        assert!(estimate(&pair, params).is_err(), "{params:?}");
    }
}

/// Images down to a single pixel, narrower or lower than a filter: an answer or none, never a panic.
#[test]
fn any_size_is_answered() {
    for (width, height) in [(1, 1), (2, 1), (10, 40), (40, 3), (17, 300)] {
        let size = Size { width, height };
        let texture = Texture::new(2);
        let eyes = respond(size, |x, y| texture.at(x, y), |x, y| texture.at(x + 0.4, y));
        assert_eq!(
            estimate(&eyes, MatchParams::default()).unwrap().size(),
            size
        );
    }
}
