use disparity_pyramid::{DisparityField, Validity};
use ndarray::Array2;
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::neighbours::Neighbours;

/// How uncertain the disparities of a field are: one standard deviation in pixels, fitted to the
/// errors of real pairs.
///
/// A confidence says which pixels of a pair are better than others, and the roughness of the field
/// ([`roughness_px`](crate::roughness_px)) how good those of this pair are: sigma is the product of a curve over the
/// confidence and the roughness, or its cube root. `1.96` of it hold the truth in 95 % of the pixels; errors
/// have heavier tails than a normal distribution, so `1` of it holds more than 68 %.
///
/// Every estimator has its own: [`DisparitySigma::VECTOR`], [`DisparitySigma::DENSE_BEST`] and
/// [`DisparitySigma::DENSE_FAST`], as `cargo xtask calibrate-confidence` fits them to twelve pairs;
/// docs/confidence.md says how often they hold on a pair that was left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisparitySigma {
    curve: [f64; Self::KNOTS],
    kind: Kind,
}

/// Which roughness, and how it counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Of both components; errors grow as it does.
    Vector,
    /// Of `dx`; errors grow as its cube root.
    AlongRows,
}

impl DisparitySigma {
    /// How many confidences it is fitted at.
    pub const KNOTS: usize = 8;

    /// The confidences it is fitted at, ascending.
    pub const CONFIDENCES: [f32; Self::KNOTS] = [0.3, 0.5, 0.7, 0.8, 0.88, 0.94, 0.97, 1.0];

    /// No field is so smooth that its sigma would count as less than this roughness's, in pixels.
    pub const LEAST_ROUGHNESS_PX: f64 = 0.05;

    /// The vector pyramid's: errors grow as the roughness does.
    pub const VECTOR: Self =
        Self::of_vectors([2.102, 1.310, 0.886, 0.742, 0.682, 0.623, 0.568, 0.565]);

    /// The dense estimator's with [`DenseParams::best`](disparity_pyramid::DenseParams::best).
    pub const DENSE_BEST: Self =
        Self::along_rows([9.486, 9.486, 9.486, 4.142, 0.687, 0.305, 0.261, 0.221]);

    /// The dense estimator's with [`DenseParams::fast`](disparity_pyramid::DenseParams::fast).
    pub const DENSE_FAST: Self =
        Self::along_rows([9.801, 9.801, 9.801, 4.804, 1.039, 0.347, 0.289, 0.237]);

    /// For fields of vectors: a standard deviation at each of [`DisparitySigma::CONFIDENCES`] in a field
    /// whose roughness is one pixel, in pixels.
    #[must_use]
    pub const fn of_vectors(curve: [f64; Self::KNOTS]) -> Self {
        Self {
            curve,
            kind: Kind::Vector,
        }
    }

    /// The same for fields that were found along rows. Such an estimator follows edges that the vector
    /// pyramid rounds, which makes a field rough and little worse: its errors grow as the cube root of the
    /// roughness of `dx`.
    #[must_use]
    pub const fn along_rows(curve: [f64; Self::KNOTS]) -> Self {
        Self {
            curve,
            kind: Kind::AlongRows,
        }
    }

    /// The standard deviation at each of [`DisparitySigma::CONFIDENCES`] in a field whose roughness is
    /// one pixel, in pixels.
    #[must_use]
    pub const fn curve(&self) -> [f64; Self::KNOTS] {
        self.curve
    }

    /// The roughness that counts here, in pixels; `None` of a field without valid shifts.
    #[must_use]
    pub fn roughness_px(&self, field: &DisparityField) -> Option<f64> {
        self.roughness_in(field, &mut Neighbours::default())
    }

    fn roughness_in(&self, field: &DisparityField, neighbours: &mut Neighbours) -> Option<f64> {
        match self.kind {
            Kind::Vector => neighbours.roughness_px(field),
            Kind::AlongRows => neighbours.roughness_across_px(field),
        }
    }

    /// What every sigma of a field of this roughness is a multiple of: the roughness in pixels for the
    /// vector pyramid, its cube root for the dense estimator.
    #[must_use]
    pub fn scale(&self, roughness_px: f64) -> f64 {
        let roughness_px = roughness_px.max(Self::LEAST_ROUGHNESS_PX);
        match self.kind {
            Kind::Vector => roughness_px,
            Kind::AlongRows => roughness_px.cbrt(),
        }
    }

    /// One standard deviation of a disparity of this confidence in a field of this roughness, in pixels:
    /// linear between the knots, and beyond them as at the outermost.
    #[must_use]
    pub fn px(&self, confidence: f32, roughness_px: f64) -> f64 {
        self.part(confidence) * self.scale(roughness_px)
    }

    /// The curve at a confidence.
    fn part(&self, confidence: f32) -> f64 {
        let knots = Self::CONFIDENCES;
        match knots.iter().position(|&knot| confidence < knot) {
            Some(0) => self.curve[0],
            None => self.curve[Self::KNOTS - 1],
            Some(above) => {
                let (low, high) = (knots[above - 1], knots[above]);
                let along = f64::from((confidence - low) / (high - low));
                self.curve[above - 1] * (1.0 - along) + self.curve[above] * along
            }
        }
    }

    /// One standard deviation of every disparity of a field, in pixels, `[[y, x]]`; infinite where the
    /// field has no answer.
    #[must_use]
    pub fn of(&self, field: &DisparityField) -> Array2<f32> {
        let mut sigma = Array2::zeros((0, 0));
        self.of_into(field, &mut SigmaWorkspace::default(), &mut sigma);
        sigma
    }

    /// The same, written over an earlier plane, in buffers that are kept.
    pub fn of_into(
        &self,
        field: &DisparityField,
        workspace: &mut SigmaWorkspace,
        sigma: &mut Array2<f32>,
    ) {
        if sigma.dim() != field.size().dim() {
            *sigma = Array2::zeros(field.size().dim());
        }
        // Without a roughness there is no answer either.
        let roughness_px = self.roughness_in(field, &mut workspace.neighbours);
        let scale = roughness_px.map_or(f64::INFINITY, |px| self.scale(px));
        let curve = Curve::of(self, scale);
        let (confidence, validity) = (field.confidence(), field.validity());
        let width = field.size().width;
        let (Some(confidence), Some(validity), Some(sigma)) = (
            confidence.to_slice(),
            validity.to_slice(),
            sigma.as_slice_mut(),
        ) else {
            unreachable!("fields are kept in row-major order")
        };
        sigma
            .par_chunks_mut(width)
            .zip(confidence.par_chunks(width))
            .zip(validity.par_chunks(width))
            .for_each(|((sigma, confidence), validity)| {
                Arch::new().dispatch(Row {
                    curve: &curve,
                    confidence,
                    validity,
                    sigma,
                });
            });
    }
}

/// The curve of one field, as it is read for many pixels side by side: from the first knot on each stretch
/// adds what of its change lies before the confidence.
struct Curve {
    first: f32,
    /// Where each stretch begins, one over its length, and how much it changes.
    stretches: [(f32, f32, f32); DisparitySigma::KNOTS - 1],
}

impl Curve {
    fn of(sigma: &DisparitySigma, scale: f64) -> Self {
        let knots = DisparitySigma::CONFIDENCES;
        let px = sigma.curve.map(|part| (part * scale) as f32);
        Self {
            first: px[0],
            stretches: std::array::from_fn(|i| {
                let change = if scale.is_finite() {
                    px[i + 1] - px[i]
                } else {
                    0.0
                };
                (knots[i], 1.0 / (knots[i + 1] - knots[i]), change)
            }),
        }
    }
}

/// The sigmas of one row.
struct Row<'a> {
    curve: &'a Curve,
    confidence: &'a [f32],
    validity: &'a [Validity],
    sigma: &'a mut [f32],
}

impl NullaryFnOnce for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let width = self.sigma.len();
        let (confidence, validity) = (&self.confidence[..width], &self.validity[..width]);
        for x in 0..width {
            let mut px = self.curve.first;
            for (start, per_length, change) in self.curve.stretches {
                let along = (confidence[x] - start) * per_length;
                let along = if along > 0.0 { along } else { 0.0 };
                px += change * if along < 1.0 { along } else { 1.0 };
            }
            let heard = validity[x] == Validity::Valid;
            self.sigma[x] = if heard { px } else { f32::INFINITY };
        }
    }
}

/// Buffers that [`DisparitySigma::of_into`] works in, kept from field to field: about four bytes a pixel.
#[derive(Clone, Debug, Default)]
pub struct SigmaWorkspace {
    neighbours: Neighbours,
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn it_is_read_between_the_knots() {
        let mut knots = [1.0; DisparitySigma::KNOTS];
        (knots[0], knots[1]) = (3.0, 2.0);
        let sigma = DisparitySigma::of_vectors(knots);
        assert!((sigma.px(0.4, 1.0) - 2.5).abs() < 1e-6);
        assert_eq!(
            (sigma.px(0.0, 2.0), sigma.px(1.0, 0.5), sigma.px(2.0, 1.0)),
            (6.0, 0.5, 1.0)
        );
        assert_eq!(sigma.px(1.0, 0.0), DisparitySigma::LEAST_ROUGHNESS_PX);
        // Eight times as rough, twice as uncertain.
        let dense = DisparitySigma::along_rows(knots);
        assert!((dense.px(1.0, 8.0) - 2.0).abs() < 1e-12);
    }

    proptest! {
        /// Rows in vectors say what single pixels are told.
        #[test]
        fn fast_and_plain_agree(confidence in prop::collection::vec(0.0f32..1.01, 1..70), scale in 0.05f64..4.0) {
            for fitted in [DisparitySigma::VECTOR, DisparitySigma::DENSE_BEST] {
                let validity = vec![Validity::Valid; confidence.len()];
                let mut sigma = vec![0.0; confidence.len()];
                let curve = Curve::of(&fitted, scale);
                Arch::new().dispatch(Row {
                    curve: &curve,
                    confidence: &confidence,
                    validity: &validity,
                    sigma: &mut sigma,
                });
                for (confidence, sigma) in confidence.iter().zip(&sigma) {
                    let plain = fitted.part(*confidence) * scale;
                    // Seven sums in single precision, the largest of them 50 times the least sigma.
                    prop_assert!((f64::from(*sigma) - plain).abs() < 2e-5 * fitted.curve[0] * scale);
                }
            }
        }
    }

    #[test]
    fn surer_is_no_less_certain() {
        for fitted in [
            DisparitySigma::VECTOR,
            DisparitySigma::DENSE_BEST,
            DisparitySigma::DENSE_FAST,
        ] {
            assert!(fitted.curve().windows(2).all(|pair| pair[0] >= pair[1]));
        }
    }
}
