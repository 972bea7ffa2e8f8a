use std::iter::repeat;

use ndarray::ArrayView2;

use crate::separable::{Kernel, Parity, Separable, Term};

/// How many neighbouring outputs a convolution computes together: four vectors of the smallest
/// vector unit, so that a loop over taps keeps its sums in registers.
const BLOCK: usize = 16;

/// One row of responses at a time: the vertical kernels first, from `2 radius + 1` image rows,
/// then the horizontal ones. No state passes from row to row, so rows can be split over threads in
/// any way and give the same bits.
pub(crate) struct SeparablePass<'a> {
    bank: &'a Separable,
    /// Which kernels are used vertically, in order of first use; a product's vertical factor is
    /// looked up here.
    vertical: Vec<usize>,
}

/// Rows in between, kept from one row of the image to the next.
pub(crate) struct Workspace {
    /// The image row through each vertical kernel, still padded horizontally.
    vertical: Vec<Vec<f32>>,
    /// Each product.
    products: Vec<Vec<f32>>,
}

impl<'a> SeparablePass<'a> {
    pub(crate) fn new(bank: &'a Separable) -> Self {
        let mut vertical: Vec<usize> = Vec::new();
        for product in &bank.products {
            if !vertical.contains(&product.vertical) {
                vertical.push(product.vertical);
            }
        }
        Self { bank, vertical }
    }

    pub(crate) fn workspace(&self, width: usize) -> Workspace {
        let radius = self.bank.kernels[0].taps.len() - 1;
        Workspace {
            vertical: vec![vec![0.0; width + 2 * radius]; self.vertical.len()],
            products: vec![vec![0.0; width]; self.bank.products.len()],
        }
    }

    /// Writes the responses of row `y` of the unpadded image: for each pixel the even parts of all
    /// orientations, then the odd parts.
    pub(crate) fn respond_row(
        &self,
        padded: ArrayView2<'_, f32>,
        y: usize,
        responses: &mut [f32],
        workspace: &mut Workspace,
    ) {
        let stride = padded.dim().1;
        let rows = padded.to_slice().expect("a padded plane is contiguous");
        for (&kernel, out) in self.vertical.iter().zip(&mut workspace.vertical) {
            correlate(&self.bank.kernels[kernel], &rows[y * stride..], stride, out);
        }
        for (product, out) in self.bank.products.iter().zip(&mut workspace.products) {
            let vertical = self
                .vertical
                .iter()
                .position(|&kernel| kernel == product.vertical)
                .expect("every product's vertical kernel is listed");
            correlate(
                &self.bank.kernels[product.horizontal],
                &workspace.vertical[vertical],
                1,
                out,
            );
        }
        let orientations = self.bank.recipes.len();
        for (q, recipe) in self.bank.recipes.iter().enumerate() {
            let parts = [(q, &recipe.even), (orientations + q, &recipe.odd)];
            for (part, terms) in parts {
                combine(
                    &workspace.products,
                    terms,
                    &mut responses[part..],
                    2 * orientations,
                );
            }
        }
    }
}

/// Writes the weighted sum of products to every `stride`-th place.
fn combine(products: &[Vec<f32>], terms: &[Term], out: &mut [f32], stride: usize) {
    for (term, first) in terms.iter().zip([true].into_iter().chain(repeat(false))) {
        let places = out.iter_mut().step_by(stride);
        for (out, product) in places.zip(&products[term.product]) {
            let before = if first { 0.0 } else { *out };
            *out = before + term.weight * product;
        }
    }
}

/// `out[i] = sum_k kernel(k) source[i + (radius + k) step]`, `step` being 1 along a row and the row
/// stride down a column.
fn correlate(kernel: &Kernel, source: &[f32], step: usize, out: &mut [f32]) {
    let radius = kernel.taps.len() - 1;
    let mut blocks = out.chunks_exact_mut(BLOCK);
    let mut start = 0;
    for block in &mut blocks {
        let mut sums = [0.0f32; BLOCK];
        let row = |k: usize| -> &[f32] { &source[start + k * step..][..BLOCK] };
        for (k, tap) in kernel.taps.iter().enumerate() {
            let (before, after) = (row(radius - k), row(radius + k));
            match kernel.parity {
                Parity::Even if k == 0 => {
                    for i in 0..BLOCK {
                        sums[i] = tap * after[i];
                    }
                }
                Parity::Even => {
                    for i in 0..BLOCK {
                        sums[i] += tap * (after[i] + before[i]);
                    }
                }
                Parity::Odd => {
                    for i in 0..BLOCK {
                        sums[i] += tap * (after[i] - before[i]);
                    }
                }
            }
        }
        block.copy_from_slice(&sums);
        start += BLOCK;
    }
    for (i, out) in blocks.into_remainder().iter_mut().enumerate() {
        let at = |k: usize| source[start + i + k * step];
        *out = kernel
            .taps
            .iter()
            .enumerate()
            .map(|(k, tap)| match kernel.parity {
                Parity::Even if k == 0 => tap * at(radius),
                Parity::Even => tap * (at(radius + k) + at(radius - k)),
                Parity::Odd => tap * (at(radius + k) - at(radius - k)),
            })
            .sum();
    }
}
