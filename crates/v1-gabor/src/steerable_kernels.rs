use std::f64::consts::PI;

use crate::separable::{Kernel, Parity, Recipe, Separable, Term};
use crate::{SteerableOrder, SteerableParams};

/// One separable basis filter `exp(-x^2 - y^2) p(x) r(y)` and its share in the filter of
/// direction `(c, s)`: `share c^(n - j) s^j`, `j` being its place among the `n + 1` of its part.
struct Basis {
    share: f64,
    /// Coefficients of `p`, by rising power.
    along_x: &'static [f64],
    /// Coefficients of `r`, by rising power.
    along_y: &'static [f64],
}

const fn basis(share: f64, along_x: &'static [f64], along_y: &'static [f64]) -> Basis {
    Basis {
        share,
        along_x,
        along_y,
    }
}

// Freeman & Adelson (1991), tables III to VI. Their binomial shares are written out, with plus
// signs throughout, since y points down here and the angle grows from x towards y; their common
// factors are left to the normalisation.
const ONE: &[f64] = &[1.0];
const U: &[f64] = &[0.0, 1.0];
const G2: &[f64] = &[-1.0, 0.0, 2.0];
const G2_PARTS: [Basis; 3] = [basis(1.0, G2, ONE), basis(4.0, U, U), basis(1.0, ONE, G2)];
const H2: &[f64] = &[0.0, -2.254, 0.0, 1.0];
const H2_INNER: &[f64] = &[-0.7515, 0.0, 1.0];
const H2_PARTS: [Basis; 4] = [
    basis(1.0, H2, ONE),
    basis(3.0, H2_INNER, U),
    basis(3.0, U, H2_INNER),
    basis(1.0, ONE, H2),
];
const G4: &[f64] = &[0.75, 0.0, -3.0, 0.0, 1.0];
const G4_INNER: &[f64] = &[0.0, -1.5, 0.0, 1.0];
const G4_MIDDLE: &[f64] = &[-0.5, 0.0, 1.0];
const G4_PARTS: [Basis; 5] = [
    basis(1.0, G4, ONE),
    basis(4.0, G4_INNER, U),
    basis(6.0, G4_MIDDLE, G4_MIDDLE),
    basis(4.0, U, G4_INNER),
    basis(1.0, ONE, G4),
];
const H4: &[f64] = &[0.0, 7.189, 0.0, -7.501, 0.0, 1.0];
const H4_INNER: &[f64] = &[1.438, 0.0, -4.501, 0.0, 1.0];
const H4_CUBIC: &[f64] = &[0.0, -2.225, 0.0, 1.0];
const H4_SQUARE: &[f64] = &[-0.6638, 0.0, 1.0];
const H4_PARTS: [Basis; 6] = [
    basis(1.0, H4, ONE),
    basis(5.0, H4_INNER, U),
    basis(10.0, H4_CUBIC, H4_SQUARE),
    basis(10.0, H4_SQUARE, H4_CUBIC),
    basis(5.0, U, H4_INNER),
    basis(1.0, ONE, H4),
];

/// The steerable filters of a bank as sums of products of one-dimensional kernels.
///
/// A derivative of a Gaussian in any direction `(c, s)` is a sum of a few fixed ones, weighted by
/// powers of `c` and `s`: all orientations share 7 products (second order) or 11 (fourth). The odd
/// filters are polynomials fitted to the Hilbert transform of the even ones, and steer alike.
pub(crate) fn steerable_kernels(params: &SteerableParams) -> Separable {
    let mut bank = Separable::default();
    let (even, odd): (&[Basis], &[Basis]) = match params.order {
        SteerableOrder::Second => (&G2_PARTS, &H2_PARTS),
        SteerableOrder::Fourth => (&G4_PARTS, &H4_PARTS),
    };
    let even = PlacedBasis::new(&mut bank, params, even);
    let odd = PlacedBasis::new(&mut bank, params, odd);
    // Both parts have half the gain at the peak of the first orientation, with signs that make
    // phase grow along the wave vector. The others are the same filter steered, so they share the
    // two factors.
    let along_x = Recipe {
        even: even.steered(0.0, 1.0),
        odd: odd.steered(0.0, 1.0),
    };
    let peak = (f64::from(params.peak_frequency), 0.0);
    let (even_gain, odd_gain) = bank.transfer(&along_x, peak);
    let factors = (0.5 / even_gain.re, -0.5 / odd_gain.im);
    for q in 0..params.orientations {
        let theta = q as f64 * PI / params.orientations as f64;
        bank.recipes.push(Recipe {
            even: even.steered(theta, factors.0),
            odd: odd.steered(theta, factors.1),
        });
    }
    bank
}

/// The basis filters of one part: the place of each one's product, and its share.
struct PlacedBasis(Vec<(usize, f64)>);

impl PlacedBasis {
    fn new(bank: &mut Separable, params: &SteerableParams, parts: &[Basis]) -> Self {
        let place = |part: &Basis| {
            let horizontal = bank.kernel(kernel(params, part.along_x));
            let vertical = bank.kernel(kernel(params, part.along_y));
            (bank.product(vertical, horizontal), part.share)
        };
        Self(parts.iter().map(place).collect())
    }

    /// The filter of direction `theta`, times a factor.
    fn steered(&self, theta: f64, factor: f64) -> Vec<Term> {
        let order = self.0.len() as i32 - 1;
        let terms = self.0.iter().zip(0..);
        terms
            .map(|(&(product, share), j)| Term {
                weight: (factor * share * theta.cos().powi(order - j) * theta.sin().powi(j)) as f32,
                product,
            })
            // A right angle's cosine is 6e-17: such terms only cost time.
            .filter(|term| f64::from(term.weight).abs() > 1e-12 * factor.abs())
            .collect()
    }
}

/// `exp(-u^2) p(u)` at the pixels, `u` in the filters' own units. An even polynomial of zero mean
/// under the Gaussian loses what mean sampling and the window left it.
fn kernel(params: &SteerableParams, polynomial: &[f64]) -> Kernel {
    let even = polynomial.len() % 2 == 1;
    let taps: Vec<f64> = (0..=params.radius)
        .map(|k| {
            let u = k as f64 * params.units_a_pixel();
            let value = polynomial.iter().rev().fold(0.0, |sum, c| sum * u + c);
            (-u * u).exp() * value
        })
        .collect();
    // The odd partners of even polynomials, such as H4's `1.438 - 4.501 u^2 + u^4`, have a mean of
    // their own; what they are multiplied by has none.
    let zero_mean = [G2, G4, G4_MIDDLE].contains(&polynomial);
    let mean = if zero_mean {
        (taps[0] + 2.0 * taps[1..].iter().sum::<f64>()) / (2 * params.radius + 1) as f64
    } else {
        0.0
    };
    Kernel {
        parity: if even { Parity::Even } else { Parity::Odd },
        taps: taps.iter().map(|tap| (tap - mean) as f32).collect(),
    }
}
