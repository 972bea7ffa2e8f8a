use ndarray::{ArrayView2, Zip};
use serde::Serialize;
use stereo_formats::VectorPlanes;

/// How far an estimated flow lies from the true one, over the pixels whose truth is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct FlowErrors {
    /// Pixels whose truth is known.
    pub(crate) asked: usize,
    /// Those that have an estimate; every error is taken over these.
    pub(crate) answered: usize,
    /// `answered / asked`, from 0 to 1.
    pub(crate) density: f64,
    /// Mean length of the difference of the vectors, px.
    pub(crate) endpoint_mean: f64,
    /// Its standard deviation, px.
    pub(crate) endpoint_std: f64,
    /// Mean angle between `(u, v, 1)` of both, degrees.
    pub(crate) angular_mean_deg: f64,
    /// Its standard deviation, degrees.
    pub(crate) angular_std_deg: f64,
    /// Per cent of the answered pixels whose endpoint errs by more than 1 px.
    pub(crate) above_1: f64,
}

impl FlowErrors {
    /// Compares planes `[[y, x]]` with the truth; NaN is unknown. `None` if there is nothing to
    /// compare.
    pub(crate) fn of(
        u: ArrayView2<'_, f32>,
        v: ArrayView2<'_, f32>,
        truth: &VectorPlanes,
    ) -> Option<Self> {
        let mut asked = 0;
        let (mut endpoint, mut angular) = (Vec::new(), Vec::new());
        Zip::from(u)
            .and(v)
            .and(truth.dx())
            .and(truth.dy())
            .for_each(|&u, &v, &true_u, &true_v| {
                if true_u.is_finite() {
                    asked += 1;
                    if u.is_finite() && v.is_finite() {
                        let [u, v, true_u, true_v] = [u, v, true_u, true_v].map(f64::from);
                        endpoint.push((u - true_u).hypot(v - true_v));
                        angular.push(angle_deg([u, v, 1.0], [true_u, true_v, 1.0]));
                    }
                }
            });
        if endpoint.is_empty() {
            return None;
        }
        let (endpoint_mean, endpoint_std) = mean_and_std(&endpoint);
        let (angular_mean_deg, angular_std_deg) = mean_and_std(&angular);
        let above_1 = endpoint.iter().filter(|error| **error > 1.0).count();
        Some(Self {
            asked,
            answered: endpoint.len(),
            density: endpoint.len() as f64 / asked as f64,
            endpoint_mean,
            endpoint_std,
            angular_mean_deg,
            angular_std_deg,
            above_1: 100.0 * above_1 as f64 / endpoint.len() as f64,
        })
    }
}

/// The angle between two vectors, by way of its tangent: a cosine near 1 loses small angles.
fn angle_deg(a: [f64; 3], b: [f64; 3]) -> f64 {
    let across = [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ];
    let sine = across.iter().map(|part| part * part).sum::<f64>().sqrt();
    let cosine: f64 = a.iter().zip(b).map(|(a, b)| a * b).sum();
    sine.atan2(cosine).to_degrees()
}

fn mean_and_std(errors: &[f64]) -> (f64, f64) {
    let count = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / count;
    let variance = errors
        .iter()
        .map(|error| (error - mean).powi(2))
        .sum::<f64>()
        / count;
    (mean, variance.sqrt())
}

#[cfg(test)]
mod tests {
    use ndarray::array;

    use super::*;

    #[test]
    fn errors_of_a_field_by_hand() {
        let truth = VectorPlanes::new(
            array![[1.0, 0.0, f32::NAN, 2.0]],
            array![[0.0, 0.0, 0.0, 0.0]],
        )
        .unwrap();
        let (u, v) = (
            array![[1.0, 3.0, 9.0, f32::NAN]],
            array![[0.0, 4.0, 9.0, 0.0]],
        );
        let errors = FlowErrors::of(u.view(), v.view(), &truth).unwrap();
        assert_eq!((errors.asked, errors.answered), (3, 2));
        assert_eq!((errors.endpoint_mean, errors.endpoint_std), (2.5, 2.5));
        assert_eq!(errors.above_1, 50.0);
        // (3, 4, 1) against (0, 0, 1): the tangent is 5.
        let angle = 5f64.atan().to_degrees() / 2.0;
        assert!((errors.angular_mean_deg - angle).abs() < 1e-12);
        let unknown = array![[f32::NAN; 4]];
        assert!(FlowErrors::of(unknown.view(), v.view(), &truth).is_none());
    }
}
