use std::f64::consts::{FRAC_PI_2, PI};

use num_complex::{Complex32, Complex64};

use crate::GaborParams;

/// A symmetric (even) or antisymmetric (odd) one-dimensional kernel, by its taps at `0..=radius`.
///
/// An odd kernel has `taps[0] = 0` and the negative of its taps on the other side.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Kernel {
    pub(crate) parity: Parity,
    pub(crate) taps: Vec<f32>,
}

/// How a kernel looks in the mirror.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Parity {
    Even,
    Odd,
}

/// One two-dimensional product of a vertical and a horizontal kernel, by their places in
/// [`Separable::kernels`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Product {
    pub(crate) vertical: usize,
    pub(crate) horizontal: usize,
}

/// How the response of one orientation is put together from products, by their places in
/// [`Separable::products`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Recipe {
    /// `even = gain (even.0 + even.1.0 * even.1.1)`.
    pub(crate) even: (usize, Option<(f32, usize)>),
    /// `odd = gain (odd.0 + odd.1.0 * odd.1.1)`.
    pub(crate) odd: (usize, Option<(f32, usize)>),
    /// Makes the gain at the peak frequency 1.
    pub(crate) gain: f32,
}

/// A bank of oriented Gabor filters as sums of products of one-dimensional kernels.
///
/// With `c_w(k) = g(k) cos(w k)` and `s_w(k) = -g(k) sin(w k)` the filter
/// `g(x) g(y) exp(-j (wx x + wy y))` is `(c_wy c_wx - s_wy s_wx) + j (s_wy c_wx + c_wy s_wx)`, and
/// its mirror image, orientation `pi - theta`, has the same four products with the signs of the
/// second ones turned. Eight orientations need nine kernels and sixteen products.
#[derive(Clone, Debug)]
pub(crate) struct Separable {
    pub(crate) kernels: Vec<Kernel>,
    pub(crate) products: Vec<Product>,
    pub(crate) recipes: Vec<Recipe>,
}

impl Separable {
    pub(crate) fn new(params: &GaborParams) -> Self {
        let mut bank = Self {
            kernels: Vec::new(),
            products: Vec::new(),
            recipes: Vec::new(),
        };
        for q in 0..params.orientations {
            let theta = q as f64 * PI / params.orientations as f64;
            bank.add_orientation(params, theta);
        }
        bank
    }

    fn add_orientation(&mut self, params: &GaborParams, theta: f64) {
        let omega = f64::from(params.peak_frequency);
        // The mirror image about the vertical axis shares all kernels with the filter itself.
        let mirrored = theta > FRAC_PI_2 + 1e-9;
        let folded = if mirrored { PI - theta } else { theta };
        let (along_x, along_y) = (omega * folded.cos(), omega * folded.sin());
        // A product has no DC if either factor has none. The mean is taken from the cosine of the
        // higher frequency, where it is smallest; from both if they are one.
        let same = (along_x - along_y).abs() < 1e-9;
        let cos_x = self.kernel(cosine(params, along_x, along_x > along_y || same));
        let cos_y = self.kernel(cosine(params, along_y, along_y > along_x || same));
        let sin_x = sine(params, along_x).map(|kernel| self.kernel(kernel));
        let sin_y = sine(params, along_y).map(|kernel| self.kernel(kernel));

        let even = self.product(cos_y, cos_x);
        let sines = sin_y.zip(sin_x).map(|(y, x)| self.product(y, x));
        let sine_by_y = sin_y.map(|y| self.product(y, cos_x));
        let sine_by_x = sin_x.map(|x| self.product(cos_y, x));
        let sign = if mirrored { -1.0 } else { 1.0 };
        let odd = match (sine_by_y, sine_by_x) {
            (Some(by_y), Some(by_x)) => (by_y, Some((sign, by_x))),
            (Some(only), None) | (None, Some(only)) => (only, None),
            (None, None) => unreachable!("a filter of positive frequency has a sine along an axis"),
        };
        let mut recipe = Recipe {
            even: (even, sines.map(|product| (-sign, product))),
            odd,
            gain: 1.0,
        };
        let wave = (if mirrored { -along_x } else { along_x }, along_y);
        recipe.gain = (1.0 / self.transfer(&recipe, wave).norm()) as f32;
        self.recipes.push(recipe);
    }

    fn kernel(&mut self, kernel: Kernel) -> usize {
        place(&mut self.kernels, kernel)
    }

    fn product(&mut self, vertical: usize, horizontal: usize) -> usize {
        place(
            &mut self.products,
            Product {
                vertical,
                horizontal,
            },
        )
    }

    /// The two-dimensional kernel of one orientation at offset `(x, y)` from its centre.
    pub(crate) fn sample(&self, recipe: &Recipe, x: isize, y: isize) -> Complex32 {
        let product = |index: usize| {
            let Product {
                vertical,
                horizontal,
            } = self.products[index];
            self.kernels[vertical].at(y) * self.kernels[horizontal].at(x)
        };
        let part = |(first, second): (usize, Option<(f32, usize)>)| {
            product(first) + second.map_or(0.0, |(sign, other)| sign * product(other))
        };
        recipe.gain * Complex32::new(part(recipe.even), part(recipe.odd))
    }

    /// The transfer function `H(w) = sum_k h(k) exp(j w.k)` of one orientation.
    pub(crate) fn transfer(&self, recipe: &Recipe, wave: (f64, f64)) -> Complex64 {
        let radius = self.kernels[0].taps.len() as isize - 1;
        let mut sum = Complex64::ZERO;
        for y in -radius..=radius {
            for x in -radius..=radius {
                let sample = self.sample(recipe, x, y);
                let sample = Complex64::new(f64::from(sample.re), f64::from(sample.im));
                sum += sample * Complex64::cis(wave.0 * x as f64 + wave.1 * y as f64);
            }
        }
        sum
    }
}

impl Kernel {
    /// The tap at offset `k` from the centre.
    pub(crate) fn at(&self, k: isize) -> f32 {
        let tap = self.taps[k.unsigned_abs()];
        match self.parity {
            Parity::Odd if k < 0 => -tap,
            _ => tap,
        }
    }
}

/// The place of `item` in `list`, where it is put if it is not there yet.
fn place<T: PartialEq>(list: &mut Vec<T>, item: T) -> usize {
    list.iter()
        .position(|known| *known == item)
        .unwrap_or_else(|| {
            list.push(item);
            list.len() - 1
        })
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
