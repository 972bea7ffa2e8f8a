use crate::ahead::Ahead;
use crate::lanes::{Lanes, Neighbours, Row, STRIP, Spread, SpreadKernel, lanes_at, lanes_at_mut};
use crate::machine::Machine;
use crate::quadrature::Quadrature;
use crate::separable::{Parity, Separable, Term};

/// The work of a separable bank in the order in which the fast pass does it.
///
/// All kernels at one place share the sums `p[k] + p[-k]` (even ones) and the differences
/// `p[k] - p[-k]` (odd ones), so they are listed apart.
#[derive(Clone, Debug)]
pub(crate) struct StripKernel {
    radius: usize,
    /// Vertical kernels, each of which gives a row.
    rows: usize,
    /// Parts of a response: two an orientation.
    parts: usize,
    vertical: Stage,
    across: Across,
}

/// The way from the vertical kernels' rows to the parts of the responses.
#[derive(Clone, Debug)]
enum Across {
    /// Gabor filters: each row serves one orientation and its mirror image.
    Quadrature(Vec<Quadrature>),
    /// Any separable bank: all products first, then their weighted sums.
    Products(Products),
}

#[derive(Clone, Debug)]
struct Products {
    products: usize,
    /// For each row that the vertical kernels give, in their order, even ones first.
    horizontal: Vec<Stage>,
    /// For each part of a response, even parts first.
    parts: Vec<PartRecipe>,
}

/// Kernels that are applied at one place.
#[derive(Clone, Debug, Default)]
struct Stage {
    even: Vec<PlacedKernel>,
    odd: Vec<PlacedKernel>,
}

/// A kernel and where its result goes.
#[derive(Clone, Debug)]
struct PlacedKernel {
    kernel: SpreadKernel,
    place: usize,
}

/// How one part of a response is put together, as weighted products.
#[derive(Clone, Debug)]
struct PartRecipe {
    first: (Spread, usize),
    others: Vec<(Spread, usize)>,
}

/// How a row of responses lies in memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Layout {
    /// `[[pixel, part]]`: for each pixel the even parts of all orientations, then the odd parts.
    ByPixel,
    /// `[[part, pixel]]`: the even parts of one orientation after the other, then the odd parts.
    ByPart,
}

/// What the fast pass keeps between its steps; planned once, used for any number of rows.
#[derive(Clone, Debug)]
pub(crate) struct StripWorkspace {
    /// What the vertical kernels give.
    rows: Vec<Row>,
    products: Vec<Row>,
    parts: Vec<Row>,
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
                let placed = PlacedKernel {
                    kernel: SpreadKernel::new(&bank.kernels[kernel], 1.0),
                    place,
                };
                match parity(kernel) {
                    Parity::Even => stage.even.push(placed),
                    Parity::Odd => stage.odd.push(placed),
                }
            }
            stage
        };
        let across = Quadrature::of(bank, &vertical).map_or_else(
            || {
                let horizontal = vertical.iter().map(|&source| {
                    let fed = bank.products.iter().enumerate();
                    let fed = fed.filter(|(_, product)| product.vertical == source);
                    stage(&mut fed.map(|(place, product)| (product.horizontal, place)))
                });
                let even = bank.recipes.iter().map(|r| PartRecipe::new(&r.even));
                let odd = bank.recipes.iter().map(|r| PartRecipe::new(&r.odd));
                Across::Products(Products {
                    products: bank.products.len(),
                    horizontal: horizontal.collect(),
                    parts: even.chain(odd).collect(),
                })
            },
            Across::Quadrature,
        );
        Self {
            radius: bank.radius(),
            parts: 2 * bank.recipes.len(),
            rows: vertical.len(),
            vertical: stage(&mut vertical.iter().copied().zip(0..)),
            across,
        }
    }

    /// Parts of a response: two an orientation.
    pub(crate) const fn parts(&self) -> usize {
        self.parts
    }

    /// What the size of a workspace depends on: vertical kernels, products and parts.
    pub(crate) fn shape(&self) -> (usize, usize, usize) {
        let products = match &self.across {
            Across::Quadrature(_) => 0,
            Across::Products(across) => across.products,
        };
        (self.rows, products, self.parts)
    }

    pub(crate) fn workspace(&self) -> StripWorkspace {
        let (rows, products, parts) = self.shape();
        StripWorkspace {
            rows: vec![Row::EMPTY; rows],
            products: vec![Row::EMPTY; products],
            parts: vec![Row::EMPTY; parts],
        }
    }

    /// Writes the responses of row `y` of an image of `width` columns, row-major in `image`, in this
    /// [`Layout`].
    ///
    /// `RADIUS` is the bank's.
    #[inline(always)]
    pub(crate) fn respond_row<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
        &self,
        machine: M,
        image: &[f32],
        width: usize,
        y: usize,
        (layout, responses): (Layout, &mut [f32]),
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
            self.filter_down::<RADIUS, LANES, M>(
                machine,
                centre,
                (&above, &below),
                (start, end),
                rows,
            );
            match &self.across {
                Across::Quadrature(pairs) => {
                    let burst: &[f32] = match layout {
                        Layout::ByPixel => &responses[start * stride..end * stride],
                        // A row of each part is short enough to have stayed near.
                        Layout::ByPart => &[],
                    };
                    let mut ahead = Ahead::new(burst);
                    for pair in pairs {
                        pair.filter::<RADIUS, LANES, M>(
                            machine,
                            rows,
                            end - start,
                            parts,
                            &mut ahead,
                        );
                    }
                }
                Across::Products(across) => {
                    across.filter::<RADIUS, LANES, M>(machine, rows, end - start, products);
                    across.combine(machine, products, end - start, parts);
                }
            }
            match layout {
                Layout::ByPixel => {
                    interleave(machine, parts, &mut responses[start * stride..end * stride]);
                }
                Layout::ByPart => {
                    for (part, out) in parts.iter().zip(responses.chunks_exact_mut(width)) {
                        out[start..end].copy_from_slice(&part[..end - start]);
                    }
                }
            }
        }
    }

    /// The vertical kernels over the columns of one strip and the taps beside it; column `start`
    /// comes to lie at `RADIUS` of each row. Beyond the image's border the last column is repeated.
    #[inline(always)]
    fn filter_down<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
        &self,
        machine: M,
        centre: &[f32],
        (above, below): (&[&[f32]; RADIUS], &[&[f32]; RADIUS]),
        (start, end): (usize, usize),
        rows: &mut [Row],
    ) {
        let width = centre.len();
        let from = start.saturating_sub(RADIUS);
        let to = (end + RADIUS).min(width);
        // Place in the rows of image column `x`: `x + RADIUS - start`.
        let place = |x: usize| x + RADIUS - start;
        let mut x = from;
        while x < to && x + LANES <= width {
            let middle = machine.load(lanes_at(centre, x));
            let mut pairs = [(middle, middle); RADIUS];
            for k in 0..RADIUS {
                pairs[k] = (
                    machine.load(lanes_at(above[k], x)),
                    machine.load(lanes_at(below[k], x)),
                );
            }
            self.filter_down_at::<RADIUS, LANES, M>(machine, middle, &pairs, place(x), rows);
            x += LANES;
        }
        // The image ends within the lanes.
        if x < to {
            let middle = machine.load(&last_lanes(centre, x));
            let mut pairs = [(middle, middle); RADIUS];
            for k in 0..RADIUS {
                pairs[k] = (
                    machine.load(&last_lanes(above[k], x)),
                    machine.load(&last_lanes(below[k], x)),
                );
            }
            self.filter_down_at::<RADIUS, LANES, M>(machine, middle, &pairs, place(x), rows);
        }
        for row in rows {
            let first = row[place(from)];
            row[..place(from)].fill(first);
            let last = row[place(to) - 1];
            row[place(to)..place(end) + RADIUS].fill(last);
        }
    }

    /// The vertical kernels at as many columns as there are lanes: the middle row, and the rows above and below it by
    /// their distance.
    #[inline(always)]
    fn filter_down_at<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
        &self,
        machine: M,
        middle: M::Vector,
        pairs: &[(M::Vector, M::Vector); RADIUS],
        place: usize,
        rows: &mut [Row],
    ) {
        let mut sums = [middle; RADIUS];
        let mut differences = [middle; RADIUS];
        for k in 0..RADIUS {
            sums[k] = machine.add(pairs[k].1, pairs[k].0);
            differences[k] = machine.subtract(pairs[k].1, pairs[k].0);
        }
        let (even, odd) = rows.split_at_mut(self.vertical.even.len());
        for (PlacedKernel { kernel, .. }, row) in self.vertical.even.iter().zip(even) {
            let value = kernel.even::<RADIUS, LANES, M>(machine, middle, &sums);
            *row.lanes_mut(place) = machine.store(value);
        }
        for (PlacedKernel { kernel, .. }, row) in self.vertical.odd.iter().zip(odd) {
            let value = kernel.odd::<RADIUS, LANES, M>(machine, &differences);
            *row.lanes_mut(place) = machine.store(value);
        }
    }
}

impl Products {
    /// The products of a strip, from the rows that the vertical kernels gave.
    #[inline(always)]
    fn filter<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
        &self,
        machine: M,
        rows: &[Row],
        width: usize,
        products: &mut [Row],
    ) {
        for (stage, row) in self.horizontal.iter().zip(rows) {
            for x in (0..width).step_by(LANES) {
                let seen = Neighbours::at(row, x);
                if !stage.even.is_empty() {
                    let middle = seen.middle::<RADIUS, LANES, M>(machine);
                    let sums = seen.sums(machine);
                    for PlacedKernel { kernel, place } in &stage.even {
                        let value = kernel.even::<RADIUS, LANES, M>(machine, middle, &sums);
                        *products[*place].lanes_mut(x) = machine.store(value);
                    }
                }
                if !stage.odd.is_empty() {
                    let differences = seen.differences(machine);
                    for PlacedKernel { kernel, place } in &stage.odd {
                        let value = kernel.odd::<RADIUS, LANES, M>(machine, &differences);
                        *products[*place].lanes_mut(x) = machine.store(value);
                    }
                }
            }
        }
    }

    /// The parts of the responses from the products.
    #[inline(always)]
    fn combine<const LANES: usize, M: Machine<LANES>>(
        &self,
        machine: M,
        products: &[Row],
        width: usize,
        parts: &mut [Row],
    ) {
        for (recipe, part) in self.parts.iter().zip(parts) {
            for x in (0..width).step_by(LANES) {
                let (weight, product) = &recipe.first;
                let product = machine.load(products[*product].lanes(x));
                let mut sum = machine.multiply(weight.load(machine), product);
                for (weight, product) in &recipe.others {
                    let product = machine.load(products[*product].lanes(x));
                    sum = machine.multiply_add(weight.load(machine), product, sum);
                }
                *part.lanes_mut(x) = machine.store(sum);
            }
        }
    }
}

impl PartRecipe {
    fn new(terms: &[Term]) -> Self {
        let mut terms = terms.iter().map(|t| (Spread::new(t.weight), t.product));
        Self {
            first: terms.next().unwrap_or((Spread::new(0.0), 0)),
            others: terms.collect(),
        }
    }
}

/// Writes parts `[[part, pixel]]` as `[[pixel, part]]`, as many pixels as `out` has.
#[inline(always)]
fn interleave<const LANES: usize, M: Machine<LANES>>(machine: M, parts: &[Row], out: &mut [f32]) {
    let stride = parts.len();
    let (squares, others) = parts.as_chunks::<LANES>();
    let first = stride - others.len();
    let mut blocks = out.chunks_exact_mut(LANES * stride);
    let mut x = 0;
    for block in &mut blocks {
        if let ([square], []) = (squares, others) {
            let (pixels, _) = block.as_chunks_mut::<LANES>();
            let columns = turned(machine, square, x);
            for (out, pixel) in pixels.iter_mut().zip(columns) {
                *out = machine.store(pixel);
            }
        } else {
            for (square, parts) in squares.iter().enumerate() {
                let columns = turned(machine, parts, x);
                for (out, pixel) in block.chunks_exact_mut(stride).zip(columns) {
                    *lanes_at_mut(out, square * LANES) = machine.store(pixel);
                }
            }
            for (pixel, out) in block.chunks_exact_mut(stride).enumerate() {
                for (value, part) in out[first..].iter_mut().zip(others) {
                    *value = part[x + pixel];
                }
            }
        }
        x += LANES;
    }
    for out in blocks.into_remainder().chunks_exact_mut(stride) {
        for (value, part) in out.iter_mut().zip(parts) {
            *value = part[x];
        }
        x += 1;
    }
}

/// As many parts of as many pixels from `x` on as there are lanes, by pixel.
#[inline(always)]
fn turned<const LANES: usize, M: Machine<LANES>>(
    machine: M,
    parts: &[Row; LANES],
    x: usize,
) -> [M::Vector; LANES] {
    let mut rows = [machine.load(parts[0].lanes(x)); LANES];
    for part in 1..LANES {
        rows[part] = machine.load(parts[part].lanes(x));
    }
    machine.turn(rows)
}

/// The last values of a row that ends within the lanes, and zeros.
#[inline(always)]
fn last_lanes<const LANES: usize>(row: &[f32], x: usize) -> Lanes<LANES> {
    std::array::from_fn(|i| row.get(x + i).copied().unwrap_or(0.0))
}
