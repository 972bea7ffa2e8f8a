use ndarray::{Array2, ArrayView2};
use serde::Serialize;
use v1_gabor::Size;

use crate::homography::Homography;
use crate::resample::resample;

/// What befalls the right camera of a rectified pair: out of place, out of focus, another exposure,
/// noise. [`Alteration::NONE`] leaves it alone.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Alteration {
    /// The picture lies lower by this much, px.
    pub(crate) down_px: f64,
    /// The picture is turned clockwise about its middle, degrees.
    pub(crate) roll_deg: f64,
    /// The camera nods up, degrees, at a focal length of the picture's width.
    pub(crate) pitch_deg: f64,
    /// The picture is larger about its middle, per cent.
    pub(crate) scale_percent: f64,
    /// Standard deviation of a Gaussian blur, px.
    pub(crate) blur_px: f64,
    /// Exponent of luma from 0 to 1.
    pub(crate) gamma: f64,
    /// Factor on luma.
    pub(crate) gain: f64,
    /// What is added to it, grey levels of 255.
    pub(crate) offset_grey: f64,
    /// Standard deviation of Gaussian noise, grey levels of 255.
    pub(crate) noise_grey: f64,
    /// Whether the left camera has noise of its own, equally strong.
    pub(crate) both_noisy: bool,
}

impl Alteration {
    /// Nothing.
    pub(crate) const NONE: Self = Self {
        down_px: 0.0,
        roll_deg: 0.0,
        pitch_deg: 0.0,
        scale_percent: 0.0,
        blur_px: 0.0,
        gamma: 1.0,
        gain: 1.0,
        offset_grey: 0.0,
        noise_grey: 0.0,
        both_noisy: false,
    };

    /// Where the altered right camera sees what the true one sees at a place.
    pub(crate) fn warp(&self, size: Size) -> Homography {
        Homography::scale(1.0 + self.scale_percent / 100.0, size)
            .then(Homography::roll(self.roll_deg, size))
            .then(Homography::pitch(self.pitch_deg, size.width as f64, size))
            .then(Homography::down(self.down_px))
    }

    /// The left picture as it is seen, in grey levels: noisy if both cameras are.
    pub(crate) fn of_left(&self, luma: ArrayView2<'_, f32>) -> Array2<u8> {
        let sigma = if self.both_noisy {
            self.noise_grey
        } else {
            0.0
        };
        develop(luma.to_owned(), sigma, 1)
    }

    /// The right picture as the altered camera sees it, in grey levels, in the order of a camera:
    /// place, focus, exposure, noise, eight bits.
    pub(crate) fn of_right(&self, luma: ArrayView2<'_, f32>) -> Array2<u8> {
        let warp = self.warp(Size::of_dim(luma.dim()));
        let placed = if warp == Homography::IDENTITY {
            luma.to_owned()
        } else {
            let back = warp.inverse();
            resample(luma, |x, y| back.at(x, y))
        };
        let seen = blur(placed, self.blur_px).mapv_into(|luma| {
            let curved = f64::from(luma).clamp(0.0, 1.0).powf(self.gamma);
            (self.gain * curved + self.offset_grey / 255.0) as f32
        });
        develop(seen, self.noise_grey, 2)
    }
}

/// Eight bits of luma with Gaussian noise. The same seed gives the same noise on every machine.
fn develop(luma: Array2<f32>, sigma_grey: f64, seed: u64) -> Array2<u8> {
    let mut noise = Noise::new(seed);
    luma.mapv(|luma| {
        let grain = if sigma_grey > 0.0 {
            sigma_grey * noise.gaussian()
        } else {
            0.0
        };
        (255.0 * f64::from(luma) + grain).round().clamp(0.0, 255.0) as u8
    })
}

/// A separable Gaussian blur, borders repeated.
fn blur(plane: Array2<f32>, sigma_px: f64) -> Array2<f32> {
    if sigma_px <= 0.0 {
        return plane;
    }
    let radius = (4.0 * sigma_px).ceil() as isize;
    let taps: Vec<f64> = (-radius..=radius)
        .map(|k| (-0.5 * (k as f64 / sigma_px).powi(2)).exp())
        .collect();
    let total: f64 = taps.iter().sum();
    let along = |plane: &Array2<f32>, (step_y, step_x): (isize, isize)| {
        let (height, width) = plane.dim();
        let clamp = |at: isize, length: usize| at.clamp(0, length as isize - 1) as usize;
        Array2::from_shape_fn((height, width), |(y, x)| {
            let sum = (-radius..=radius).zip(&taps).map(|(k, tap)| {
                let row = clamp(y as isize + k * step_y, height);
                let column = clamp(x as isize + k * step_x, width);
                tap * f64::from(plane[[row, column]])
            });
            (sum.sum::<f64>() / total) as f32
        })
    };
    let across = along(&plane, (0, 1));
    along(&across, (1, 0))
}

/// Gaussian numbers from a shift register (xorshift64*), two uniform ones to each (Box and Muller).
struct Noise(u64);

impl Noise {
    const fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    /// Uniform in `(0, 1)`.
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_F491_4F6C_DD1D) >> 11;
        (bits as f64 + 0.5) / (1u64 << 53) as f64
    }

    fn gaussian(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp() -> Array2<f32> {
        Array2::from_shape_fn((40, 50), |(y, x)| (x + 2 * y) as f32 / 255.0)
    }

    #[test]
    fn nothing_changes_nothing() {
        let grey = ramp().mapv(|luma| (luma * 255.0).round() as u8);
        assert_eq!(Alteration::NONE.of_right(ramp().view()), grey);
        assert_eq!(Alteration::NONE.of_left(ramp().view()), grey);
    }

    #[test]
    fn a_lower_picture_shows_what_stood_above() {
        let lower = Alteration {
            down_px: 3.0,
            ..Alteration::NONE
        };
        let seen = lower.of_right(ramp().view());
        // The ramp has two grey levels a row.
        assert_eq!(seen[[20, 20]], 20 + 2 * 17);
        let size = Size {
            width: 50,
            height: 40,
        };
        assert_eq!(lower.warp(size).at(20.0, 17.0), (20.0, 20.0));
    }

    #[test]
    fn exposure_and_noise_are_what_they_say() {
        let grey = Array2::from_elem((100, 100), 100.0f32 / 255.0);
        let darker = Alteration {
            gain: 0.6,
            offset_grey: 20.0,
            ..Alteration::NONE
        };
        assert!(darker.of_right(grey.view()).iter().all(|&grey| grey == 80));
        let noisy = Alteration {
            noise_grey: 5.0,
            ..Alteration::NONE
        };
        assert!(noisy.of_left(grey.view()).iter().all(|&grey| grey == 100));
        let seen = noisy.of_right(grey.view());
        assert_eq!(seen, noisy.of_right(grey.view()));
        let of = |power: i32| {
            let sum: f64 = seen
                .iter()
                .map(|&g| (f64::from(g) - 100.0).powi(power))
                .sum();
            sum / seen.len() as f64
        };
        // Ten thousand samples: the mean to 0.05, the deviation to 0.04 in one standard deviation.
        assert!(of(1).abs() < 0.25 && (of(2).sqrt() - 5.0).abs() < 0.2);
    }

    #[test]
    fn a_blur_keeps_the_sum_and_spreads_it() {
        let mut point = Array2::zeros((21, 21));
        point[[10, 10]] = 1.0;
        let spread = blur(point, 1.5);
        assert!((spread.sum() - 1.0).abs() < 1e-5);
        let second: f32 = spread
            .indexed_iter()
            .map(|((_, x), &part)| part * (x as f32 - 10.0).powi(2))
            .sum();
        assert!((second.sqrt() - 1.5).abs() < 0.02);
    }
}
