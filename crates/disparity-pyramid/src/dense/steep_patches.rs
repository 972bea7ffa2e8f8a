use std::ops::Range;

use ndarray::Array2;

use crate::dense::phase_slants::{BLOCK, Slant};

/// The steepest slant that is looked at, in pixels a row: phases that say more are not believed.
pub(crate) const STEEPEST: f32 = 1.5;

/// The slants, as phases tell them, at which steps of whole pixels begin to lose a surface, in pixels a row: steep ones
/// are told too small.
const STEEP: Range<f32> = 0.1..STEEPEST;

/// How much of that a block has at least that belongs to a patch begun beside it.
const BESIDE: f32 = 0.5;

/// How far slants of neighbouring blocks of one patch may differ, in pixels a row.
const ALIKE: f32 = 0.35;

/// Fewer blocks than this are taken for chance,
const LEAST_BLOCKS: usize = 6;

/// and fewer than one in so many of the picture's are not worth a look: most of what is cut out for them is not
/// theirs.
const LEAST_SHARE: usize = 256;

/// Blocks that lie side by side and are slanted alike.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SteepPatch {
    /// The rows and columns of pixels that its blocks lie in; the last may end beyond the image.
    pub(crate) rows: Range<usize>,
    pub(crate) columns: Range<usize>,
    /// The mean of its blocks' `d dx / dy` by weight, in pixels a row.
    pub(crate) down: f32,
    /// How many blocks it has.
    pub(crate) blocks: usize,
}

/// The patches of a picture, begun at what is steep and grown over what is half as steep, the largest first; of two as
/// large the upper left one.
pub(crate) fn steep_patches(slants: &Array2<Slant>) -> Vec<SteepPatch> {
    let is_steep = |slant: &Slant, part: f32| {
        slant.weight > 0.0 && (part * STEEP.start..STEEP.end).contains(&slant.down.abs())
    };
    let mut taken = slants.map(|slant| !is_steep(slant, BESIDE));
    let least = LEAST_BLOCKS.max(slants.len() / LEAST_SHARE);
    let mut patches = Vec::new();
    let mut open = Vec::new();
    for ((row, column), slant) in slants.indexed_iter() {
        if taken[[row, column]] || !is_steep(slant, 1.0) {
            continue;
        }
        taken[[row, column]] = true;
        open.push((row, column));
        let mut blocks = Vec::new();
        while let Some((row, column)) = open.pop() {
            blocks.push((row, column));
            for v in row.saturating_sub(1)..(row + 2).min(slants.nrows()) {
                for u in column.saturating_sub(1)..(column + 2).min(slants.ncols()) {
                    let apart = (slants[[v, u]].down - slants[[row, column]].down).abs();
                    if !taken[[v, u]] && apart <= ALIKE {
                        taken[[v, u]] = true;
                        open.push((v, u));
                    }
                }
            }
        }
        if blocks.len() >= least {
            patches.push(SteepPatch::of(&blocks, slants));
        }
    }
    patches.sort_by_key(|patch| std::cmp::Reverse(patch.blocks));
    patches
}

impl SteepPatch {
    fn of(blocks: &[(usize, usize)], slants: &Array2<Slant>) -> Self {
        let pixels = |least: Option<usize>, most: Option<usize>| {
            BLOCK * least.unwrap_or(0)..BLOCK * (most.unwrap_or(0) + 1)
        };
        let rows = || blocks.iter().map(|(row, _)| *row);
        let columns = || blocks.iter().map(|(_, column)| *column);
        Self {
            rows: pixels(rows().min(), rows().max()),
            columns: pixels(columns().min(), columns().max()),
            down: Slant::mean(blocks.iter().map(|block| slants[*block])).down,
            blocks: blocks.len(),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn slanted(down: f32) -> Slant {
        Slant { down, weight: 1.0 }
    }

    /// Blocks that are flat, too few, or slanted the other way are no part of a patch.
    #[test]
    fn patches_are_what_is_slanted_alike() {
        let mut slants = Array2::from_elem((9, 12), slanted(0.02));
        // Eight blocks of one slant, six of the other beside them, and five that are too few.
        slants.slice_mut(ndarray::s![1..3, 1..5]).fill(slanted(0.6));
        slants
            .slice_mut(ndarray::s![1..3, 5..8])
            .fill(slanted(-0.4));
        slants.slice_mut(ndarray::s![7, 2..7]).fill(slanted(0.5));
        // What is half as steep belongs to a patch that it lies beside, and begins none.
        slants[[0, 1]] = slanted(0.3);
        slants[[0, 0]] = slanted(0.06);
        slants.slice_mut(ndarray::s![0..6, 10]).fill(slanted(0.09));
        // What is silent or beyond belief belongs to nothing.
        slants[[3, 1]] = Slant {
            down: 0.6,
            weight: 0.0,
        };
        slants[[3, 2]] = slanted(1.6);
        let patches = steep_patches(&slants);
        let told: Vec<_> = patches
            .iter()
            .map(|patch| (patch.blocks, &patch.rows, &patch.columns))
            .collect();
        assert_eq!(
            told,
            [
                (10, &(0..3 * BLOCK), &(0..5 * BLOCK)),
                (6, &(BLOCK..3 * BLOCK), &(5 * BLOCK..8 * BLOCK)),
            ]
        );
        let mean = (8.0 * 0.6 + 0.3 + 0.06) / 10.0;
        assert!((patches[0].down - mean).abs() < 1e-6 && (patches[1].down + 0.4).abs() < 1e-6);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        /// No block is in two patches, larger patches come first, and a patch's slant is one that its blocks have.
        #[test]
        fn patches_share_nothing(rows in 1usize..9, columns in 1usize..9, seed: u64) {
            let mut state = seed | 1;
            let slants = Array2::from_shape_simple_fn((rows, columns), || {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                let down = ((state >> 20) % 33) as f32 / 20.0 - 0.8;
                Slant { down, weight: ((state >> 40) % 3) as f32 }
            });
            let patches = steep_patches(&slants);
            let blocks: usize = patches.iter().map(|patch| patch.blocks).sum();
            // What is grown over counts too: it need be half as steep only.
            let grown = BESIDE * STEEP.start..STEEP.end;
            let steep = slants.iter().filter(|slant| slant.weight > 0.0 && grown.contains(&slant.down.abs()));
            prop_assert!(blocks <= steep.count());
            prop_assert!(patches.is_sorted_by_key(|patch| std::cmp::Reverse(patch.blocks)));
            for patch in patches {
                prop_assert!(patch.blocks >= LEAST_BLOCKS);
                prop_assert!(STEEP.end >= patch.down.abs());
                prop_assert!(patch.rows.end <= rows * BLOCK && patch.columns.end <= columns * BLOCK);
                prop_assert!(patch.blocks <= patch.rows.len() * patch.columns.len() / (BLOCK * BLOCK));
            }
        }
    }
}
