//! The population of binocular energy cells and the phase estimator give one answer.
mod texture;

use disparity_pyramid::{MatchParams, Mismatch, estimate, estimate_population};
use proptest::prelude::*;
use texture::{Texture, respond};
use v1_gabor::Size;

const SIZE: Size = Size {
    width: 96,
    height: 80,
};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4))]

    /// On a plane with both components, cells and phases say the same, and both are right.
    #[test]
    fn on_a_plane(seed in 0u64..1000, dx in -5.0f64..5.0, dy in -2.0f64..2.0, slope in -0.02f64..0.02) {
        let texture = Texture::new(seed);
        // Right (x + dx + slope y, y + dy) shows what left (x, y) shows.
        let eyes = respond(SIZE, |x, y| texture.at(x, y), |x, y| {
            let y = y - dy;
            texture.at(x - dx - slope * y, y)
        });
        // No prior, no look back: neither has its like in a population.
        let params = MatchParams {
            vertical_prior: 0.0,
            left_right_px: None,
            ..MatchParams::default()
        };
        let phases = estimate(&eyes, params).unwrap();
        let cells = estimate_population(&eyes, params).unwrap();
        let (mut apart, mut miss, mut compared) = (0.0, 0.0, 0.0);
        for y in 12..SIZE.height - 12 {
            for x in 12..SIZE.width - 12 {
                if let (Some(phase), Some(cell)) = (phases.at(x, y), cells.at(x, y)) {
                    apart += f64::from((phase.dx - cell.dx).hypot(phase.dy - cell.dy));
                    miss += (f64::from(cell.dx) - dx - slope * y as f64).hypot(f64::from(cell.dy) - dy);
                    compared += 1.0;
                }
            }
        }
        prop_assert!(compared > 0.8 * 56.0 * 72.0, "{compared} pixels compared");
        // The sum of cosines and the robust squares weigh large residuals differently.
        prop_assert!(apart / compared < 0.02, "{} px apart", apart / compared);
        prop_assert!(miss / compared < 0.04, "{} px wrong", miss / compared);
    }
}

#[test]
fn a_start_and_a_refusal_mean_the_same() {
    let texture = Texture::new(5);
    let eyes = respond(
        SIZE,
        |x, y| texture.at(x, y),
        |x, y| texture.at(x + 43.0, y),
    );
    let params = MatchParams {
        zero_disparity_px: (-41.0, 0.0),
        ..MatchParams::default()
    };
    let found = estimate_population(&eyes, params).unwrap().at(70, 40);
    let found = found.expect("within reach of the start");
    assert!(
        (found.dx + 43.0).abs() < 0.05 && found.dy.abs() < 0.05,
        "{found:?}"
    );
    let refused = MatchParams {
        warps: 0,
        ..MatchParams::default()
    };
    assert!(matches!(
        estimate_population(&eyes, refused),
        Err(Mismatch::Parameter { name: "warps", .. })
    ));
    let blank = respond(SIZE, |_, _| 0.5, |_, _| 0.5);
    let field = estimate_population(&blank, MatchParams::default()).unwrap();
    assert_eq!(field.density(), 0.0);
}
