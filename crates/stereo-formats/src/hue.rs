//! Complex numbers as colours: the angle is the hue, the length the brightness.
//!
//! Angle 0 is red, and hues follow the rainbow as the angle grows: yellow, green, blue, violet and
//! back. All hues of one length are equally light in Oklab, so no angle looks brighter than another.

use std::f32::consts::TAU;
use std::sync::LazyLock;

use ndarray::{Array2, ArrayView2};
use num_complex::Complex32;

use crate::colour::{UNKNOWN, gamma, linear_rgb};

const HUES: usize = 256;
const LEVELS: usize = 256;
/// The lightness and the chroma in Oklab of full brightness: nearly the strongest colours that a
/// screen shows at every hue alike.
const LIGHTNESS: f64 = 0.76;
const CHROMA: f64 = 0.125;
/// Oklab's hue of the screen's red.
const RED: f64 = 0.51;

static COLOURS: LazyLock<Vec<[u8; 3]>> = LazyLock::new(|| {
    let colour = |hue: usize, level: usize| {
        let level = level as f64 / (LEVELS - 1) as f64;
        let hue = RED + std::f64::consts::TAU * hue as f64 / HUES as f64;
        linear_rgb(level * LIGHTNESS, level * CHROMA, hue)
            .map(|light| (gamma(light.clamp(0.0, 1.0)) * 255.0).round() as u8)
    };
    (0..HUES)
        .flat_map(|hue| (0..LEVELS).map(move |level| colour(hue, level)))
        .collect()
});

/// The colour of one number, `full` being the length of full brightness; what is not finite is
/// [`UNKNOWN`].
#[must_use]
pub fn of(number: Complex32, full: f32) -> [u8; 3] {
    if !number.is_finite() {
        return UNKNOWN;
    }
    let turn = (number.arg() / TAU).rem_euclid(1.0);
    let hue = (turn * HUES as f32).round() as usize % HUES;
    let level = (number.norm() / full).clamp(0.0, 1.0) * (LEVELS - 1) as f32;
    COLOURS[hue * LEVELS + level.round() as usize]
}

/// A plane `[[y, x]]` in colours; see [`of`].
#[must_use]
pub fn paint(plane: ArrayView2<'_, Complex32>, full: f32) -> Array2<[u8; 3]> {
    plane.mapv(|number| of(number, full))
}

/// A length of full brightness for these numbers: all but the longest twentieth are below it, as a
/// few strong edges would darken the rest. 1 if none is longer than 0.
#[must_use]
pub fn full_brightness(numbers: impl IntoIterator<Item = Complex32>) -> f32 {
    let mut lengths: Vec<f32> = numbers
        .into_iter()
        .map(Complex32::norm)
        .filter(|length| length.is_finite())
        .collect();
    let place = lengths.len().saturating_sub(1 + lengths.len() / 20);
    if lengths.is_empty() {
        return 1.0;
    }
    let (_, &mut length, _) = lengths.select_nth_unstable_by(place, f32::total_cmp);
    if length > 0.0 { length } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn zero_is_black_and_angles_are_the_rainbows() {
        assert_eq!(of(Complex32::ZERO, 1.0), [0; 3]);
        assert_eq!(of(Complex32::new(f32::NAN, 0.0), 1.0), UNKNOWN);
        let [red, green, blue] =
            [0.0, TAU / 3.0, 2.0 * TAU / 3.0].map(|angle| of(Complex32::cis(angle), 1.0));
        assert!(red[0] > red[1].max(red[2]), "{red:?}");
        assert!(green[1] > green[0].max(green[2]), "{green:?}");
        assert!(blue[2] > blue[0].max(blue[1]), "{blue:?}");
    }

    #[test]
    fn a_few_wild_numbers_do_not_darken_a_picture() {
        let numbers = (0..1000).map(|i| Complex32::from(if i < 5 { 1e6 } else { 0.5 }));
        assert_eq!(full_brightness(numbers), 0.5);
        assert_eq!(full_brightness([Complex32::ZERO]), 1.0);
        assert_eq!(full_brightness([]), 1.0);
    }

    proptest! {
        /// Longer is never darker, in any channel, and beyond full nothing changes.
        #[test]
        fn length_is_brightness(angle in 0.0f32..TAU, length in 0.0f32..1.0, more in 1.0f32..2.0) {
            let dark = of(Complex32::from_polar(length, angle), 1.0);
            let bright = of(Complex32::from_polar(length * more, angle), 1.0);
            // A rounded angle may fall on the neighbouring hue, whose channels differ by a few.
            prop_assert!((0..3).all(|i| dark[i] <= bright[i].saturating_add(6)));
        }
    }
}
