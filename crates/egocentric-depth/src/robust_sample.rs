/// The standard deviation of a normal distribution over the median of its absolute deviations.
pub(crate) const SIGMA_OVER_MAD: f64 = 1.4826;

/// The standard error of a median over that of a mean, for normal samples: `sqrt(pi / 2)`.
pub(crate) const MEDIAN_OVER_MEAN: f64 = 1.2533;

/// Half the width of the central half of a normal distribution over its standard deviation.
const HALF_WIDTH_OVER_SIGMA: f64 = 0.6745;

/// The median of some finite numbers, NaN of none; it reorders them on the way.
pub(crate) fn median(values: &mut [f64]) -> f64 {
    let n = values.len();
    if n == 0 {
        return f64::NAN;
    }
    let (below, &mut upper, _) = values.select_nth_unstable_by(n / 2, f64::total_cmp);
    if n % 2 == 1 {
        return upper;
    }
    // Of an even number the lower middle value is the largest of those below the upper one.
    let lower = below.iter().copied().max_by(f64::total_cmp);
    f64::midpoint(lower.unwrap_or(upper), upper)
}

/// The median of the absolute deviations from `centre`, as the standard deviation of a normal
/// distribution that has it; the values become those deviations.
pub(crate) fn robust_sigma(values: &mut [f64], centre: f64) -> f64 {
    for value in &mut *values {
        *value = (*value - centre).abs();
    }
    SIGMA_OVER_MAD * median(values)
}

/// Centre and standard deviation of the densest half of an ascending sample.
///
/// The shortest interval that holds half of the values. A label that bleeds over an edge adds
/// values on one side only: these drag the median along long before they are half of all, but
/// leave the densest half where it is.
pub(crate) fn densest_half(ascending: &[f64]) -> (f64, f64) {
    let held = ascending.len() / 2 + 1;
    let width = |window: &[f64]| window[window.len() - 1] - window[0];
    let densest = ascending
        .windows(held)
        .min_by(|a, b| width(a).total_cmp(&width(b)));
    densest.map_or((f64::NAN, f64::NAN), |window| {
        let sigma = width(window) / 2.0 / HALF_WIDTH_OVER_SIGMA;
        let middle = window.len() / 2;
        let centre = if window.len() % 2 == 1 {
            window[middle]
        } else {
            f64::midpoint(window[middle - 1], window[middle])
        };
        (centre, sigma)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_sample_lies_between_its_middle_values() {
        assert_eq!(median(&mut [4.0, 1.0, 3.0, 2.0]), 2.5);
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert!(median(&mut []).is_nan());
    }

    /// Four in ten values beyond an edge move the median by much and the densest half by little.
    #[test]
    fn the_densest_half_withstands_one_sided_outliers() {
        let object = (0..60).map(|i| 1.0 + 0.001 * f64::from(i));
        let wall = (0..40).map(|i| 2.0 + 0.02 * f64::from(i));
        let sample: Vec<f64> = object.chain(wall).collect();
        let (centre, sigma) = densest_half(&sample);
        assert!((centre - 1.025).abs() < 0.006, "{centre}");
        assert!((0.03..0.045).contains(&sigma), "{sigma}");
        assert!((densest_half(&[7.0]).0 - 7.0).abs() < f64::EPSILON);
    }
}
