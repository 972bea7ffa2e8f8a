use ndarray::{Array2, ArrayView2, Zip};
use serde::Serialize;

/// How well a confidence orders the errors: the part of bad pixels among the most confident ones,
/// averaged over all numbers of them from one to all (the area under the sparsification curve).
///
/// The ideal order puts the smaller error first. An order that knows nothing has the area of the
/// whole set's bad part.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Sparsification {
    /// By the estimator's confidence: per cent of errors above 1 px, averaged over the curve.
    pub(crate) area: f64,
    /// By the errors themselves.
    pub(crate) ideal: f64,
    /// Without any order: the bad part of the whole set, per cent.
    pub(crate) unordered: f64,
}

impl Sparsification {
    /// Compares planes `[[y, x]]` where the mask counts; `None` if no pixel is left.
    pub(crate) fn of(
        estimate: ArrayView2<'_, f32>,
        confidence: ArrayView2<'_, f32>,
        truth: ArrayView2<'_, f32>,
        mask: &Array2<bool>,
    ) -> Option<Self> {
        let mut pixels = Vec::new();
        Zip::from(estimate)
            .and(confidence)
            .and(truth)
            .and(mask)
            .for_each(|estimate, confidence, truth, counts| {
                let error = (estimate - truth).abs();
                if *counts && error.is_finite() {
                    pixels.push((*confidence, error));
                }
            });
        if pixels.is_empty() {
            return None;
        }
        // Equal confidences keep the order of the rows.
        pixels.sort_by(|a, b| b.0.total_cmp(&a.0));
        let area = area(&pixels);
        pixels.sort_by(|a, b| a.1.total_cmp(&b.1));
        let bad = pixels.iter().filter(|(_, error)| *error > 1.0).count();
        Some(Self {
            area,
            ideal: self::area(&pixels),
            unordered: 100.0 * bad as f64 / pixels.len() as f64,
        })
    }
}

/// The mean over all prefixes of their bad part, in per cent.
fn area(pixels: &[(f32, f32)]) -> f64 {
    let mut bad = 0u32;
    let parts = pixels.iter().enumerate().map(|(before, (_, error))| {
        bad += u32::from(*error > 1.0);
        f64::from(bad) / (before + 1) as f64
    });
    100.0 * parts.sum::<f64>() / pixels.len() as f64
}

#[cfg(test)]
mod tests {
    use ndarray::array;

    use super::*;

    #[test]
    fn a_good_order_is_ideal_and_a_bad_one_is_worse_than_none() {
        let truth = array![[5.0, 5.0, 5.0, f32::NAN]];
        let estimate = array![[5.0, 9.0, 5.5, 0.0]];
        let mask = Array2::from_elem((1, 4), true);
        let of = |confidence: Array2<f32>| {
            let curve = Sparsification::of(estimate.view(), confidence.view(), truth.view(), &mask);
            curve.unwrap()
        };
        let good = of(array![[0.9, 0.1, 0.5, 1.0]]);
        assert_eq!(good.area, good.ideal);
        // One bad pixel of three, last: (0 + 0 + 1/3) / 3.
        assert!((good.ideal - 100.0 / 9.0).abs() < 1e-9);
        let bad = of(array![[0.1, 0.9, 0.5, 1.0]]);
        assert!((bad.area - 100.0 * (1.0 + 0.5 + 1.0 / 3.0) / 3.0).abs() < 1e-9);
        assert!(bad.area > bad.unordered && bad.unordered > good.area);
    }
}
