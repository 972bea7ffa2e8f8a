use std::f32::consts::PI;

use ndarray::{Array2, Zip};
use num_complex::Complex32;

use crate::Responses;

/// The direction in which brightness changes most, and how much it outweighs the others.
#[derive(Clone, Debug, PartialEq)]
pub struct DominantOrientation {
    /// `[[y, x]]`: the direction of the wave vector in radians, in `[0, pi)`, like `theta_q`;
    /// bars and edges lie across it. NaN where there is no energy, or the same in all directions.
    pub theta_rad: Array2<f32>,
    /// `[[y, x]]`: 0 where all orientations have the same energy, 1 if one had all of it. NaN
    /// where there is no energy.
    ///
    /// The tuning of the filters bounds it from above: 0.8 for a grating, with the default bank.
    pub strength: Array2<f32>,
}

impl Responses {
    /// The dominant orientation at every pixel: the structure of the energies over orientations.
    ///
    /// `S = sum_q E_q exp(2 j theta_q)`, `theta = arg(S) / 2`, `strength = |S| / sum_q E_q`. Angles
    /// are doubled because a direction and its opposite are one orientation.
    #[must_use]
    pub fn dominant_orientation(&self) -> DominantOrientation {
        let orientations = self.orientations();
        let doubled: Vec<Complex32> = (0..orientations)
            .map(|q| Complex32::cis(2.0 * PI * q as f32 / orientations as f32))
            .collect();
        let dim = self.size().dim();
        let mut dominant = DominantOrientation {
            theta_rad: Array2::zeros(dim),
            strength: Array2::zeros(dim),
        };
        Zip::indexed(&mut dominant.theta_rad)
            .and(&mut dominant.strength)
            .for_each(|(y, x), theta, strength| {
                let pixel = self.pixel(x, y);
                let mut total = 0.0;
                let mut sum = Complex32::ZERO;
                for ((even, odd), direction) in pixel.even.iter().zip(pixel.odd).zip(&doubled) {
                    let energy = even * even + odd * odd;
                    total += energy;
                    sum += energy * direction;
                }
                *theta = match sum.norm() > 0.0 {
                    // The remainder of a tiny negative angle may round up to pi itself.
                    true => (sum.arg() / 2.0).rem_euclid(PI) % PI,
                    false => f32::NAN,
                };
                *strength = sum.norm() / total;
            });
        dominant
    }
}
