use crate::ahead::Ahead;
use crate::lanes::{Neighbours, Row, SpreadKernel};
use crate::machine::Machine;
use crate::separable::{Recipe, Separable, Term};

/// What becomes of the rows that one or two vertical kernels give, in a bank of Gabor filters: the
/// parts of an orientation, and of its mirror image about the vertical axis, which has the same
/// products with the signs of the second ones turned.
///
/// Rows and parts are named by their places. The horizontal kernels hold the filter's gain.
#[derive(Clone, Debug)]
pub(crate) enum Quadrature {
    /// A wave along x: one row, both parts.
    AlongX {
        row: usize,
        cosine: SpreadKernel,
        sine: SpreadKernel,
        parts: Parts,
    },
    /// A wave along y: one kernel, each part from its own row.
    AlongY {
        cosine: usize,
        sine: usize,
        across: SpreadKernel,
        parts: Parts,
    },
    /// Any other direction, with its mirror image.
    Oblique {
        /// Those of the vertical cosine and of the vertical sine.
        rows: (usize, usize),
        cosine: SpreadKernel,
        sine: SpreadKernel,
        parts: Parts,
        mirrored: Parts,
    },
}

/// Where the even and the odd part of one orientation go.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parts {
    even: usize,
    odd: usize,
}

const DISTINCT: &str = "every part has a row of its own";

impl Parts {
    /// The rows of the two parts.
    #[inline(always)]
    fn of(self, rows: &mut [Row]) -> [&mut Row; 2] {
        rows.get_disjoint_mut([self.even, self.odd])
            .expect(DISTINCT)
    }
}

impl Quadrature {
    /// A bank of Gabor filters in this form; `None` if some filter is of another kind. `listed` are
    /// the vertical kernels in the order of their rows.
    pub(crate) fn of(bank: &Separable, listed: &[usize]) -> Option<Vec<Self>> {
        let orientations = bank.recipes.len();
        let row = |kernel: usize| listed.iter().position(|&listed| listed == kernel);
        let parts = |q: usize| Parts {
            even: q,
            odd: orientations + q,
        };
        let spread = |kernel: usize, gain: f32| SpreadKernel::new(&bank.kernels[kernel], gain);
        let products = |recipe: &Recipe| {
            let terms = recipe.even.iter().chain(&recipe.odd);
            terms.map(|term| term.product).collect::<Vec<_>>()
        };
        let mut found = Vec::new();
        for (q, recipe) in bank.recipes.iter().enumerate().take(orientations / 2 + 1) {
            let at = |term: &Term| bank.products[term.product];
            match (&*recipe.even, &*recipe.odd) {
                ([even], [odd]) if even.weight == odd.weight => {
                    let (even, odd, gain) = (at(even), at(odd), even.weight);
                    if even.vertical == odd.vertical {
                        found.push(Self::AlongX {
                            row: row(even.vertical)?,
                            cosine: spread(even.horizontal, gain),
                            sine: spread(odd.horizontal, gain),
                            parts: parts(q),
                        });
                    } else if even.horizontal == odd.horizontal {
                        found.push(Self::AlongY {
                            cosine: row(even.vertical)?,
                            sine: row(odd.vertical)?,
                            across: spread(even.horizontal, gain),
                            parts: parts(q),
                        });
                    } else {
                        return None;
                    }
                }
                ([cosines, sines], [_, cosine_sine]) => {
                    let gain = cosines.weight;
                    let mirrored = orientations - q;
                    let mirror = &bank.recipes[mirrored];
                    if products(recipe) != products(mirror) || cosine_sine.weight != gain {
                        return None;
                    }
                    let (cosines, sines) = (at(cosines), at(sines));
                    found.push(Self::Oblique {
                        rows: (row(cosines.vertical)?, row(sines.vertical)?),
                        cosine: spread(cosines.horizontal, gain),
                        sine: spread(sines.horizontal, gain),
                        parts: parts(q),
                        mirrored: parts(mirrored),
                    });
                }
                _ => return None,
            }
        }
        Some(found)
    }

    /// Writes the parts of a strip, one row of `out` each, from the rows that the vertical kernels
    /// gave, up to `width` pixels rounded up to whole lanes. `ahead` is
    /// asked for more at each step.
    #[inline(always)]
    pub(crate) fn filter<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
        &self,
        machine: M,
        rows: &[Row],
        width: usize,
        out: &mut [Row],
        ahead: &mut Ahead<'_>,
    ) {
        match self {
            Self::AlongX {
                row,
                cosine,
                sine,
                parts,
            } => {
                let row = &rows[*row];
                let [even, odd] = parts.of(out);
                for x in (0..width).step_by(LANES) {
                    ahead.ask();
                    let seen = Neighbours::at(row, x);
                    let [parts] = both::<RADIUS, LANES, 1, M>(machine, (cosine, sine), [seen]);
                    *even.lanes_mut(x) = machine.store(parts.0);
                    *odd.lanes_mut(x) = machine.store(parts.1);
                }
            }
            Self::AlongY {
                cosine,
                sine,
                across,
                parts,
            } => {
                for (row, part) in [(*cosine, parts.even), (*sine, parts.odd)] {
                    let (row, out) = (&rows[row], &mut out[part]);
                    for x in (0..width).step_by(LANES) {
                        ahead.ask();
                        let seen = Neighbours::at(row, x);
                        let value = even::<RADIUS, LANES, M>(machine, across, seen);
                        *out.lanes_mut(x) = machine.store(value);
                    }
                }
            }
            Self::Oblique {
                rows: (cosine_row, sine_row),
                cosine,
                sine,
                parts,
                mirrored,
            } => {
                let (cosine_row, sine_row) = (&rows[*cosine_row], &rows[*sine_row]);
                let places = [parts.even, parts.odd, mirrored.even, mirrored.odd];
                let [even, odd, mirrored_even, mirrored_odd] =
                    out.get_disjoint_mut(places).expect(DISTINCT);
                let kernels = (cosine, sine);
                for x in (0..width).step_by(LANES) {
                    ahead.ask();
                    let seen = [Neighbours::at(cosine_row, x), Neighbours::at(sine_row, x)];
                    let [(cosines, cosine_sine), (sine_cosine, sines)] =
                        both::<RADIUS, LANES, 2, M>(machine, kernels, seen);
                    *even.lanes_mut(x) = machine.store(machine.subtract(cosines, sines));
                    *odd.lanes_mut(x) = machine.store(machine.add(sine_cosine, cosine_sine));
                    *mirrored_even.lanes_mut(x) = machine.store(machine.add(cosines, sines));
                    *mirrored_odd.lanes_mut(x) =
                        machine.store(machine.subtract(sine_cosine, cosine_sine));
                }
            }
        }
    }
}

/// The results of an even and of an odd kernel on each of some rows, side by side, so that each
/// neighbour and each tap is read once.
#[inline(always)]
fn both<const RADIUS: usize, const LANES: usize, const ROWS: usize, M: Machine<LANES>>(
    machine: M,
    (cosine, sine): (&SpreadKernel, &SpreadKernel),
    seen: [Neighbours<'_>; ROWS],
) -> [(M::Vector, M::Vector); ROWS] {
    let middle = cosine.tap(machine, 0);
    let mut results = [(middle, middle); ROWS];
    for row in 0..ROWS {
        results[row].0 = machine.multiply(middle, seen[row].middle::<RADIUS, LANES, M>(machine));
    }
    for k in 1..=RADIUS {
        let taps = (cosine.tap(machine, k), sine.tap(machine, k));
        for row in 0..ROWS {
            let (even, odd) = results[row];
            let sum = seen[row].sum::<RADIUS, LANES, M>(machine, k);
            let difference = seen[row].difference::<RADIUS, LANES, M>(machine, k);
            results[row] = (
                machine.multiply_add(taps.0, sum, even),
                if k == 1 {
                    machine.multiply(taps.1, difference)
                } else {
                    machine.multiply_add(taps.1, difference, odd)
                },
            );
        }
    }
    results
}

#[inline(always)]
fn even<const RADIUS: usize, const LANES: usize, M: Machine<LANES>>(
    machine: M,
    kernel: &SpreadKernel,
    seen: Neighbours<'_>,
) -> M::Vector {
    let middle = seen.middle::<RADIUS, LANES, M>(machine);
    kernel.even::<RADIUS, LANES, M>(machine, middle, &seen.sums(machine))
}
