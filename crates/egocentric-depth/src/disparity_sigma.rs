use disparity_pyramid::DisparityField;
use ndarray::Array2;

use crate::roughness_px;

/// How uncertain the disparities of a field are: one standard deviation in pixels, fitted to the
/// errors of real pairs.
///
/// A confidence says which pixels of a pair are better than others, and the roughness of the field
/// ([`roughness_px`]) how good those of this pair are: sigma is the product of a curve over the
/// confidence and the roughness. `1.96` of it hold the truth in 95 % of the pixels; errors have heavier
/// tails than a normal distribution, so `1` of it holds more than 68 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisparitySigma {
    per_roughness: [f64; Self::KNOTS],
}

impl DisparitySigma {
    /// How many confidences it is fitted at.
    pub const KNOTS: usize = 8;

    /// The confidences it is fitted at, ascending.
    pub const CONFIDENCES: [f32; Self::KNOTS] = [0.3, 0.5, 0.7, 0.8, 0.88, 0.94, 0.97, 1.0];

    /// No field is so smooth that its sigma would count as less than this roughness's, in pixels.
    pub const LEAST_ROUGHNESS_PX: f64 = 0.05;

    /// A standard deviation at each of [`DisparitySigma::CONFIDENCES`], as a part of the field's
    /// roughness.
    #[must_use]
    pub const fn new(per_roughness: [f64; Self::KNOTS]) -> Self {
        Self { per_roughness }
    }

    /// The standard deviation at each of [`DisparitySigma::CONFIDENCES`], as a part of the field's
    /// roughness.
    #[must_use]
    pub const fn per_roughness(&self) -> [f64; Self::KNOTS] {
        self.per_roughness
    }

    /// One standard deviation of a disparity of this confidence in a field of this roughness, in pixels:
    /// linear between the knots, and beyond them as at the outermost.
    #[must_use]
    pub fn px(&self, confidence: f32, roughness_px: f64) -> f64 {
        let knots = Self::CONFIDENCES;
        let above = knots.iter().position(|&knot| confidence < knot);
        let part = match above {
            Some(0) => self.per_roughness[0],
            None => self.per_roughness[Self::KNOTS - 1],
            Some(above) => {
                let (low, high) = (knots[above - 1], knots[above]);
                let along = f64::from((confidence - low) / (high - low));
                self.per_roughness[above - 1] * (1.0 - along) + self.per_roughness[above] * along
            }
        };
        part * roughness_px.max(Self::LEAST_ROUGHNESS_PX)
    }

    /// One standard deviation of every disparity of a field, in pixels, `[[y, x]]`; infinite where the
    /// field has no answer.
    #[must_use]
    pub fn of(&self, field: &DisparityField) -> Array2<f32> {
        let Some(roughness_px) = roughness_px(field) else {
            return Array2::from_elem(field.size().dim(), f32::INFINITY);
        };
        let mut sigma = field
            .confidence()
            .mapv(|confidence| self.px(confidence, roughness_px) as f32);
        sigma.zip_mut_with(&field.validity(), |sigma, validity| {
            if !validity.is_valid() {
                *sigma = f32::INFINITY;
            }
        });
        sigma
    }
}

impl Default for DisparitySigma {
    /// The vector pyramid's, as `cargo xtask calibrate-confidence` fits it to twelve pairs;
    /// docs/confidence.md says how often it holds on a pair that was left out.
    fn default() -> Self {
        Self::new([4.830, 1.197, 0.834, 0.720, 0.658, 0.602, 0.596, 0.596])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_read_between_the_knots() {
        let mut knots = [1.0; DisparitySigma::KNOTS];
        (knots[0], knots[1]) = (3.0, 2.0);
        let sigma = DisparitySigma::new(knots);
        assert!((sigma.px(0.4, 1.0) - 2.5).abs() < 1e-6);
        assert_eq!(
            (sigma.px(0.0, 2.0), sigma.px(1.0, 0.5), sigma.px(2.0, 1.0)),
            (6.0, 0.5, 1.0)
        );
        assert_eq!(sigma.px(1.0, 0.0), DisparitySigma::LEAST_ROUGHNESS_PX);
        let fitted = DisparitySigma::default().per_roughness();
        assert!(fitted.windows(2).all(|pair| pair[0] >= pair[1]));
    }
}
