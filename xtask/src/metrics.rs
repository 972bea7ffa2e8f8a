use ndarray::{ArrayView2, Zip};
use serde::Serialize;

/// How far estimated disparities lie from true ones, over some pixels of one scene.
///
/// An error is `d estimated - d true` in pixels, in the sign of files (positive = nearer), so a
/// positive signed mean says that the scene is seen too near.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Metrics {
    /// Pixels of the mask.
    pub(crate) asked: usize,
    /// Pixels of the mask that have an estimate; every error is taken over these.
    pub(crate) answered: usize,
    /// `answered / asked`, from 0 to 1.
    pub(crate) density: f64,
    /// Mean absolute error, px.
    pub(crate) mean_absolute: f64,
    /// Standard deviation of the absolute error, px.
    pub(crate) std_absolute: f64,
    /// Mean error with its sign, px.
    pub(crate) signed_mean: f64,
    /// Root of the mean squared error, px.
    pub(crate) rms: f64,
    /// Per cent of the answered pixels whose absolute error is above 0.5, 1, 2 and 4 px.
    pub(crate) bad: Bad,
}

/// Per cent of pixels that are wrong by more than a threshold.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Bad {
    /// Above half a pixel.
    #[serde(rename = "0.5")]
    pub(crate) half: f64,
    /// Above one pixel.
    #[serde(rename = "1")]
    pub(crate) one: f64,
    /// Above two pixels.
    #[serde(rename = "2")]
    pub(crate) two: f64,
    /// Above four pixels.
    #[serde(rename = "4")]
    pub(crate) four: f64,
}

impl Metrics {
    /// Compares planes `[[y, x]]` of disparity `d` where the mask counts. NaN is unknown: an
    /// unknown truth never counts, an unknown estimate lowers the density. `None` if no pixel is
    /// left to compare.
    pub(crate) fn of(
        estimate: ArrayView2<'_, f32>,
        truth: ArrayView2<'_, f32>,
        mask: ArrayView2<'_, bool>,
    ) -> Option<Self> {
        let mut asked = 0;
        let mut errors = Vec::new();
        Zip::from(estimate)
            .and(truth)
            .and(mask)
            .for_each(|&estimate, &truth, &counts| {
                if counts && truth.is_finite() {
                    asked += 1;
                    if estimate.is_finite() {
                        errors.push(f64::from(estimate) - f64::from(truth));
                    }
                }
            });
        if errors.is_empty() {
            return None;
        }
        let mean = |of: &dyn Fn(f64) -> f64| {
            errors.iter().map(|&error| of(error)).sum::<f64>() / errors.len() as f64
        };
        let mean_absolute = mean(&f64::abs);
        let bad =
            |threshold_px: f64| 100.0 * mean(&|e| f64::from(u8::from(e.abs() > threshold_px)));
        Some(Self {
            asked,
            answered: errors.len(),
            density: errors.len() as f64 / asked as f64,
            mean_absolute,
            // About its mean: the difference of two mean squares would cancel.
            std_absolute: mean(&|e| (e.abs() - mean_absolute).powi(2)).sqrt(),
            signed_mean: mean(&|e| e),
            rms: mean(&|e| e * e).sqrt(),
            bad: Bad {
                half: bad(0.5),
                one: bad(1.0),
                two: bad(2.0),
                four: bad(4.0),
            },
        })
    }

    /// The measures as cells of a table: mean, std, signed mean, RMS, bad-0.5, -1, -2 and -4 and
    /// density in per cent, pixels.
    pub(crate) fn cells(&self) -> [String; 10] {
        [
            format!("{:.3}", self.mean_absolute),
            format!("{:.3}", self.std_absolute),
            format!("{:+.3}", self.signed_mean),
            format!("{:.3}", self.rms),
            format!("{:.2}", self.bad.half),
            format!("{:.2}", self.bad.one),
            format!("{:.2}", self.bad.two),
            format!("{:.2}", self.bad.four),
            format!("{:.1}", 100.0 * self.density),
            self.answered.to_string(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use ndarray::{Array2, array};
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_plane_done_by_hand() {
        let unknown = f32::NAN;
        let truth = array![[1.0, 2.0, 3.0, unknown], [4.0, 5.0, 6.0, 7.0]];
        let estimate = array![[1.0, 4.5, 2.0, 9.0], [unknown, 9.5, 0.0, 0.0]];
        // The last row's two right pixels are masked out.
        let mask = array![[true, true, true, true], [true, true, false, false]];
        let metrics = Metrics::of(estimate.view(), truth.view(), mask.view()).unwrap();
        // Errors 0, 2.5, -1 and 4.5 at four of five pixels.
        assert_eq!((metrics.asked, metrics.answered), (5, 4));
        assert_eq!(metrics.density, 0.8);
        assert_eq!(metrics.mean_absolute, 2.0);
        assert_eq!(metrics.signed_mean, 1.5);
        assert_eq!(metrics.rms, (27.5f64 / 4.0).sqrt());
        assert_eq!(metrics.std_absolute, (11.5f64 / 4.0).sqrt());
        let bad = metrics.bad;
        // An error of exactly one pixel is not above one pixel.
        assert_eq!(
            [bad.half, bad.one, bad.two, bad.four],
            [75.0, 50.0, 50.0, 25.0]
        );
    }

    #[test]
    fn nothing_to_compare_is_no_metrics() {
        let known = array![[1.0, 2.0]];
        let unknown = array![[f32::NAN, f32::NAN]];
        let (all, none) = (array![[true, true]], array![[false, false]]);
        assert_eq!(Metrics::of(known.view(), unknown.view(), all.view()), None);
        assert_eq!(Metrics::of(unknown.view(), known.view(), all.view()), None);
        assert_eq!(Metrics::of(known.view(), known.view(), none.view()), None);
    }

    /// A plane of disparities in which some pixels are unknown.
    fn plane() -> impl Strategy<Value = Array2<f32>> {
        let sample = prop_oneof![4 => 0.0f32..60.0, 1 => Just(f32::NAN)];
        prop::collection::vec(sample, 24)
            .prop_map(|samples| Array2::from_shape_vec((4, 6), samples).unwrap())
    }

    proptest! {
        /// The identities that tie the measures together hold for every pair of planes.
        #[test]
        fn the_measures_agree(
            estimate in plane(),
            truth in plane(),
            mask in prop::collection::vec(any::<bool>(), 24),
        ) {
            let mask = Array2::from_shape_vec((4, 6), mask).unwrap();
            let Some(metrics) = Metrics::of(estimate.view(), truth.view(), mask.view()) else {
                return Ok(());
            };
            // Sums of at most 24 squares below 3600, in f64.
            let close = |a: f64, b: f64| (a - b).abs() < 1e-9 * (1.0 + a.abs());
            let squared = metrics.rms.powi(2);
            prop_assert!(close(squared, metrics.mean_absolute.powi(2) + metrics.std_absolute.powi(2)));

            let errors: Vec<f64> = estimate.iter().zip(&truth).zip(&mask)
                .filter(|((e, t), counts)| **counts && e.is_finite() && t.is_finite())
                .map(|((e, t), _)| f64::from(*e) - f64::from(*t))
                .collect();
            let signed_variance = errors.iter().map(|e| (e - metrics.signed_mean).powi(2)).sum::<f64>()
                / errors.len() as f64;
            prop_assert!(close(squared, metrics.signed_mean.powi(2) + signed_variance));

            prop_assert!(metrics.signed_mean.abs() <= metrics.mean_absolute + 1e-9);
            prop_assert!(metrics.bad.half >= metrics.bad.one);
            prop_assert!(metrics.bad.one >= metrics.bad.two);
            prop_assert!(metrics.bad.two >= metrics.bad.four);
            prop_assert_eq!(metrics.answered, errors.len());
            let asked = truth.iter().zip(&mask).filter(|(t, counts)| t.is_finite() && **counts).count();
            prop_assert_eq!(metrics.density, errors.len() as f64 / asked as f64);
        }

        /// A truth compared with itself is without error.
        #[test]
        fn the_truth_is_true(truth in plane()) {
            let all = Array2::from_elem(truth.dim(), true);
            if let Some(metrics) = Metrics::of(truth.view(), truth.view(), all.view()) {
                prop_assert_eq!((metrics.rms, metrics.bad.half, metrics.density), (0.0, 0.0, 1.0));
            }
        }
    }
}
