use num_complex::{Complex32, Complex64};

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

/// A weighted product, by its place in [`Separable::products`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Term {
    pub(crate) weight: f32,
    pub(crate) product: usize,
}

/// The two parts of one oriented filter as sums of products.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Recipe {
    pub(crate) even: Vec<Term>,
    pub(crate) odd: Vec<Term>,
}

/// A bank of oriented filters as sums of products of one-dimensional kernels, shared among them.
#[derive(Clone, Debug, Default)]
pub(crate) struct Separable {
    pub(crate) kernels: Vec<Kernel>,
    pub(crate) products: Vec<Product>,
    pub(crate) recipes: Vec<Recipe>,
}

impl Separable {
    /// The place of a kernel, new or known.
    pub(crate) fn kernel(&mut self, kernel: Kernel) -> usize {
        place(&mut self.kernels, kernel)
    }

    /// The place of a product, new or known.
    pub(crate) fn product(&mut self, vertical: usize, horizontal: usize) -> usize {
        place(
            &mut self.products,
            Product {
                vertical,
                horizontal,
            },
        )
    }

    /// Taps on either side of the centre.
    pub(crate) fn radius(&self) -> usize {
        self.kernels[0].taps.len() - 1
    }

    /// The two-dimensional kernel of one orientation at offset `(x, y)` from its centre.
    pub(crate) fn sample(&self, recipe: &Recipe, x: isize, y: isize) -> Complex32 {
        let part = |terms: &[Term]| -> f32 {
            let products = terms.iter().map(|term| {
                let Product {
                    vertical,
                    horizontal,
                } = self.products[term.product];
                term.weight * (self.kernels[vertical].at(y) * self.kernels[horizontal].at(x))
            });
            products.sum()
        };
        Complex32::new(part(&recipe.even), part(&recipe.odd))
    }

    /// The transfer functions of the even and of the odd part of one orientation,
    /// `sum_k h(k) exp(j w.k)`: real for the even part, imaginary for the odd one.
    pub(crate) fn transfer(&self, recipe: &Recipe, wave: (f64, f64)) -> (Complex64, Complex64) {
        let radius = self.radius() as isize;
        let (mut even, mut odd) = (Complex64::ZERO, Complex64::ZERO);
        for y in -radius..=radius {
            for x in -radius..=radius {
                let sample = self.sample(recipe, x, y);
                let carrier = Complex64::cis(wave.0 * x as f64 + wave.1 * y as f64);
                even += f64::from(sample.re) * carrier;
                odd += f64::from(sample.im) * carrier;
            }
        }
        (even, odd)
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
