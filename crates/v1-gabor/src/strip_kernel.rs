use crate::machine::Machine;
use crate::separable::{Kernel, Parity, Separable, Term};

/// How many neighbouring pixels are filtered together: one AVX vector, two of SSE or NEON.
pub(crate) const LANES: usize = 8;

/// One value for each of [`LANES`] neighbouring pixels.
pub(crate) type Lanes = [f32; LANES];

/// Columns filtered before the next: the vertical kernels' rows of one strip stay in the first
/// cache.
pub(crate) const STRIP: usize = 256;

/// Values that one step of the horizontal kernels sees: [`LANES`] and the taps on either side. A
/// power of two above what is needed, so that offsets into it need no check.
const WINDOW: usize = 32;

/// The most taps on either side that the fast pass is compiled for.
pub(crate) const MOST_RADIUS: usize = 7;

/// Values from one vertical kernel's row to the next: a strip, the taps on either side, and what
/// the last window reads beyond. Not a multiple of 1024, which would crowd a few cache sets.
const ROW: usize = STRIP + 2 * WINDOW + 16;

/// The work of a separable bank in the order in which the fast pass does it.
///
/// All kernels at one place share the sums `p[k] + p[-k]` (even ones) and the differences
/// `p[k] - p[-k]` (odd ones), so they are listed apart.
#[derive(Clone, Debug)]
pub(crate) struct StripKernel {
    radius: usize,
    products: usize,
    vertical: Stage,
    /// For each row that the vertical kernels give, in their order, even ones first.
    horizontal: Vec<Stage>,
    /// For each part of a response, even parts first.
    parts: Vec<PartRecipe>,
}

/// Kernels that are applied at one place.
#[derive(Clone, Debug, Default)]
struct Stage {
    even: Vec<SpreadKernel>,
    odd: Vec<SpreadKernel>,
}

/// A kernel with each tap repeated over the lanes, and where its result goes.
#[derive(Clone, Debug)]
struct SpreadKernel {
    /// At `0..=radius` from the centre. Kept in place rather than behind a pointer, as the loops
    /// over kernels are short.
    taps: [Lanes; MOST_RADIUS + 1],
    place: usize,
}

/// How one part of a response is put together: two weighted products, which is all that a Gabor
/// filter needs, and what a steerable one needs beyond.
#[derive(Clone, Debug)]
struct PartRecipe {
    first: (Lanes, usize),
    /// Weighs nothing if there is but one product.
    second: (Lanes, usize),
    others: Vec<(Lanes, usize)>,
}

/// What the fast pass keeps between its steps; planned once, used for any number of rows.
#[derive(Clone, Debug)]
pub(crate) struct StripWorkspace {
    /// The rows that the vertical kernels give, [`ROW`] values each.
    rows: Vec<f32>,
    products: Vec<Lanes>,
    parts: Vec<Lanes>,
}

impl StripKernel {
    pub(crate) fn new(bank: &Separable) -> Self {
        let mut vertical: Vec<usize> = Vec::new();
        for product in &bank.products {
            if !vertical.contains(&product.vertical) {
                vertical.push(product.vertical);
            }
        }
        let parity = |kernel: usize| bank.kernels[kernel].parity;
        vertical.sort_by_key(|&kernel| parity(kernel) == Parity::Odd);
        let stage = |kernels: &mut dyn Iterator<Item = (usize, usize)>| {
            let mut stage = Stage::default();
            for (kernel, place) in kernels {
                let spread = SpreadKernel::new(&bank.kernels[kernel], place);
                match parity(kernel) {
                    Parity::Even => stage.even.push(spread),
                    Parity::Odd => stage.odd.push(spread),
                }
            }
            stage
        };
        let horizontal = vertical.iter().map(|&source| {
            let fed = bank.products.iter().enumerate();
            let fed = fed.filter(|(_, product)| product.vertical == source);
            stage(&mut fed.map(|(place, product)| (product.horizontal, place)))
        });
        let even = bank
            .recipes
            .iter()
            .map(|recipe| PartRecipe::new(&recipe.even));
        let odd = bank
            .recipes
            .iter()
            .map(|recipe| PartRecipe::new(&recipe.odd));
        Self {
            radius: bank.radius(),
            products: bank.products.len(),
            horizontal: horizontal.collect(),
            vertical: stage(&mut vertical.iter().copied().zip(0..)),
            parts: even.chain(odd).collect(),
        }
    }

    /// Parts of a response: two an orientation.
    pub(crate) const fn parts(&self) -> usize {
        self.parts.len()
    }

    /// What the size of a workspace depends on: vertical kernels, products
    /// and parts.
    pub(crate) fn shape(&self) -> (usize, usize, usize) {
        (self.horizontal.len(), self.products, self.parts())
    }

    pub(crate) fn workspace(&self) -> StripWorkspace {
        StripWorkspace {
            rows: vec![0.0; self.horizontal.len() * ROW],
            products: vec![[0.0; LANES]; self.products],
            parts: vec![[0.0; LANES]; self.parts.len()],
        }
    }

    /// Writes the responses of row `y` of an image of `width` columns, row-major in `image`: for
    /// each pixel the even parts of all orientations, then the odd parts.
    ///
    /// `RADIUS` is the bank's.
    #[inline(always)]
    pub(crate) fn respond_row<const RADIUS: usize, M: Machine>(
        &self,
        machine: M,
        image: &[f32],
        width: usize,
        y: usize,
        responses: &mut [f32],
        workspace: &mut StripWorkspace,
    ) {
        debug_assert_eq!(RADIUS, self.radius);
        let height = image.len() / width;
        let row = |k: usize| {
            let row = (y + k).saturating_sub(RADIUS).min(height - 1);
            &image[row * width..][..width]
        };
        let centre = row(RADIUS);
        let above: [&[f32]; RADIUS] = std::array::from_fn(|k| row(RADIUS - 1 - k));
        let below: [&[f32]; RADIUS] = std::array::from_fn(|k| row(RADIUS + 1 + k));
        let StripWorkspace {
            rows,
            products,
            parts,
        } = workspace;
        let stride = self.parts();
        for start in (0..width).step_by(STRIP) {
            let end = (start + STRIP).min(width);
            self.filter_down::<RADIUS, M>(centre, &above, &below, (start, end), rows);
            let strip = &mut responses[start * stride..end * stride];
            for (block, out) in strip.chunks_mut(LANES * stride).enumerate() {
                self.filter_across::<RADIUS, M>(rows, block * LANES, products);
                self.combine::<M>(products, parts);
                interleave(machine, parts, out);
            }
        }
    }

    /// The vertical kernels over the columns of one strip and the taps beside it; column `start`
    /// comes to lie at `RADIUS` of each row. Beyond the image's border the last column is repeated.
    #[inline(always)]
    fn filter_down<const RADIUS: usize, M: Machine>(
        &self,
        centre: &[f32],
        above: &[&[f32]; RADIUS],
        below: &[&[f32]; RADIUS],
        (start, end): (usize, usize),
        rows: &mut [f32],
    ) {
        let width = centre.len();
        let from = start.saturating_sub(RADIUS);
        let to = (end + RADIUS).min(width);
        // Place in the rows of image column `x`: `x + RADIUS - start`.
        let place = |x: usize| x + RADIUS - start;
        let mut x = from;
        while x < to && x + LANES <= width {
            self.filter_down_at::<RADIUS, M>(
                lanes(centre, x),
                std::array::from_fn(|k| (lanes(above[k], x), lanes(below[k], x))),
                (place(x), &mut *rows),
            );
            x += LANES;
        }
        // The image ends within the lanes.
        if x < to {
            self.filter_down_at::<RADIUS, M>(
                last_lanes(centre, x),
                std::array::from_fn(|k| (last_lanes(above[k], x), last_lanes(below[k], x))),
                (place(x), &mut *rows),
            );
        }
        for row in rows.chunks_exact_mut(ROW) {
            let first = row[place(from)];
            row[..place(from)].fill(first);
            let last = row[place(to) - 1];
            row[place(to)..place(end) + RADIUS].fill(last);
        }
    }

    /// The vertical kernels at [`LANES`] columns: the middle row, and the rows above and below it by
    /// their distance.
    #[inline(always)]
    fn filter_down_at<const RADIUS: usize, M: Machine>(
        &self,
        middle: Lanes,
        pairs: [(Lanes, Lanes); RADIUS],
        (place, rows): (usize, &mut [f32]),
    ) {
        let sums: [Lanes; RADIUS] = std::array::from_fn(|k| add(pairs[k].1, pairs[k].0));
        let differences: [Lanes; RADIUS] =
            std::array::from_fn(|k| subtract(pairs[k].1, pairs[k].0));
        let (even, odd) = rows.split_at_mut(self.vertical.even.len() * ROW);
        for (kernel, row) in self.vertical.even.iter().zip(even.chunks_exact_mut(ROW)) {
            let value = kernel.even::<RADIUS, M>(middle, &sums);
            row[place..place + LANES].copy_from_slice(&value);
        }
        for (kernel, row) in self.vertical.odd.iter().zip(odd.chunks_exact_mut(ROW)) {
            let value = kernel.odd::<RADIUS, M>(&differences);
            row[place..place + LANES].copy_from_slice(&value);
        }
    }

    /// The products at [`LANES`] pixels, `x` pixels into the strip.
    #[inline(always)]
    fn filter_across<const RADIUS: usize, M: Machine>(
        &self,
        rows: &[f32],
        x: usize,
        products: &mut [Lanes],
    ) {
        for (stage, row) in self.horizontal.iter().zip(rows.chunks_exact(ROW)) {
            let (window, _) = row[x..]
                .split_first_chunk::<WINDOW>()
                .expect("a row is a window longer than a strip");
            let side = |offset: usize| -> Lanes { std::array::from_fn(|i| window[offset + i]) };
            if !stage.even.is_empty() {
                let sums: [Lanes; RADIUS] =
                    std::array::from_fn(|k| add(side(RADIUS + 1 + k), side(RADIUS - 1 - k)));
                for kernel in &stage.even {
                    products[kernel.place] = kernel.even::<RADIUS, M>(side(RADIUS), &sums);
                }
            }
            if !stage.odd.is_empty() {
                let differences: [Lanes; RADIUS] =
                    std::array::from_fn(|k| subtract(side(RADIUS + 1 + k), side(RADIUS - 1 - k)));
                for kernel in &stage.odd {
                    products[kernel.place] = kernel.odd::<RADIUS, M>(&differences);
                }
            }
        }
    }

    /// The parts of the responses from the products.
    #[inline(always)]
    fn combine<M: Machine>(&self, products: &[Lanes], parts: &mut [Lanes]) {
        for (recipe, part) in self.parts.iter().zip(parts) {
            let (weight, product) = recipe.first;
            let mut sum = multiply(weight, products[product]);
            let (weight, product) = recipe.second;
            sum = M::multiply_add(weight, products[product], sum);
            for &(weight, product) in &recipe.others {
                sum = M::multiply_add(weight, products[product], sum);
            }
            *part = sum;
        }
    }
}

impl PartRecipe {
    fn new(terms: &[Term]) -> Self {
        let mut terms = terms.iter().map(|t| ([t.weight; LANES], t.product));
        let nothing = ([0.0; LANES], 0);
        Self {
            first: terms.next().unwrap_or(nothing),
            second: terms.next().unwrap_or(nothing),
            others: terms.collect(),
        }
    }
}

impl SpreadKernel {
    fn new(kernel: &Kernel, place: usize) -> Self {
        Self {
            taps: std::array::from_fn(|k| [kernel.taps.get(k).copied().unwrap_or(0.0); LANES]),
            place,
        }
    }

    #[inline(always)]
    fn even<const RADIUS: usize, M: Machine>(
        &self,
        middle: Lanes,
        sums: &[Lanes; RADIUS],
    ) -> Lanes {
        let mut value = multiply(self.taps[0], middle);
        for k in 0..RADIUS {
            value = M::multiply_add(self.taps[k + 1], sums[k], value);
        }
        value
    }

    #[inline(always)]
    fn odd<const RADIUS: usize, M: Machine>(&self, differences: &[Lanes; RADIUS]) -> Lanes {
        let mut value = multiply(self.taps[1], differences[0]);
        for k in 1..RADIUS {
            value = M::multiply_add(self.taps[k + 1], differences[k], value);
        }
        value
    }
}

/// Writes parts `[[part, pixel]]` as `[[pixel, part]]`, as many pixels as `out` has.
#[inline(always)]
fn interleave<M: Machine>(machine: M, parts: &[Lanes], out: &mut [f32]) {
    if let (Ok(parts), Ok(out)) = (
        <&[Lanes; 16]>::try_from(parts),
        <&mut [f32; 16 * LANES]>::try_from(&mut *out),
    ) {
        for half in 0..2 {
            let turned = machine.turn(std::array::from_fn(|part| parts[half * LANES + part]));
            for (pixel, values) in turned.iter().enumerate() {
                out[16 * pixel + LANES * half..][..LANES].copy_from_slice(values);
            }
        }
    } else {
        for (pixel, out) in out.chunks_exact_mut(parts.len()).enumerate() {
            for (value, part) in out.iter_mut().zip(parts) {
                *value = part[pixel];
            }
        }
    }
}

#[inline(always)]
fn lanes(row: &[f32], x: usize) -> Lanes {
    let row = &row[x..x + LANES];
    std::array::from_fn(|i| row[i])
}

/// The last values of a row that ends within the lanes, and zeros.
#[inline(always)]
fn last_lanes(row: &[f32], x: usize) -> Lanes {
    std::array::from_fn(|i| row.get(x + i).copied().unwrap_or(0.0))
}

#[inline(always)]
fn add(a: Lanes, b: Lanes) -> Lanes {
    std::array::from_fn(|i| a[i] + b[i])
}

#[inline(always)]
fn subtract(a: Lanes, b: Lanes) -> Lanes {
    std::array::from_fn(|i| a[i] - b[i])
}

#[inline(always)]
fn multiply(a: Lanes, b: Lanes) -> Lanes {
    std::array::from_fn(|i| a[i] * b[i])
}
