use ndarray::ArrayView2;
use pulp::{Arch, NullaryFnOnce};

use crate::separable::{Kernel, Parity, Recipe, Separable};

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
        Arch::new().dispatch(Row {
            pass: self,
            padded,
            y,
            responses,
            workspace,
        });
    }

    #[inline(always)]
    fn filter_row(
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
            let Recipe { even, odd, gain } = *recipe;
            combine(
                &workspace.products,
                even,
                gain,
                &mut responses[q..],
                2 * orientations,
            );
            let odd_parts = &mut responses[orientations + q..];
            combine(&workspace.products, odd, gain, odd_parts, 2 * orientations);
        }
    }
}

/// One row's work, compiled once for each vector width and run at the machine's widest. Products
/// and sums stay separate at every width, so the bits do too.
struct Row<'a, 'b> {
    pass: &'b SeparablePass<'a>,
    padded: ArrayView2<'b, f32>,
    y: usize,
    responses: &'b mut [f32],
    workspace: &'b mut Workspace,
}

impl NullaryFnOnce for Row<'_, '_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        self.pass
            .filter_row(self.padded, self.y, self.responses, self.workspace);
    }
}

/// Writes `gain (first + sign second)` to every `stride`-th place.
#[inline(always)]
fn combine(
    products: &[Vec<f32>],
    (first, second): (usize, Option<(f32, usize)>),
    gain: f32,
    out: &mut [f32],
    stride: usize,
) {
    let places = out.iter_mut().step_by(stride);
    match second {
        None => {
            for (out, first) in places.zip(&products[first]) {
                *out = gain * first;
            }
        }
        Some((sign, second)) => {
            for ((out, first), second) in places.zip(&products[first]).zip(&products[second]) {
                *out = gain * (first + sign * second);
            }
        }
    }
}

/// `out[i] = sum_k kernel(k) source[i + (radius + k) step]`, `step` being 1 along a row and the row
/// stride down a column.
#[inline(always)]
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
