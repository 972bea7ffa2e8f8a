//! A texture known at every place, so that the right eye's image is exact at any shift.
#![allow(dead_code, reason = "each test file uses a part of it")]

use std::f64::consts::TAU;

use ndarray::Array2;
use v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size, V1Responses};

/// Sinusoids of all directions, from coarse to 2.6 px a cycle, amplitudes falling with frequency
/// as they do in natural images.
pub(crate) struct Texture(Vec<(f64, f64, f64, f64)>);

impl Texture {
    pub(crate) fn new(seed: u64) -> Self {
        let mut state = seed.wrapping_mul(2).wrapping_add(1);
        let mut random = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        for _ in 0..8 {
            random();
        }
        let waves = (0..90).map(|_| {
            let frequency = 0.05 * 48f64.powf(random());
            let (direction, phase) = (random() * TAU, random() * TAU);
            let amplitude = 0.02 / frequency.sqrt();
            (
                frequency * direction.cos(),
                frequency * direction.sin(),
                phase,
                amplitude,
            )
        });
        Self(waves.collect())
    }

    pub(crate) fn at(&self, x: f64, y: f64) -> f32 {
        let wave = |&(u, v, phase, amplitude): &(f64, f64, f64, f64)| {
            amplitude * (u * x + v * y + phase).sin()
        };
        (0.5 + self.0.iter().map(wave).sum::<f64>()) as f32
    }
}

/// What two eyes say of images given by functions of the pixel.
pub(crate) fn respond(
    size: Size,
    left: impl Fn(f64, f64) -> f32,
    right: impl Fn(f64, f64) -> f32,
) -> Binocular<V1Responses> {
    let params = GaborParams::default().fitted_to(size);
    let bank = FilterBank::plan(params, size).expect("the parameters are fitted to the size");
    let draw = |luma: &dyn Fn(f64, f64) -> f32| {
        let plane = Array2::from_shape_fn(size.dim(), |(y, x)| luma(x as f64, y as f64));
        let image = LumaImage::new(plane).expect("textures are finite");
        bank.respond(&image)
            .expect("the image has the planned size")
    };
    Binocular {
        left: draw(&left),
        right: draw(&right),
    }
}
