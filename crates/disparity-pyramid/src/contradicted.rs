use ndarray::Array2;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::Validity;

const CONTIGUOUS: &str = "planes are made in row-major order";

/// Refuses the answers whose surroundings the coarser scale contradicts: where at least `least` of the 3 x 3
/// pixels about a place are [`Incoherent`](Validity::Incoherent) there, an answer becomes so too.
///
/// Where a search is lost, medians still carry the shifts of what lies beside it into the place, and among
/// so many a few agree with the phases by chance, in both eyes alike; but by another chance at
/// each scale. A surface is seen at both. What is silent at the coarser scale contradicts nothing.
///
/// `halvings` is the logarithm of how many times as many pixels a side as `coarser` the plane has.
pub(crate) fn refuse_contradicted(
    validity: &mut Array2<Validity>,
    coarser: &Array2<Validity>,
    halvings: u32,
    least: usize,
) {
    let (width, (rows, columns)) = (validity.dim().1, coarser.dim());
    let coarser = coarser.as_slice().expect(CONTIGUOUS);
    let least = u8::try_from(least).unwrap_or(u8::MAX);
    validity
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width)
        .enumerate()
        .for_each_init(
            || (vec![0; columns + 2], vec![false; columns]),
            |(counts, contradicted), (y, validity)| {
                let row = (y >> halvings).min(rows - 1);
                let around = row.saturating_sub(1)..(row + 2).min(rows);
                Arch::new().dispatch(Row {
                    coarser: &coarser[around.start * columns..around.end * columns],
                    halvings,
                    least,
                    counts,
                    contradicted,
                    validity,
                });
            },
        );
}

/// One row's work.
struct Row<'a> {
    /// Two or three rows of the coarser scale, one after the other.
    coarser: &'a [Validity],
    halvings: u32,
    least: u8,
    /// Room for the contradictions of each column of these rows, and of nothing to either side.
    counts: &'a mut [u8],
    /// Room for what they come to about each column.
    contradicted: &'a mut [bool],
    validity: &'a mut [Validity],
}

impl WithSimd for Row<'_> {
    type Output = ();

    // The loops are compiled for the machine's vectors.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self {
            coarser,
            halvings,
            least,
            counts,
            contradicted,
            validity,
        } = self;
        let columns = contradicted.len();
        counts.fill(0);
        for row in coarser.chunks_exact(columns) {
            for x in 0..columns {
                counts[x + 1] += u8::from(row[x] == Validity::Incoherent);
            }
        }
        for x in 0..columns {
            contradicted[x] = counts[x] + counts[x + 1] + counts[x + 2] >= least;
        }
        for (x, word) in validity.iter_mut().enumerate() {
            let refused = contradicted[(x >> halvings).min(columns - 1)];
            *word = if refused & word.is_valid() {
                Validity::Incoherent
            } else {
                *word
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block of nonsense at the coarser scale refuses what lies within it; its rim, a line of it and silence
    /// refuse nothing.
    #[test]
    fn answers_need_the_coarser_scale_not_to_contradict() {
        let coarser = Array2::from_shape_fn((12, 16), |(y, x)| match (y, x) {
            (2..=5, 2..=5) | (9, _) => Validity::Incoherent,
            (_, 10..) => Validity::NoEnergy,
            _ => Validity::Valid,
        });
        for halvings in [0, 1] {
            // An odd number of rows and columns, as half of a scale may have.
            let dim = ((12 << halvings) - 1, (16 << halvings) - 1);
            let silent = [0, 0];
            let mut validity = Array2::from_elem(dim, Validity::Valid);
            validity[silent] = Validity::NoEnergy;
            refuse_contradicted(&mut validity, &coarser, halvings, 6);
            for ((y, x), word) in validity.indexed_iter() {
                let (row, column) = (y >> halvings, x >> halvings);
                // Six of nine: within the block or at the middle of a side, not at a corner.
                let sides = |at: usize| (2..=5).contains(&at);
                let corner = [2, 5].contains(&row) && [2, 5].contains(&column);
                let lost = sides(row) && sides(column) && !corner;
                let expected = match (lost, [y, x] == silent) {
                    (true, _) => Validity::Incoherent,
                    (_, true) => Validity::NoEnergy,
                    _ => Validity::Valid,
                };
                assert_eq!(*word, expected, "at {row}, {column}");
            }
        }
    }
}
