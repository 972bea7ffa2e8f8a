//! Two estimates of one place become one.

use crate::ground_estimate::GroundEstimate;

/// A symmetric matrix `[[xx, xz], [xz, zz]]`.
type Covariance = [[f64; 2]; 2];

/// The square of how many standard errors two estimates lie apart.
pub(crate) fn mahalanobis_squared(first: &GroundEstimate, second: &GroundEstimate) -> f64 {
    let ([a, b], [c, d]) = (first.position_m(), second.position_m());
    let between = [c - a, d - b];
    let sum = add(first.covariance_m2(), second.covariance_m2());
    let seen = apply(inverse(sum), between);
    between[0] * seen[0] + between[1] * seen[1]
}

/// The fused estimate of two whose errors are independent: the Kalman update.
pub(crate) fn independent(first: &GroundEstimate, second: &GroundEstimate) -> GroundEstimate {
    weighted(first, second, 1.0, 1.0)
}

/// The fused estimate of two whose errors may be correlated in any way: covariance intersection,
/// which claims no more than is true for every correlation. Errors of a pose are of this kind, for
/// everything seen from it shares them.
pub(crate) fn correlated(first: &GroundEstimate, second: &GroundEstimate) -> GroundEstimate {
    // The trace is convex in the weight; sixteen steps come within a few percent of its least.
    let mut best = *first;
    for step in 0..=16 {
        let weight = f64::from(step) / 16.0;
        let fused = weighted(first, second, weight, 1.0 - weight);
        if trace(&fused) < trace(&best) {
            best = fused;
        }
    }
    best
}

/// The mean by the weighted inverses of the covariances, and the inverse of their sum.
fn weighted(
    first: &GroundEstimate,
    second: &GroundEstimate,
    first_weight: f64,
    second_weight: f64,
) -> GroundEstimate {
    let scaled = |estimate: &GroundEstimate, weight: f64| {
        inverse(estimate.covariance_m2()).map(|row| row.map(|entry| weight * entry))
    };
    let information = [scaled(first, first_weight), scaled(second, second_weight)];
    let covariance = inverse(add(information[0], information[1]));
    let pull = [
        apply(information[0], first.position_m()),
        apply(information[1], second.position_m()),
    ];
    let mean = apply(
        covariance,
        [pull[0][0] + pull[1][0], pull[0][1] + pull[1][1]],
    );
    GroundEstimate::of(mean, covariance)
}

fn trace(estimate: &GroundEstimate) -> f64 {
    let [[xx, _], [_, zz]] = estimate.covariance_m2();
    xx + zz
}

pub(crate) fn add(a: Covariance, b: Covariance) -> Covariance {
    [0, 1].map(|row| [0, 1].map(|column| a[row][column] + b[row][column]))
}

fn apply(matrix: Covariance, [x, z]: [f64; 2]) -> [f64; 2] {
    matrix.map(|[a, b]| a * x + b * z)
}

/// The inverse of a covariance; every estimate of the memory has at least a square millimetre, so
/// the determinant is positive.
pub(crate) fn inverse([[a, b], [_, d]]: Covariance) -> Covariance {
    let determinant = a * d - b * b;
    [
        [d / determinant, -b / determinant],
        [-b / determinant, a / determinant],
    ]
}
