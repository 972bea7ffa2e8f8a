//! Shifts far beyond the reach of any phase are found without a hint.
mod texture;

use disparity_pyramid::{MatchParams, Start, estimate, estimate_from_votes, estimate_near_first};
use proptest::prelude::*;
use texture::{Texture, respond};
use v1_gabor::Size;

const SIZE: Size = Size {
    width: 320,
    height: 200,
};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    /// The start lies within its own reach of the truth, and the pyramid arrives from there.
    #[test]
    fn a_far_shift(seed in 0u64..1000, dx in -120.0f64..120.0, dy in -16.0f64..16.0) {
        let texture = Texture::new(seed);
        let eyes = respond(SIZE, |x, y| texture.at(x, y), |x, y| texture.at(x - dx, y - dy));
        let start = Start::find(&eyes).expect("half of the picture is seen twice");
        let (miss_x, miss_y) = (f64::from(start.shift_px.0) - dx, f64::from(start.shift_px.1) - dy);
        let reach = f64::from(start.reach_px);
        prop_assert!(miss_x.abs() <= reach + 4.0 && miss_y.abs() <= reach + 4.0, "{start:?}");
        let params = MatchParams {
            zero_disparity_px: start.shift_px,
            ..MatchParams::default()
        };
        let field = estimate(&eyes, params).unwrap();
        let x = 160usize.saturating_add_signed((-dx / 2.0) as isize);
        let found = field.guess(x, 100);
        prop_assert!((f64::from(found.dx) - dx).abs() < 0.1 && (f64::from(found.dy) - dy).abs() < 0.1);
    }
}

/// A near board before a far wall, farther apart than one search should reach: each pixel gets the
/// field of its own start.
#[test]
fn board_and_wall_have_a_start_each() {
    let (near, far) = (Texture::new(3), Texture::new(4));
    let board = |x: f64, y: f64| (130.0..250.0).contains(&x) && (40.0..160.0).contains(&y);
    let (near_dx, far_dx) = (-90.0, -20.0);
    let eyes = respond(
        SIZE,
        |x, y| {
            if board(x, y) {
                near.at(x, y)
            } else {
                far.at(x, y)
            }
        },
        |x, y| {
            if board(x - near_dx, y) {
                near.at(x - near_dx, y)
            } else {
                far.at(x - far_dx, y)
            }
        },
    );
    let params = MatchParams {
        covariance: true,
        ..MatchParams::default()
    };
    let found = estimate_from_votes(&eyes, params).expect("one bank");
    assert!(found.starts.len() >= 2, "{:?}", found.starts);
    let field = found.field;
    // Each pixel brings its own field's covariance along.
    let known = |(x, y)| field.at(x, y)?.covariance.map(|c| c.sigma_dx());
    let sigmas: Vec<f32> = (150..230).filter_map(|x| known((x, 100))).collect();
    assert!(!sigmas.is_empty() && sigmas.iter().all(|sigma| sigma.is_finite()));
    for ((x, y), dx) in [
        ((190, 100), near_dx),
        ((60, 100), far_dx),
        ((290, 20), far_dx),
    ] {
        let found = field.guess(x, y);
        // A best guess, from whichever start; the wrong one would be off by many pixels.
        assert!(
            (f64::from(found.dx) - dx).abs() < 0.5,
            "({x}, {y}): {found:?}"
        );
    }
}

/// A near pair is searched from zero alone, to the same bits; a far one as without a hint; and along
/// rows only no start leaves them.
#[test]
fn near_comes_first() {
    let texture = Texture::new(11);
    let shifted = |dx: f64, dy: f64| {
        respond(
            SIZE,
            |x, y| texture.at(x, y),
            |x, y| texture.at(x - dx, y - dy),
        )
    };
    let near = shifted(-14.0, 0.0);
    let found = estimate_near_first(&near, MatchParams::default()).expect("one bank");
    assert!(found.starts.is_empty());
    let from_zero = estimate(&near, MatchParams::default()).expect("one bank");
    assert_eq!(found.scales, near.left.scales().len().min(6));
    assert!(found.field == from_zero);

    let far = shifted(-110.0, 6.0);
    let found = estimate_near_first(&far, MatchParams::default()).expect("one bank");
    assert!(!found.starts.is_empty());
    let there = found.field.guess(215, 100);
    assert!((there.dx + 110.0).abs() < 0.1 && (there.dy - 6.0).abs() < 0.1);

    let along_rows = MatchParams {
        rows_only: true,
        ..MatchParams::default()
    };
    let found = estimate_from_votes(&far, along_rows).expect("one bank");
    assert!(found.starts.iter().all(|start| start.shift_px.1 == 0.0));
    assert!(found.field.dy().iter().all(|&dy| dy == 0.0));
}

/// A papered board far from zero before a textured wall: within the board every shift a period away
/// fits as well, even seen back from the other eye, and only the outline tells.
#[test]
fn a_pattern_that_repeats_is_found_by_its_outline() {
    /// The paper's period in both directions.
    const PERIOD_PX: f64 = 32.0;
    let wall = Texture::new(21);
    let board = |x: f64, y: f64| (150.0..282.0).contains(&x) && (35.0..167.0).contains(&y);
    // Whole waves to the period, in all directions, at phases without a pattern of their own.
    let paper = |x: f64, y: f64| {
        let wave = |i: i32, j: i32| {
            let (i, j) = (f64::from(i), f64::from(j));
            let turn = (i * x + j * y) / PERIOD_PX + 0.37 * i * i + 0.61 * j * j * i + 0.23 * j;
            (turn * std::f64::consts::TAU).sin() / i.hypot(j)
        };
        let waves = (1..=4).flat_map(|i| (-4..=4).map(move |j| (i, j)));
        let along_y = (1..=4).map(|j| (0, j));
        let sum: f64 = waves.chain(along_y).map(|(i, j)| wave(i, j)).sum();
        (0.5 + 0.04 * sum) as f32
    };
    // The board leans, as it does in a hand: its shift grows by 6 px over its width.
    let near = |x: f64| (-101.0 + 0.05 * (x - 216.0), 4.0);
    let far = (-31.0, 2.0);
    let eyes = respond(
        SIZE,
        |x, y| {
            if board(x, y) {
                paper(x, y)
            } else {
                wall.at(x, y)
            }
        },
        |x, y| {
            // The left place seen here: u + near(u) = x.
            let (u, v) = ((x + 101.0 + 0.05 * 216.0) / 1.05, y - 4.0);
            if board(u, v) {
                paper(u, v)
            } else {
                wall.at(x - far.0, y - far.1)
            }
        },
    );
    let found = estimate_from_votes(&eyes, MatchParams::default()).expect("one bank");
    let (mut right, mut all) = (0, 0);
    // A filter of the third scale reaches 20 px beyond the board's edge.
    for y in (55..147).step_by(4) {
        for x in (170..262).step_by(4) {
            let there = found.field.guess(x, y);
            let (dx, dy) = near(x as f64);
            let miss = (f64::from(there.dx) - dx).hypot(f64::from(there.dy) - dy);
            right += usize::from(miss < 2.0);
            all += 1;
        }
    }
    // The corners' mark on real boards: nine tenths within 2 px.
    assert!(
        right * 10 >= all * 9,
        "{right} of {all}: {:?}",
        found.starts
    );
    let behind = found.field.guess(40, 180);
    assert!((f64::from(behind.dx) - far.0).abs() < 0.5, "{behind:?}");
}

#[test]
fn where_nothing_is_seen_there_is_no_start() {
    let eyes = respond(SIZE, |_, _| 0.5, |_, _| 0.5);
    assert_eq!(Start::find(&eyes), None);
    let (one, other) = (Texture::new(1), Texture::new(2));
    let strangers = respond(SIZE, |x, y| one.at(x, y), |x, y| other.at(x, y));
    // Windows of noise agree here and there by chance, hardly ever from both eyes.
    assert!(Start::find(&strangers).is_none_or(|start| start.mutual < 0.2));
}
