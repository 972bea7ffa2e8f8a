//! Shifts far beyond the reach of any phase are found without a hint.
mod texture;

use disparity_pyramid::{MatchParams, Start, estimate};
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

#[test]
fn where_nothing_is_seen_there_is_no_start() {
    let eyes = respond(SIZE, |_, _| 0.5, |_, _| 0.5);
    assert_eq!(Start::find(&eyes), None);
    let (one, other) = (Texture::new(1), Texture::new(2));
    let strangers = respond(SIZE, |x, y| one.at(x, y), |x, y| other.at(x, y));
    // Windows of noise agree here and there by chance, hardly ever from both eyes.
    assert!(Start::find(&strangers).is_none_or(|start| start.mutual < 0.2));
}
