//! Shifts are found from filters that know one orientation a pixel, too.
mod texture;

use disparity_pyramid::{MatchParams, Mismatch, estimate_monogenic};
use ndarray::Array2;
use proptest::prelude::*;
use texture::Texture;
use v1_gabor::{Binocular, LumaImage, MonogenicBank, MonogenicParams, MonogenicResponses, Size};

const SIZE: Size = Size {
    width: 160,
    height: 120,
};

fn respond(scales: usize, luma: impl Fn(f64, f64) -> f32) -> MonogenicResponses {
    let params = MonogenicParams {
        scales,
        ..MonogenicParams::default()
    };
    let bank = MonogenicBank::plan(params, SIZE).expect("the scales fit");
    let plane = Array2::from_shape_fn(SIZE.dim(), |(y, x)| luma(x as f64, y as f64));
    let image = LumaImage::new(plane).expect("textures are finite");
    bank.respond(&image).expect("the planned size")
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// A constant shift in both components, whatever the steps.
    #[test]
    fn a_constant_shift(seed in 0u64..1000, dx in -9.0f64..9.0, dy in -3.0f64..3.0) {
        let texture = Texture::new(seed);
        let eyes = Binocular {
            left: respond(4, |x, y| texture.at(x, y)),
            right: respond(4, |x, y| texture.at(x - dx, y - dy)),
        };
        for (params, most_px) in [(MatchParams::as_published(), 0.25), (MatchParams::default(), 0.12)] {
            let field = estimate_monogenic(&eyes, params).unwrap();
            let (mut error, mut valid, mut all) = (0.0, 0.0, 0.0);
            for y in 16..SIZE.height - 16 {
                for x in 16..SIZE.width - 16 {
                    all += 1.0;
                    if let Some(found) = field.at(x, y) {
                        valid += 1.0;
                        error += (f64::from(found.dx) - dx).hypot(f64::from(found.dy) - dy);
                    }
                }
            }
            // One warp falls short by the difference of peak and instantaneous frequency; more
            // warps close most of it.
            prop_assert!(error / valid < most_px, "{} px", error / valid);
            prop_assert!(valid / all > 0.8, "density {}", valid / all);
        }
    }
}

#[test]
fn eyes_of_two_banks_are_refused() {
    let eyes = Binocular {
        left: respond(2, |x, _| x as f32),
        right: respond(3, |x, _| x as f32),
    };
    let refused = estimate_monogenic(&eyes, MatchParams::default()).unwrap_err();
    assert!(matches!(refused, Mismatch::SphericalBanks { .. }));
    assert!(refused.to_string().contains("different banks"));
}
