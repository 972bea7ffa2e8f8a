//! Optic flow as a picture: the direction of motion is the hue, its speed the strength of the colour.
//!
//! What stands still is white. Motion to the right is red, and hues follow the rainbow as the
//! direction turns clockwise on the screen: down yellow-green, left cyan, up violet. All hues of one
//! speed are equally light in Oklab, so no direction looks faster than another.

use ndarray::{Array2, ArrayView2, Axis, concatenate};
use num_complex::Complex32;

use crate::colour::{UNKNOWN, gamma, linear_rgb};
use crate::hue;
use crate::scale_bar::{NUMBER_HEIGHT, write_number};
use crate::vector_planes::VectorPlanes;

/// Oklab's lightness and chroma at full speed: nearly the strongest colours that a screen shows at
/// every hue alike.
const LIGHTNESS: f64 = 0.76;
const CHROMA: f64 = 0.125;
/// Oklab's hue of the screen's red.
const RED: f64 = 0.51;

/// Radius of the wheel in the legend, in pixels.
const RADIUS: usize = 32;
const MARGIN: usize = 6;
const PAPER: [u8; 3] = [255; 3];
const INK: [u8; 3] = [0; 3];

/// A speed in pixels for the strongest colours: all but the fastest twentieth of the known vectors
/// are below it. 1 if nothing moves.
#[must_use]
pub fn full_speed_px(vectors: &VectorPlanes) -> f32 {
    let known = vectors.dx().into_iter().zip(vectors.dy());
    hue::full_brightness(known.map(|(&dx, &dy)| Complex32::new(dx, dy)))
}

/// The colour of one vector `(dx, dy)`, `full_px` being the speed of the strongest colours; faster
/// ones have the same, and what is not finite is [`UNKNOWN`].
#[must_use]
pub fn colour_of(dx: f32, dy: f32, full_px: f32) -> [u8; 3] {
    if !(dx.is_finite() && dy.is_finite()) {
        return UNKNOWN;
    }
    let strength = f64::from((dx.hypot(dy) / full_px).clamp(0.0, 1.0));
    let lightness = 1.0 - strength * (1.0 - LIGHTNESS);
    let hue = RED + f64::from(dy.atan2(dx));
    linear_rgb(lightness, strength * CHROMA, hue)
        .map(|light| (gamma(light.clamp(0.0, 1.0)) * 255.0).round() as u8)
}

/// A field of vectors in colours; see [`colour_of`].
///
/// For a picture to look at, put [`over_wheel`] under it.
#[must_use]
pub fn paint(vectors: &VectorPlanes, full_px: f32) -> Array2<[u8; 3]> {
    ndarray::Zip::from(vectors.dx())
        .and(vectors.dy())
        .map_collect(|&dx, &dy| colour_of(dx, dy, full_px))
}

/// The picture over a wheel of the colours, seen as if every point moved away from its middle, with
/// the speed at its rim in pixels beside it. A picture narrower than the wheel cuts it off.
#[must_use]
pub fn over_wheel(picture: ArrayView2<'_, [u8; 3]>, full_px: f32) -> Array2<[u8; 3]> {
    let side = 2 * (RADIUS + MARGIN) + 1;
    let middle = (RADIUS + MARGIN) as f32;
    let mut strip = Array2::from_shape_fn((side, picture.ncols()), |(y, x)| {
        let (right, down) = (x as f32 - middle, y as f32 - middle);
        if right.hypot(down) > RADIUS as f32 {
            return PAPER;
        }
        let px = full_px / RADIUS as f32;
        colour_of(right * px, down * px, full_px)
    });
    let tick = RADIUS + MARGIN + RADIUS..side;
    for x in tick {
        if let Some(pixel) = strip.get_mut((RADIUS + MARGIN, x)) {
            *pixel = INK;
        }
    }
    let top = RADIUS + MARGIN - NUMBER_HEIGHT / 2;
    write_number(&mut strip, &rounded(full_px), (side + 2, top));
    // Both have one width, so this cannot fail; a picture without its wheel is still the picture.
    concatenate(Axis(0), &[picture, strip.view()]).unwrap_or_else(|_| picture.to_owned())
}

/// Three digits of a speed, more than anybody reads off a colour.
fn rounded(speed_px: f32) -> String {
    let decimals = (2.0 - f64::from(speed_px).log10().floor()).clamp(0.0, 4.0) as usize;
    format!("{speed_px:.decimals$}")
}

#[cfg(test)]
mod tests {
    use ndarray::array;
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn still_is_white_and_unknown_is_grey() {
        assert_eq!(colour_of(0.0, 0.0, 3.0), [255; 3]);
        assert_eq!(colour_of(f32::NAN, 0.0, 3.0), UNKNOWN);
        let [red, green, blue] = colour_of(3.0, 0.0, 3.0);
        assert!(red > green.max(blue), "to the right is red");
    }

    #[test]
    fn the_wheel_shows_the_colours_of_the_picture() {
        let vectors = VectorPlanes::new(
            Array2::from_elem((4, 120), 2.0),
            Array2::from_elem((4, 120), 0.0),
        )
        .unwrap();
        let full = full_speed_px(&vectors);
        assert_eq!(full, 2.0);
        let picture = over_wheel(paint(&vectors, full).view(), full);
        assert_eq!(picture.dim(), (4 + 2 * (RADIUS + MARGIN) + 1, 120));
        let rim = picture[[4 + RADIUS + MARGIN, 2 * RADIUS + MARGIN - 1]];
        // One pixel inside the rim is a thirty-second of full speed away.
        for (rim, picture) in rim.iter().zip(picture[[0, 0]]) {
            assert!(rim.abs_diff(picture) < 8);
        }
        let still = picture[[4 + RADIUS + MARGIN, RADIUS + MARGIN]];
        assert_eq!(still, [255; 3]);
    }

    #[test]
    fn a_speed_has_three_digits() {
        assert_eq!(rounded(4.618), "4.62");
        assert_eq!(rounded(46.18), "46.2");
        assert_eq!(rounded(461.8), "462");
    }

    proptest! {
        /// Any field has a picture, however narrow or wild.
        #[test]
        fn any_field_is_painted(width in 1usize..100, u in any::<f32>(), v in any::<f32>()) {
            let plane = |n| Array2::from_elem((2, width), n);
            let vectors = VectorPlanes::new(plane(u), plane(v)).unwrap();
            let full = full_speed_px(&vectors);
            prop_assert!(full > 0.0);
            let picture = over_wheel(paint(&vectors, full).view(), full);
            prop_assert_eq!(picture.ncols(), width);
        }

        /// Opposite directions of one speed never look alike.
        #[test]
        fn opposite_ways_differ(turn in 0.0f32..std::f32::consts::TAU) {
            let (v, u) = turn.sin_cos();
            let (there, back) = (colour_of(u, v, 1.0), colour_of(-u, -v, 1.0));
            let apart = there.iter().zip(back).map(|(a, b)| u32::from(a.abs_diff(b)));
            prop_assert!(apart.sum::<u32>() > 100);
        }
    }

    #[test]
    fn nothing_known_is_all_grey() {
        let unknown = VectorPlanes::new(array![[f32::NAN]], array![[0.0]]).unwrap();
        assert_eq!(full_speed_px(&unknown), 1.0);
        assert_eq!(paint(&unknown, 1.0)[[0, 0]], UNKNOWN);
    }
}
