//! What level 1 knows of an image, as pictures.

use ndarray::{Array2, Zip};
use num_complex::Complex32;
use v1_gabor::{DominantOrientation, MonogenicPlanes, MonogenicResponse, Responses};

use crate::colour::{self, ColourRange};
use crate::contact_sheet::{self, Tile};
use crate::{hue, scale_bar};

/// Pictures of a sheet in one row.
const COLUMNS: usize = 4;
/// Longest side of a picture on a sheet, in pixels.
const MOST: usize = 640;
/// Energy below which a picture tells no differences: that of a grating of a fiftieth of a grey
/// level of 256.
const FAINTEST_ENERGY: f32 = 1e-9;

/// The response of one orientation: phase as hue (0, a bright line, is red), amplitude as brightness,
/// of which each picture has its own scale.
///
/// # Panics
/// If there is no such orientation.
#[must_use]
pub fn response(responses: &Responses, orientation: usize) -> Array2<[u8; 3]> {
    let plane = responses.plane(orientation);
    hue::paint(plane.view(), hue::full_brightness(plane.iter().copied()))
}

/// The responses of every orientation as in [`response`], on one scale of brightness for all.
#[must_use]
pub fn responses(responses: &Responses) -> Vec<Array2<[u8; 3]>> {
    let planes: Vec<_> = (0..responses.orientations())
        .map(|q| responses.plane(q))
        .collect();
    let full = hue::full_brightness(planes.iter().flatten().copied());
    planes
        .iter()
        .map(|plane| hue::paint(plane.view(), full))
        .collect()
}

/// Pictures of every orientation on one sheet, over the angles `theta_q` in degrees.
#[must_use]
pub fn by_orientation(pictures: Vec<Array2<[u8; 3]>>) -> Array2<[u8; 3]> {
    let count = pictures.len();
    let tiles: Vec<Tile> = pictures
        .into_iter()
        .enumerate()
        .map(|(q, picture)| Tile {
            // Exact for every number of orientations that divides 1800, short for the others.
            number: format!("{}", (q as f64 * 1800.0 / count as f64).round() / 10.0),
            picture,
        })
        .collect();
    contact_sheet::sheet(&tiles, COLUMNS, MOST)
}

/// The energy of all orientations together, `[[y, x]]`, in squared units of luma.
#[must_use]
pub fn total_energy(responses: &Responses) -> Array2<f32> {
    Array2::from_shape_fn(responses.size().dim(), |(y, x)| {
        let pixel = responses.pixel(x, y);
        let parts = pixel.even.iter().chain(pixel.odd);
        parts.map(|part| part * part).sum()
    })
}

/// An energy in colours over the scale bar of its decimal logarithm.
#[must_use]
pub fn energy(energy: &Array2<f32>) -> Array2<[u8; 3]> {
    let logarithm = energy.mapv(|energy| energy.max(FAINTEST_ENERGY).log10());
    with_bar(&logarithm, ColourRange::covering(logarithm.view()))
}

/// The dominant orientation: twice its angle as hue, so that 0 (vertical bars, which brightness
/// crosses along x) is red and 90 degrees a blue green, its strength as brightness. Grey where
/// there is none.
#[must_use]
pub fn dominant_orientation(dominant: &DominantOrientation) -> Array2<[u8; 3]> {
    let doubled = Zip::from(&dominant.theta_rad)
        .and(&dominant.strength)
        .map_collect(|&theta, &strength| Complex32::from_polar(strength, 2.0 * theta));
    let full = hue::full_brightness(doubled.iter().copied());
    hue::paint(doubled.view(), full)
}

/// The instantaneous frequency of every orientation along its own wave vector, in radians a pixel
/// of its scale, over one scale bar; grey near singularities, where it means nothing.
#[must_use]
pub fn instantaneous_frequency(responses: &Responses, tau: f32) -> Array2<[u8; 3]> {
    let params = responses.params();
    let waves = params.wave_vectors();
    // The peak frequency lies in the middle of the colours.
    let range = ColourRange::new(0.0, 2.0 * params.peak_frequency)
        .unwrap_or_else(|_| ColourRange::covering(Array2::zeros((1, 1)).view()));
    let pictures = waves.iter().enumerate().map(|(q, wave)| {
        let frequency = responses.instantaneous_frequency(q);
        let along = Zip::from(&frequency.along_x)
            .and(&frequency.along_y)
            .and(&responses.singularities(q, tau))
            .map_collect(|x, y, &singular| {
                if singular {
                    f32::NAN
                } else {
                    (x * wave.x + y * wave.y) / params.peak_frequency
                }
            });
        colour::paint(along.view(), range)
    });
    scale_bar::beneath(by_orientation(pictures.collect()).view(), range, "")
}

/// Where the phase of each orientation means nothing: white.
#[must_use]
pub fn singularities(responses: &Responses, tau: f32) -> Array2<[u8; 3]> {
    let pictures = (0..responses.orientations()).map(|q| {
        let singular = responses.singularities(q, tau);
        singular.mapv(|singular| [if singular { 255 } else { 0 }; 3])
    });
    by_orientation(pictures.collect())
}

/// Phase congruency in colours over its scale bar, from 0 to the largest hundredth.
#[must_use]
pub fn phase_congruency(congruency: &Array2<f32>) -> Array2<[u8; 3]> {
    let highest = ColourRange::covering(congruency.view()).highest();
    let range =
        ColourRange::new(0.0, highest).unwrap_or_else(|_| ColourRange::covering(congruency.view()));
    with_bar(congruency, range)
}

/// The even part and the two parts of the Riesz transform on one sheet, over the numbers 0, 1 and
/// 2: positive is red, negative a blue green.
#[must_use]
pub fn monogenic_parts(planes: &MonogenicPlanes) -> Array2<[u8; 3]> {
    let parts = [planes.even(), planes.along_x(), planes.along_y()];
    let full = hue::full_brightness(parts.iter().flatten().map(|&part| part.into()));
    let tiles: Vec<Tile> = parts
        .iter()
        .enumerate()
        .map(|(number, part)| Tile {
            number: number.to_string(),
            picture: hue::paint(part.mapv(Complex32::from).view(), full),
        })
        .collect();
    contact_sheet::sheet(&tiles, tiles.len(), MOST)
}

/// The local phase of the monogenic signal as hue, from red (a bright line) over green (an edge) to
/// blue green (a dark line), its amplitude as brightness.
#[must_use]
pub fn monogenic_phase(planes: &MonogenicPlanes) -> Array2<[u8; 3]> {
    polar(planes, |response| {
        Complex32::from_polar(response.amplitude(), response.phase())
    })
}

/// The local orientation of the monogenic signal, as in [`dominant_orientation`], with the
/// amplitude of the Riesz transform as brightness.
#[must_use]
pub fn monogenic_orientation(planes: &MonogenicPlanes) -> Array2<[u8; 3]> {
    polar(planes, |response| {
        let riesz = response.along_x.hypot(response.along_y);
        let theta = response.theta_rad().unwrap_or(0.0);
        Complex32::from_polar(riesz, 2.0 * theta)
    })
}

fn polar(
    planes: &MonogenicPlanes,
    number: impl Fn(MonogenicResponse) -> Complex32,
) -> Array2<[u8; 3]> {
    let numbers = Array2::from_shape_fn(planes.size().dim(), |(y, x)| number(planes.at(x, y)));
    let full = hue::full_brightness(numbers.iter().copied());
    hue::paint(numbers.view(), full)
}

fn with_bar(plane: &Array2<f32>, range: ColourRange) -> Array2<[u8; 3]> {
    scale_bar::beneath(colour::paint(plane.view(), range).view(), range, "")
}

#[cfg(test)]
mod tests {
    use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};

    use super::*;

    /// Vertical bars are seen as 0 degrees, drawn red; the orientation across them stays dark.
    #[test]
    fn bars_have_the_colours_that_are_promised() {
        let size = Size {
            width: 48,
            height: 40,
        };
        let params = GaborParams {
            scales: 1,
            ..GaborParams::default()
        };
        let bars = Array2::from_shape_fn(size.dim(), |(_, x)| {
            0.5 + 0.3 * (1.5 * (x as f32 - 24.0)).cos()
        });
        let bank = FilterBank::plan(params, size).unwrap();
        let seen = bank.respond(&LumaImage::new(bars).unwrap()).unwrap();
        let finest = &seen.scales()[0];
        let [red, green, blue] = dominant_orientation(&finest.dominant_orientation())[[20, 24]];
        assert!(red > green.max(blue), "{red} {green} {blue}");
        let pictures = responses(finest);
        // Column 24 is a bright line: phase 0.
        let [red, green, blue] = pictures[0][[20, 24]];
        assert!(red > 100 && red > green.max(blue), "{red} {green} {blue}");
        assert!(pictures[4][[20, 24]].iter().all(|&channel| channel < 30));
        let energy_there = total_energy(finest)[[20, 24]];
        assert!((0.0225..0.05).contains(&energy_there), "{energy_there}");
        assert_eq!(by_orientation(pictures).dim().1, COLUMNS * 52 + 4);
    }
}
