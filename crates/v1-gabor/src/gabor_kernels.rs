use std::f64::consts::{FRAC_PI_2, PI};

use num_complex::Complex64;

use crate::GaborParams;
use crate::separable::{Kernel, Parity, Recipe, Separable, Term};

/// The Gabor filters of a bank as sums of products of one-dimensional kernels.
///
/// With `c_w(k) = g(k) cos(w k)` and `s_w(k) = -g(k) sin(w k)` the filter
/// `g(x) g(y) exp(-j (wx x + wy y))` is `(c_wy c_wx - s_wy s_wx) + j (s_wy c_wx + c_wy s_wx)`, and
/// its mirror image, orientation `pi - theta`, has the same four products with the signs of the
/// second ones turned. Eight orientations need nine kernels and sixteen products.
pub(crate) fn gabor_kernels(params: &GaborParams) -> Separable {
    let mut bank = Separable::default();
    for q in 0..params.orientations {
        let theta = q as f64 * PI / params.orientations as f64;
        add_orientation(&mut bank, params, theta);
    }
    bank
}

fn add_orientation(bank: &mut Separable, params: &GaborParams, theta: f64) {
    let omega = f64::from(params.peak_frequency);
    // The mirror image about the vertical axis shares all kernels with the filter itself.
    let mirrored = theta > FRAC_PI_2 + 1e-9;
    let folded = if mirrored { PI - theta } else { theta };
    let (along_x, along_y) = (omega * folded.cos(), omega * folded.sin());
    // A product has no DC if either factor has none. The mean is taken from the cosine of the
    // higher frequency, where it is smallest; from both if they are one.
    let same = (along_x - along_y).abs() < 1e-9;
    let cos_x = bank.kernel(cosine(params, along_x, along_x > along_y || same));
    let cos_y = bank.kernel(cosine(params, along_y, along_y > along_x || same));
    let sin_x = sine(params, along_x).map(|kernel| bank.kernel(kernel));
    let sin_y = sine(params, along_y).map(|kernel| bank.kernel(kernel));

    let sign = if mirrored { -1.0 } else { 1.0 };
    let mut term = |weight: f32, vertical, horizontal| Term {
        weight,
        product: bank.product(vertical, horizontal),
    };
    let mut recipe = Recipe {
        even: vec![term(1.0, cos_y, cos_x)],
        odd: Vec::new(),
    };
    if let (Some(sin_y), Some(sin_x)) = (sin_y, sin_x) {
        recipe.even.push(term(-sign, sin_y, sin_x));
    }
    if let Some(sin_y) = sin_y {
        recipe.odd.push(term(1.0, sin_y, cos_x));
    }
    if let Some(sin_x) = sin_x {
        recipe.odd.push(term(sign, cos_y, sin_x));
    }
    let wave = (if mirrored { -along_x } else { along_x }, along_y);
    let (even, odd) = bank.transfer(&recipe, wave);
    let gain = (even + odd * Complex64::I).norm() as f32;
    for term in recipe.even.iter_mut().chain(&mut recipe.odd) {
        term.weight /= gain;
    }
    bank.recipes.push(recipe);
}

/// The envelope at `k` pixels from the centre.
fn envelope(params: &GaborParams, k: usize) -> f64 {
    let sigma = f64::from(params.sigma_px());
    (-((k * k) as f64) / (2.0 * sigma * sigma)).exp()
}

/// `g(k) cos(frequency k)`, without its mean over the taps if `zero_mean`.
fn cosine(params: &GaborParams, frequency: f64, zero_mean: bool) -> Kernel {
    let taps =
        (0..=params.radius).map(|k| envelope(params, k) * (snap(frequency) * k as f64).cos());
    let taps: Vec<f64> = taps.collect();
    let mean = if zero_mean {
        (taps[0] + 2.0 * taps[1..].iter().sum::<f64>()) / params.taps() as f64
    } else {
        0.0
    };
    Kernel {
        parity: Parity::Even,
        taps: taps.iter().map(|tap| (tap - mean) as f32).collect(),
    }
}

/// `-g(k) sin(frequency k)`; none at standstill.
fn sine(params: &GaborParams, frequency: f64) -> Option<Kernel> {
    let frequency = snap(frequency);
    (frequency != 0.0).then(|| Kernel {
        parity: Parity::Odd,
        taps: (0..=params.radius)
            .map(|k| (-envelope(params, k) * (frequency * k as f64).sin()) as f32)
            .collect(),
    })
}

/// A frequency to twelve decimals, so that equal frequencies reached by different angles (the sine
/// of one, the cosine of another) make one kernel, and the cosine of a right angle is 0.
fn snap(frequency: f64) -> f64 {
    (frequency * 1e12).round() / 1e12
}
