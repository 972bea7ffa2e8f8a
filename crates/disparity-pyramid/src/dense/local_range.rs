use ndarray::{Array2, ArrayView2};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;
use v1_gabor::Size;

use crate::dense::bands::bands;
use crate::dense::fitted::{fit, numbers};
use crate::dense::lesser::{greater, lesser};

/// Pixels on either side that belong to the neighbourhood.
const REACH: usize = 2;

/// How far shifts differ around each pixel, with what it takes to tell.
#[derive(Clone, Debug, Default)]
pub(crate) struct LocalRange {
    range: Array2<f32>,
    rooms: Vec<RowRoom>,
}

/// The least and the largest shift of each column among a few rows, and again beyond either end those of
/// the last column.
#[derive(Clone, Debug, Default)]
struct RowRoom {
    least: Vec<f32>,
    most: Vec<f32>,
}

impl LocalRange {
    /// The largest difference between two shifts within 5 x 5 pixels of each pixel: small on one
    /// surface, large at its end.
    pub(crate) fn of(&mut self, dx: ArrayView2<'_, f32>) -> &Array2<f32> {
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
                    // Beyond the image the last row stands again: the range stays what it is.
                    let mut rows = [dx; 2 * REACH + 1];
                    for (i, row) in rows.iter_mut().enumerate() {
                        let y = (y + i).saturating_sub(REACH).min(height - 1);
                        *row = &dx[y * width..][..width];
                    }
                    Arch::new().dispatch(RangeOfRows { rows, range, room });
                }
            });
        &self.range
    }
}

/// The ranges of one row, from the rows around it.
struct RangeOfRows<'a> {
    rows: [&'a [f32]; 2 * REACH + 1],
    range: &'a mut [f32],
    room: &'a mut RowRoom,
}

impl NullaryFnOnce for RangeOfRows<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self { rows, range, room } = self;
        let width = range.len();
        let [a, b, c, d, e] = rows;
        let (a, b, c) = (&a[..width], &b[..width], &c[..width]);
        let (d, e) = (&d[..width], &e[..width]);
        let RowRoom { least, most } = room;
        for columns in [&mut *least, &mut *most] {
            columns.resize(width + 2 * REACH, 0.0);
        }
        let (inner_least, inner_most) = (&mut least[REACH..][..width], &mut most[REACH..][..width]);
        for x in 0..width {
            let low = lesser(lesser(a[x], b[x]), lesser(d[x], e[x]));
            let high = greater(greater(a[x], b[x]), greater(d[x], e[x]));
            inner_least[x] = lesser(low, c[x]);
            inner_most[x] = greater(high, c[x]);
        }
        for columns in [&mut *least, &mut *most] {
            let (first, last) = (columns[REACH], columns[REACH + width - 1]);
            columns[..REACH].fill(first);
            columns[REACH + width..].fill(last);
        }
        let (least, most) = (&least[..width + 2 * REACH], &most[..width + 2 * REACH]);
        for x in 0..width {
            let low = lesser(
                lesser(least[x], least[x + 1]),
                lesser(least[x + 3], least[x + 4]),
            );
            let high = greater(
                greater(most[x], most[x + 1]),
                greater(most[x + 3], most[x + 4]),
            );
            range[x] = greater(high, most[x + 2]) - lesser(low, least[x + 2]);
        }
    }
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
