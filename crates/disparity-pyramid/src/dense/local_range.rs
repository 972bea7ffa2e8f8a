use ndarray::{Array2, ArrayView2};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;
use v1_gabor::Size;

use crate::dense::bands::bands;
use crate::dense::fitted::{fit, numbers};

/// Pixels on either side that belong to the neighbourhood.
const REACH: usize = 2;

/// How far shifts differ around each pixel, with what it takes to tell.
#[derive(Clone, Debug, Default)]
pub(crate) struct LocalRange {
    range: Array2<f32>,
    rooms: Vec<RowRoom>,
}

/// The least and the largest shift of each column among a few rows, between columns that know none,
/// and the least of a few columns.
#[derive(Clone, Debug, Default)]
struct RowRoom {
    least: Vec<f32>,
    most: Vec<f32>,
    lowest: Vec<f32>,
}

impl LocalRange {
    /// The largest difference between two shifts within 5 x 5 pixels of each pixel: small on one
    /// surface, large at its end.
    pub(crate) fn of(&mut self, dx: ArrayView2<'_, f32>) -> ArrayView2<'_, f32> {
        let (height, width) = dx.dim();
        fit(&mut self.range, Size::of_dim(dx.dim()), 0.0);
        let Some(dx) = dx.to_slice() else {
            unreachable!("planes are made in row-major order")
        };
        let (rooms, rows) = bands(&mut self.rooms, height);
        let bands = numbers(&mut self.range).par_chunks_mut(rows * width);
        bands
            .zip(rooms)
            .enumerate()
            .for_each(|(band, (range, room))| {
                for (y, range) in (band * rows..).zip(range.chunks_exact_mut(width)) {
                    let around = y.saturating_sub(REACH)..(y + REACH + 1).min(height);
                    let rows = &dx[around.start * width..around.end * width];
                    Arch::new().dispatch(RangeOfRows { rows, range, room });
                }
            });
        self.range.view()
    }
}

/// The ranges of one row, from the rows around it.
struct RangeOfRows<'a> {
    rows: &'a [f32],
    range: &'a mut [f32],
    room: &'a mut RowRoom,
}

impl NullaryFnOnce for RangeOfRows<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { rows, range, room } = self;
        let width = range.len();
        let RowRoom {
            least,
            most,
            lowest,
        } = room;
        for (columns, nothing) in [
            (&mut *least, f32::INFINITY),
            (&mut *most, f32::NEG_INFINITY),
        ] {
            columns.clear();
            columns.resize(width + 2 * REACH, nothing);
        }
        lowest.clear();
        lowest.resize(width, f32::INFINITY);
        for row in rows.chunks_exact(width) {
            let columns = least[REACH..].iter_mut().zip(&mut most[REACH..]);
            for ((least, most), dx) in columns.zip(row) {
                *least = lesser(*least, *dx);
                *most = -lesser(-*most, -*dx);
            }
        }
        range.fill(f32::NEG_INFINITY);
        for offset in 0..=2 * REACH {
            for (lowest, least) in lowest.iter_mut().zip(&least[offset..]) {
                *lowest = lesser(*lowest, *least);
            }
            for (range, most) in range.iter_mut().zip(&most[offset..]) {
                *range = -lesser(-*range, -*most);
            }
        }
        for (range, lowest) in range.iter_mut().zip(lowest) {
            *range -= *lowest;
        }
    }
}

/// The lesser of two numbers: one instruction, since no shift is NaN.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Sliding columns feel what every pixel feels that asks its 5 x 5 neighbours; a room that has been
        /// used for another image knows nothing of it.
        #[test]
        fn fast_and_plain_agree(width in 1usize..50, height in 1usize..40, seed: u64) {
            let mut state = seed | 1;
            let mut dx = |dim| {
                Array2::from_shape_simple_fn(dim, || {
                    state ^= state << 13;
                    state ^= state >> 7;
                    state ^= state << 17;
                    -(((state >> 20) % 1000) as f32) / 8.0
                })
            };
            let mut room = LocalRange::default();
            room.of(dx((9, 70)).view());
            let dx = dx((height, width));
            for ((y, x), range) in room.of(dx.view()).indexed_iter() {
                let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
                for y in y.saturating_sub(2)..(y + 3).min(height) {
                    for x in x.saturating_sub(2)..(x + 3).min(width) {
                        least = least.min(dx[[y, x]]);
                        most = most.max(dx[[y, x]]);
                    }
                }
                prop_assert_eq!(*range, most - least, "{}, {}", x, y);
            }
        }
    }

    #[test]
    fn a_step_is_felt_two_pixels_away() {
        let dx = Array2::from_shape_fn((6, 12), |(_, x)| if x < 6 { -1.0 } else { -4.0 });
        for ((_, x), range) in LocalRange::default().of(dx.view()).indexed_iter() {
            assert_eq!(
                *range,
                if (4..8).contains(&x) { 3.0 } else { 0.0 },
                "column {x}"
            );
        }
    }
}
