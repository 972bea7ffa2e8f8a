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
    parts: Vec<Vec<(Lanes, usize)>>,
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
    centre: Lanes,
    sides: Vec<Lanes>,
    place: usize,
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
        let spread = |terms: &Vec<Term>| -> Vec<(Lanes, usize)> {
            let terms = terms.iter();
            terms.map(|t| ([t.weight; LANES], t.product)).collect()
        };
        let even = bank.recipes.iter().map(|recipe| spread(&recipe.even));
        let odd = bank.recipes.iter().map(|recipe| spread(&recipe.odd));
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
    /// `RADIUS` is the bank's. `FUSED` multiplies and adds in one rounding, which only pays where
    /// the machine has an instruction for it.
    #[inline(always)]
    pub(crate) fn respond_row<const RADIUS: usize, const FUSED: bool>(
        &self,
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
            self.filter_down::<RADIUS, FUSED>(centre, &above, &below, (start, end), rows);
            let strip = &mut responses[start * stride..end * stride];
            for (block, out) in strip.chunks_mut(LANES * stride).enumerate() {
                self.filter_across::<RADIUS, FUSED>(rows, block * LANES, products);
                self.combine::<FUSED>(products, parts);
                interleave(parts, out);
            }
        }
    }

    /// The vertical kernels over the columns of one strip and the taps beside it; column `start`
    /// comes to lie at `RADIUS` of each row. Beyond the image's border the last column is repeated.
    #[inline(always)]
    fn filter_down<const RADIUS: usize, const FUSED: bool>(
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
        for x in (from..to).step_by(LANES) {
            let whole = x + LANES <= width;
            let load = |row: &[f32]| {
                if whole {
                    lanes(row, x)
                } else {
                    last_lanes(row, x)
                }
            };
            let middle = load(centre);
            let mut sums = [[0.0; LANES]; RADIUS];
            let mut differences = [[0.0; LANES]; RADIUS];
            for k in 0..RADIUS {
                let (before, after) = (load(above[k]), load(below[k]));
                sums[k] = add(after, before);
                differences[k] = subtract(after, before);
            }
            for kernel in &self.vertical.even {
                let value = kernel.even::<RADIUS, FUSED>(middle, &sums);
                rows[kernel.place * ROW + place(x)..][..LANES].copy_from_slice(&value);
            }
            for kernel in &self.vertical.odd {
                let value = kernel.odd::<RADIUS, FUSED>(&differences);
                rows[kernel.place * ROW + place(x)..][..LANES].copy_from_slice(&value);
            }
        }
        for row in rows.chunks_exact_mut(ROW) {
            let first = row[place(from)];
            row[..place(from)].fill(first);
            let last = row[place(to) - 1];
            row[place(to)..place(end) + RADIUS].fill(last);
        }
    }

    /// The products at [`LANES`] pixels, `x` pixels into the strip.
    #[inline(always)]
    fn filter_across<const RADIUS: usize, const FUSED: bool>(
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
                    products[kernel.place] = kernel.even::<RADIUS, FUSED>(side(RADIUS), &sums);
                }
            }
            if !stage.odd.is_empty() {
                let differences: [Lanes; RADIUS] =
                    std::array::from_fn(|k| subtract(side(RADIUS + 1 + k), side(RADIUS - 1 - k)));
                for kernel in &stage.odd {
                    products[kernel.place] = kernel.odd::<RADIUS, FUSED>(&differences);
                }
            }
        }
    }

    /// The parts of the responses from the products.
    #[inline(always)]
    fn combine<const FUSED: bool>(&self, products: &[Lanes], parts: &mut [Lanes]) {
        for (terms, part) in self.parts.iter().zip(parts) {
            let Some(((weight, first), others)) = terms.split_first() else {
                continue;
            };
            let mut sum = multiply(*weight, products[*first]);
            for (weight, product) in others {
                sum = multiply_add::<FUSED>(*weight, products[*product], sum);
            }
            *part = sum;
        }
    }
}

impl SpreadKernel {
    fn new(kernel: &Kernel, place: usize) -> Self {
        Self {
            centre: [kernel.taps[0]; LANES],
            sides: kernel.taps[1..].iter().map(|&tap| [tap; LANES]).collect(),
            place,
        }
    }

    #[inline(always)]
    fn even<const RADIUS: usize, const FUSED: bool>(
        &self,
        middle: Lanes,
        sums: &[Lanes; RADIUS],
    ) -> Lanes {
        let mut value = multiply(self.centre, middle);
        let sides = &self.sides[..RADIUS];
        for k in 0..RADIUS {
            value = multiply_add::<FUSED>(sides[k], sums[k], value);
        }
        value
    }

    #[inline(always)]
    fn odd<const RADIUS: usize, const FUSED: bool>(&self, differences: &[Lanes; RADIUS]) -> Lanes {
        let sides = &self.sides[..RADIUS];
        let mut value = multiply(sides[0], differences[0]);
        for k in 1..RADIUS {
            value = multiply_add::<FUSED>(sides[k], differences[k], value);
        }
        value
    }
}

/// Writes parts `[[part, pixel]]` as `[[pixel, part]]`, as many pixels as `out` has.
#[inline(always)]
fn interleave(parts: &[Lanes], out: &mut [f32]) {
    if let (Ok(parts), Ok(out)) = (
        <&[Lanes; 16]>::try_from(parts),
        <&mut [f32; 16 * LANES]>::try_from(&mut *out),
    ) {
        for half in 0..2 {
            let turned = turn(std::array::from_fn(|part| parts[half * LANES + part]));
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

/// Rows become columns. Written as the three rounds of pairwise shuffles that a vector unit has
/// instructions for.
#[inline(always)]
fn turn(rows: [Lanes; LANES]) -> [Lanes; LANES] {
    let low = |a: Lanes, b: Lanes| [a[0], b[0], a[1], b[1], a[4], b[4], a[5], b[5]];
    let high = |a: Lanes, b: Lanes| [a[2], b[2], a[3], b[3], a[6], b[6], a[7], b[7]];
    let low_pairs = |a: Lanes, b: Lanes| [a[0], a[1], b[0], b[1], a[4], a[5], b[4], b[5]];
    let high_pairs = |a: Lanes, b: Lanes| [a[2], a[3], b[2], b[3], a[6], a[7], b[6], b[7]];
    let low_half = |a: Lanes, b: Lanes| [a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]];
    let high_half = |a: Lanes, b: Lanes| [a[4], a[5], a[6], a[7], b[4], b[5], b[6], b[7]];
    let [a, b, c, d, e, f, g, h] = rows;
    let (ab, cd, ef, gh) = (low(a, b), low(c, d), low(e, f), low(g, h));
    let (ab_high, cd_high) = (high(a, b), high(c, d));
    let (ef_high, gh_high) = (high(e, f), high(g, h));
    let front = [
        low_pairs(ab, cd),
        high_pairs(ab, cd),
        low_pairs(ab_high, cd_high),
        high_pairs(ab_high, cd_high),
    ];
    let back = [
        low_pairs(ef, gh),
        high_pairs(ef, gh),
        low_pairs(ef_high, gh_high),
        high_pairs(ef_high, gh_high),
    ];
    std::array::from_fn(|i| {
        if i < 4 {
            low_half(front[i], back[i])
        } else {
            high_half(front[i - 4], back[i - 4])
        }
    })
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

/// `a b + c`, in one rounding if `FUSED`.
#[inline(always)]
fn multiply_add<const FUSED: bool>(a: Lanes, b: Lanes, c: Lanes) -> Lanes {
    std::array::from_fn(|i| {
        if FUSED {
            a[i].mul_add(b[i], c[i])
        } else {
            a[i] * b[i] + c[i]
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turning_twice_is_standing_still() {
        let rows: [Lanes; LANES] =
            std::array::from_fn(|y| std::array::from_fn(|x| (y * LANES + x) as f32));
        let turned = turn(rows);
        for y in 0..LANES {
            for x in 0..LANES {
                assert_eq!(turned[y][x], rows[x][y]);
            }
        }
        assert_eq!(turn(turned), rows);
    }
}
