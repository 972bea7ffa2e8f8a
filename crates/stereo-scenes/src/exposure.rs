use ndarray::{Array3, Axis};
use rayon::prelude::*;

use crate::{eye::Eye, noise::mix, stage::Stage};

/// How the eyes turn light into samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposure {
    /// Rays along each side of a pixel, from 1 to 16: `samples * samples` rays are averaged, and
    /// four times as many in a pixel where they meet more than one surface.
    pub samples: usize,
    /// Standard deviation of Gaussian noise, the same in all colours of a pixel and independent
    /// between pixels and eyes; 0 for none. Noisy samples may leave `[0, 1]`.
    pub noise_sigma: f32,
    /// Chooses the noise.
    pub noise_seed: u32,
    /// What the right eye's samples are multiplied by before the noise; 1 for equal eyes.
    pub right_gain: f32,
}

impl Default for Exposure {
    /// Four rays a pixel (sixteen on outlines), no noise, equal eyes.
    fn default() -> Self {
        Self {
            samples: 2,
            noise_sigma: 0.0,
            noise_seed: 0,
            right_gain: 1.0,
        }
    }
}

/// Pixels of a row that share one list of bodies to try.
const SEGMENT: usize = 32;

/// Colours `[[y, x, channel]]` of the image of one eye, without noise.
pub(crate) fn expose(stage: &Stage<'_>, eye: &Eye, samples: usize) -> Array3<f32> {
    let mut colour = Array3::zeros((eye.size.height, eye.size.width, 3));
    // Texture has no detail below a pixel, so a few rays do inside a surface; at an outline a few
    // more make the mixture of the two surfaces right.
    let (inside, outline) = (Lattice::new(samples), Lattice::new(2 * samples));
    // Rows are independent, so that the threads cannot change a bit.
    let rows: Vec<_> = colour.axis_iter_mut(Axis(0)).enumerate().collect();
    rows.into_par_iter().for_each(|(y, mut row)| {
        let mut among = Vec::new();
        for (x, mut pixel) in row.outer_iter_mut().enumerate() {
            if starts_segment(x) {
                among = candidates(stage, eye, x, y);
            }
            let (mut mean, surfaces) = average(stage, eye, &inside, (x, y), &among);
            if surfaces == Surfaces::Several {
                mean = average(stage, eye, &outline, (x, y), &among).0;
            }
            for (channel, value) in pixel.iter_mut().zip(mean) {
                *channel = value;
            }
        }
    });
    colour
}

/// Where the rays of a pixel go: the middles of equal squares.
struct Lattice {
    /// Along one side, from the pixel's centre.
    offsets: Vec<f64>,
}

impl Lattice {
    fn new(samples: usize) -> Self {
        let middle = |k: usize| (k as f64 + 0.5) / samples as f64 - 0.5;
        Self {
            offsets: (0..samples).map(middle).collect(),
        }
    }
}

/// Whether the rays of a pixel met one surface.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Surfaces {
    One,
    Several,
}

/// The mean colour of a pixel.
fn average(
    stage: &Stage<'_>,
    eye: &Eye,
    lattice: &Lattice,
    (x, y): (usize, usize),
    among: &[usize],
) -> ([f32; 3], Surfaces) {
    let mut sum = [0.0; 3];
    let mut first = None;
    let mut surfaces = Surfaces::One;
    for down in &lattice.offsets {
        for right in &lattice.offsets {
            let direction = eye.ray(x as f64 + right, y as f64 + down);
            let hit = stage.first_hit(eye.origin(), direction, among);
            if *first.get_or_insert(hit.surface) != hit.surface {
                surfaces = Surfaces::Several;
            }
            let radiance = stage.radiance(eye.origin() + direction * hit.t, hit.surface);
            for (channel, value) in sum.iter_mut().zip(radiance) {
                *channel += value;
            }
        }
    }
    let samples = lattice.offsets.len();
    let share = ((samples * samples) as f32).recip();
    (sum.map(|channel| channel * share), surfaces)
}

/// The bodies that pixels `x .. x + SEGMENT` of row `y` may see.
pub(crate) fn candidates(stage: &Stage<'_>, eye: &Eye, x: usize, y: usize) -> Vec<usize> {
    let (left, right) = (x as f64 - 0.5, (x + SEGMENT) as f64 - 0.5);
    let axis = eye.ray(f64::midpoint(left, right), y as f64);
    let half_angle = [left, right]
        .into_iter()
        .flat_map(|u| [-0.5, 0.5].map(|v| eye.ray(u, y as f64 + v)))
        .map(|corner| {
            (axis.dot(corner) / (axis.length() * corner.length()))
                .clamp(-1.0, 1.0)
                .acos()
        })
        .fold(0.0, f64::max);
    stage.in_cone(eye.origin(), axis, half_angle)
}

/// Whether row-wise work at column `x` starts a new segment of [`candidates`].
pub(crate) const fn starts_segment(x: usize) -> bool {
    x.is_multiple_of(SEGMENT)
}

/// Multiplies an image by a gain and adds Gaussian noise that depends on the pixel and the seed.
pub(crate) fn disturb(colour: &mut Array3<f32>, gain: f32, sigma: f32, seed: u32) {
    if gain == 1.0 && sigma == 0.0 {
        return;
    }
    let rows: Vec<_> = colour.axis_iter_mut(Axis(0)).enumerate().collect();
    rows.into_par_iter().for_each(|(y, mut row)| {
        for (x, mut pixel) in row.outer_iter_mut().enumerate() {
            let noise = sigma * gaussian(mix(mix(x as u32 ^ seed).wrapping_add(y as u32)));
            pixel.mapv_inplace(|value| gain * value + noise);
        }
    });
}

/// A standard normal number from 32 random bits, by Box and Muller's transform.
fn gaussian(bits: u32) -> f32 {
    let unit = |bits: u32| ((bits >> 8) as f32 + 0.5) / 16_777_216.0;
    let (radius, turn) = (unit(mix(bits)), unit(mix(bits ^ 0x5BD1_E995)));
    (-2.0 * radius.ln()).sqrt() * (std::f32::consts::TAU * turn).cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean 0 and spread 1 over many pixels: the transform is the normal one.
    #[test]
    fn noise_is_standard_normal() {
        let values: Vec<f64> = (0..100_000).map(|k| f64::from(gaussian(mix(k)))).collect();
        let mean = values.iter().sum::<f64>() / 1e5;
        let spread = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 1e5).sqrt();
        // The standard error of the mean is 0.003, of the spread 0.002: five of each.
        assert!(mean.abs() < 0.016, "mean {mean}");
        assert!((spread - 1.0).abs() < 0.012, "spread {spread}");
    }
}
