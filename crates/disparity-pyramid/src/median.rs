use ndarray::{Array2, ArrayView2};
use pulp::{Arch, NullaryFnOnce, Simd, WithSimd};
use rayon::prelude::*;
use v1_gabor::Size;

use crate::median_network::{median_of_9, middle_of_5_columns, sorted_5};
use crate::slopes::{RowSlopes, Slopes};
use crate::vector::{store, vector};
use crate::{MedianRadius, Validity};

/// At least the lanes of the widest vector there is; rows are padded to whole vectors.
const MOST_LANES: usize = 16;

/// The median of the known values around each pixel; a pixel without a known neighbour stays
/// unknown. Unknown is NaN. Outside the plane nothing is known.
///
/// The median of an even number of values is the larger of the two in the middle.
pub(crate) fn median_of_known(plane: ArrayView2<'_, f32>, radius: MedianRadius) -> Array2<f32> {
    let mut padded = Padded::new(radius, Size::of_dim(plane.dim()));
    padded.take_in(plane.to_slice().expect(CONTIGUOUS), None);
    let mut filtered = Array2::zeros(plane.dim());
    padded.filter(filtered.as_slice_mut().expect(CONTIGUOUS), false, None);
    filtered
}

/// The windows that medians look through, and what a shift does within one.
#[derive(Clone, Copy)]
pub(crate) struct Windows<'a> {
    pub(crate) radius: MedianRadius,
    /// How far one pixel of the planes is from the next, in the pixels that slopes are per.
    pub(crate) step: usize,
    /// How fast the shifts grow; see [`Trend`].
    pub(crate) slopes: &'a Slopes,
}

/// How one component of the shifts grows within a window. At the border of what is known, a window
/// has neighbours on one side only, and on a slope their middle is another place's: they are
/// brought to the place that asks along the slope first.
#[derive(Clone, Copy)]
struct Trend<'a> {
    slopes: &'a Slopes,
    /// Where a component's two slopes begin among those of a place: 0 for `dx`, 2 for `dy`.
    first: usize,
    step: f32,
}

/// [`median_of_known`] of one plane after the other in place, with what it works in.
#[derive(Clone, Debug, Default)]
pub(crate) struct KnownMedian(Option<Padded>);

impl KnownMedian {
    /// Replaces the plane by its medians.
    pub(crate) fn smooth(&mut self, plane: &mut Array2<f32>, radius: MedianRadius) {
        let size = Size::of_dim(plane.dim());
        let held = self.0.take();
        let held = held.filter(|padded| (padded.radius, padded.size) == (radius, size));
        let padded = self
            .0
            .insert(held.unwrap_or_else(|| Padded::new(radius, size)));
        let plane = plane.as_slice_mut().expect(CONTIGUOUS);
        padded.take_in(plane, None);
        padded.filter(plane, false, None);
    }
}

/// Medians of planes of one size, with what they work in.
#[derive(Clone, Debug, Default)]
pub(crate) struct Medians {
    /// What a filter reads, and what it writes for the next one to read.
    planes: Option<[Padded; 2]>,
}

impl Medians {
    /// As many medians, one upon the other, of each plane's valid values, in place; what has no valid
    /// neighbour keeps its value.
    pub(crate) fn smooth_valid(
        &mut self,
        planes: [&mut Array2<f32>; 2],
        validity: &Array2<Validity>,
        times: usize,
        windows: Windows<'_>,
    ) {
        if times == 0 {
            return;
        }
        let size = Size::of_dim(validity.dim());
        let Windows {
            radius,
            step,
            slopes,
        } = windows;
        let room = self.planes.take();
        let fits = |room: &[Padded; 2]| (room[0].radius, room[0].size) == (radius, size);
        let mut room = room
            .filter(fits)
            .unwrap_or_else(|| [Padded::new(radius, size), Padded::new(radius, size)]);
        let validity = validity.as_slice().expect(CONTIGUOUS);
        for (plane, first) in planes.into_iter().zip([0, 2]) {
            let trend = Some(Trend {
                slopes,
                first,
                step: step as f32,
            });
            let plane = plane.as_slice_mut().expect(CONTIGUOUS);
            room[0].take_in(plane, Some(validity));
            for _ in 1..times {
                let [now, next] = &mut room;
                now.filter_into(next, trend);
                room.swap(0, 1);
            }
            room[0].filter(plane, true, trend);
        }
        self.planes = Some(room);
    }
}

const CONTIGUOUS: &str = "planes are made in row-major order";

/// A plane among unknown values, so that every window is whole.
#[derive(Clone, Debug)]
struct Padded {
    radius: MedianRadius,
    size: Size,
    reach: usize,
    /// Numbers to a row.
    stride: usize,
    numbers: Vec<f32>,
    /// Blocks of [`MOST_LANES`] numbers to a row.
    blocks: usize,
    /// What is unknown in each block.
    unknown: Vec<Unknown>,
}

/// Which of a block of values are unknown, a bit each, the first one's being the lowest. Most windows are
/// known altogether, and nothing is replaced there; of an empty wall nothing is, and nothing is done.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Unknown(u16);

impl Unknown {
    /// Nothing is known.
    const ALL: Self = Self(u16::MAX);
    /// Everything is.
    const NONE: Self = Self(0);
}

impl Padded {
    fn new(radius: MedianRadius, size: Size) -> Self {
        let reach = match radius {
            MedianRadius::One => 1,
            MedianRadius::Two => 2,
        };
        // Whole vectors of windows, and one more for the columns that the last of them share.
        let stride = size.width.next_multiple_of(MOST_LANES) + MOST_LANES;
        let blocks = stride / MOST_LANES;
        let rows = size.height + 2 * reach;
        Self {
            radius,
            size,
            reach,
            stride,
            numbers: vec![f32::NAN; stride * rows],
            blocks,
            unknown: vec![Unknown::ALL; blocks * rows],
        }
    }

    /// The rows of the plane, and what is in the blocks of each.
    fn rows_mut(&mut self) -> impl IndexedParallelIterator<Item = (&mut [f32], &mut [Unknown])> {
        let (reach, height) = (self.reach, self.size.height);
        self.numbers
            .par_chunks_mut(self.stride)
            .zip(self.unknown.par_chunks_mut(self.blocks))
            .skip(reach)
            .take(height)
    }

    /// Copies a plane; only what is valid, if validities are given.
    fn take_in(&mut self, plane: &[f32], validity: Option<&[Validity]>) {
        let (reach, width) = (self.reach, self.size.width);
        self.rows_mut()
            .zip(plane.par_chunks(width))
            .enumerate()
            .for_each(|(y, ((numbers, unknown), row))| {
                let inner = &mut numbers[reach..reach + width];
                match validity {
                    None => inner.copy_from_slice(row),
                    Some(validity) => {
                        let validity = &validity[y * width..][..width];
                        for ((out, &value), validity) in inner.iter_mut().zip(row).zip(validity) {
                            *out = if validity.is_valid() { value } else { f32::NAN };
                        }
                    }
                }
                note_unknown(numbers, unknown);
            });
    }

    /// The median around each pixel. Where nothing is known `out` becomes unknown, or keeps its
    /// value.
    fn filter(&self, out: &mut [f32], keep: bool, trend: Option<Trend<'_>>) {
        out.par_chunks_mut(self.size.width)
            .enumerate()
            .for_each(|(y, out)| self.filter_row(y, out, keep, trend));
    }

    /// The median around each pixel, unknown where nothing is known, as a plane to filter again.
    fn filter_into(&self, out: &mut Self, trend: Option<Trend<'_>>) {
        let inner = self.reach..self.reach + self.size.width;
        out.rows_mut()
            .enumerate()
            .for_each(|(y, (numbers, unknown))| {
                self.filter_row(y, &mut numbers[inner.clone()], false, trend);
                note_unknown(numbers, unknown);
            });
    }

    fn filter_row(&self, y: usize, out: &mut [f32], keep: bool, trend: Option<Trend<'_>>) {
        Arch::new().dispatch(Row {
            rows: &self.numbers[y * self.stride..],
            stride: self.stride,
            unknown: &self.unknown[y * self.blocks..],
            blocks: self.blocks,
            radius: self.radius,
            keep,
            trend: trend.and_then(|trend| trend.of_row(y)),
            out,
        });
    }
}

/// Notes what is unknown in each block of a row.
fn note_unknown(numbers: &[f32], unknown: &mut [Unknown]) {
    Arch::new().dispatch(Note { numbers, unknown });
}

struct Note<'a> {
    numbers: &'a [f32],
    unknown: &'a mut [Unknown],
}

impl NullaryFnOnce for Note<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let (blocks, _) = self.numbers.as_chunks::<MOST_LANES>();
        for (block, unknown) in blocks.iter().zip(self.unknown) {
            let mut bits = 0;
            for i in 0..MOST_LANES {
                bits |= u16::from(block[i].is_nan()) << i;
            }
            *unknown = Unknown(bits);
        }
    }
}

/// The trend along one row.
#[derive(Clone, Copy)]
struct RowTrend<'a> {
    slopes: RowSlopes<'a>,
    first: usize,
    step: f32,
}

impl<'a> Trend<'a> {
    fn of_row(&self, y: usize) -> Option<RowTrend<'a>> {
        Some(RowTrend {
            slopes: self.slopes.of_row(y)?,
            first: self.first,
            step: self.step,
        })
    }
}

impl RowTrend<'_> {
    /// By how much a component grows from one column to the next (`along` is 0) or from one row to the next (1)
    /// at the pixels that a vector holds, the first one being in column `x`; `None` if it grows at none.
    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, along: usize, x: usize) -> Option<S::f32s> {
        if !self.slopes.are_followed(x, S::F32_LANES) {
            return None;
        }
        let mut slopes = [0.0; MOST_LANES];
        self.slopes
            .copy(self.first + along, x, &mut slopes[..S::F32_LANES]);
        Some(self.of_step(simd, &slopes))
    }

    /// By how much it grows from one row to the next in the columns of a vector of padded ones, the first
    /// of them being `column`.
    #[inline(always)]
    fn of_columns<S: Simd>(&self, simd: S, column: usize) -> Option<S::f32s> {
        const PADDING: usize = SIDE / 2;
        if column >= PADDING {
            return self.at(simd, 1, column - PADDING);
        }
        if !self.slopes.are_followed(0, S::F32_LANES) {
            return None;
        }
        let mut slopes = [0.0; MOST_LANES];
        self.slopes.copy(
            self.first + 1,
            0,
            &mut slopes[PADDING..S::F32_LANES.max(PADDING)],
        );
        Some(self.of_step(simd, &slopes))
    }

    /// What grows by so much a pixel, from one number of the plane to the next.
    #[inline(always)]
    fn of_step<S: Simd>(&self, simd: S, slopes: &[f32; MOST_LANES]) -> S::f32s {
        simd.mul_f32s(vector(simd, slopes, 0), simd.splat_f32s(self.step))
    }
}

/// The medians of one row, several pixels side by side in a vector.
struct Row<'a> {
    /// The padded plane from the first row of the windows on.
    rows: &'a [f32],
    stride: usize,
    /// What is unknown in each [`MOST_LANES`] values of a row, from the same row on.
    unknown: &'a [Unknown],
    /// How many of them there are to a row.
    blocks: usize,
    radius: MedianRadius,
    /// Whether values stay where nothing is known.
    keep: bool,
    trend: Option<RowTrend<'a>>,
    out: &'a mut [f32],
}

/// Side of the larger windows.
const SIDE: usize = 5;

/// Columns whose values are sorted once for all windows that they are part of.
const STRIP: usize = 256;

/// The values of a strip's columns and of those beside it, in ascending order from row to row.
#[derive(Clone)]
#[repr(align(64))]
struct Columns([[f32; STRIP + MOST_LANES]; SIDE]);

/// What is unknown in the columns of a block.
#[derive(Clone, Copy)]
struct ColumnsUnknown {
    /// In which of them anything is.
    any: Unknown,
    /// In which of them everything is.
    all: Unknown,
    /// Before which of them, in this strip, an odd number of values is, a bit each.
    odd: u16,
}

impl ColumnsUnknown {
    /// Those of no row.
    const NONE: Self = Self {
        any: Unknown::NONE,
        all: Unknown::ALL,
        odd: 0,
    };
}

impl Row<'_> {
    /// What is unknown in the columns of each block from `first` on.
    #[inline(always)]
    fn note_columns(&self, first: usize, columns: &mut [ColumnsUnknown; STRIP / MOST_LANES + 1]) {
        *columns = [ColumnsUnknown::NONE; STRIP / MOST_LANES + 1];
        for y in 0..SIDE {
            let row = &self.unknown[y * self.blocks + first..(y + 1) * self.blocks];
            for (column, unknown) in columns.iter_mut().zip(row) {
                column.any.0 |= unknown.0;
                column.all.0 &= unknown.0;
                column.odd ^= unknown.0;
            }
        }
        // The number of unknown values in all columns before is the parity of those in each.
        let mut before = 0u16;
        for column in columns {
            let mut up_to = column.odd;
            for step in [1, 2, 4, 8] {
                up_to ^= up_to << step;
            }
            column.odd = (up_to << 1) ^ before;
            before ^= if up_to >> (MOST_LANES - 1) == 1 {
                u16::MAX
            } else {
                0
            };
        }
    }

    /// The values of the windows of a vector's pixels.
    #[inline(always)]
    fn window<S: Simd, const SIDE: usize, const N: usize>(
        &self,
        simd: S,
        corner: usize,
    ) -> [S::f32s; N] {
        let mut window = [simd.splat_f32s(0.0); N];
        for y in 0..SIDE {
            let row = &self.rows[corner + y * self.stride..][..S::F32_LANES + SIDE - 1];
            for x in 0..SIDE {
                window[SIDE * y + x] = vector(simd, row, x);
            }
        }
        window
    }

    /// Sorts the values of as many columns as a vector has lanes. Unknown ones become plus and minus infinity
    /// in turn, from the top of a column to its end and on at the top of the next, so that of any five
    /// columns' the median is that of the known ones. What grows from row to row is brought to the middle one.
    #[inline(always)]
    fn sort_columns<S: Simd>(
        &self,
        simd: S,
        corner: usize,
        (unknown, lane): (ColumnsUnknown, usize),
        along_y: Option<S::f32s>,
        columns: &mut Columns,
        at: usize,
    ) {
        let mut values = [simd.splat_f32s(0.0); SIDE];
        for y in 0..SIDE {
            values[y] = vector(simd, &self.rows[corner + y * self.stride..], 0);
        }
        if unknown.any != Unknown::NONE {
            let starts = lanes_of(simd, unknown.odd, lane);
            values = balanced(
                simd,
                values,
                simd.mul_f32s(starts, simd.splat_f32s(f32::INFINITY)),
            );
        }
        if let Some(along_y) = along_y {
            for y in 0..SIDE {
                let rows = simd.splat_f32s((SIDE / 2) as f32 - y as f32);
                values[y] = simd.mul_add_f32s(rows, along_y, values[y]);
            }
        }
        let values = sorted_5(simd, values);
        for y in 0..SIDE {
            store(simd, &mut columns.0[y], at, values[y]);
        }
    }

    /// The medians of a vector's windows from `at` on among columns that are sorted, and the next larger values;
    /// those beside the middle one are brought to it first. What is added to a whole column leaves it sorted.
    #[inline(always)]
    fn middle_of_columns<S: Simd>(
        simd: S,
        columns: &Columns,
        at: usize,
        along_x: Option<S::f32s>,
    ) -> [S::f32s; 2] {
        let mut window = [simd.splat_f32s(0.0); SIDE * SIDE];
        for y in 0..SIDE {
            for x in 0..SIDE {
                window[SIDE * y + x] = vector(simd, &columns.0[y], at + x);
            }
        }
        if let Some(along_x) = along_x {
            for x in 0..SIDE {
                let columns = simd.splat_f32s((SIDE / 2) as f32 - x as f32);
                for y in 0..SIDE {
                    let value = window[SIDE * y + x];
                    window[SIDE * y + x] = simd.mul_add_f32s(columns, along_x, value);
                }
            }
        }
        middle_of_5_columns(simd, window)
    }

    /// Writes medians, of which `out` holds a vector's or, at the end of a row, fewer.
    #[inline(always)]
    fn write<S: Simd>(keep: bool, simd: S, out: &mut [f32], medians: S::f32s) {
        let whole = out.len() == S::F32_LANES;
        let medians = if keep {
            let kept = if whole {
                vector(simd, out, 0)
            } else {
                simd.partial_load_f32s(out)
            };
            simd.select_f32s(simd.equal_f32s(medians, medians), medians, kept)
        } else {
            medians
        };
        if whole {
            store(simd, out, 0, medians);
        } else {
            simd.partial_store_f32s(out, medians);
        }
    }
}

impl WithSimd for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let out = std::mem::take(&mut self.out);
        let keep = self.keep;
        if self.radius == MedianRadius::One {
            for (block, out) in out.chunks_mut(S::F32_LANES).enumerate() {
                let at = block * S::F32_LANES;
                let mut window = self.window::<S, 3, 9>(simd, at);
                let along = |along| self.trend.and_then(|trend| trend.at(simd, along, at));
                if let (Some(along_x), Some(along_y)) = (along(0), along(1)) {
                    window = levelled::<S, 3, 9>(simd, window, [along_x, along_y]);
                }
                let window = balanced(simd, window, simd.splat_f32s(f32::INFINITY));
                let medians = known(simd, median_of_9(simd, window));
                Self::write(keep, simd, out, medians);
            }
            return;
        }
        let mut columns = Columns([[0.0; STRIP + MOST_LANES]; SIDE]);
        let mut levelled = columns.clone();
        let mut unknown = [ColumnsUnknown::NONE; STRIP / MOST_LANES + 1];
        for (strip, out) in out.chunks_mut(STRIP).enumerate() {
            let start = strip * STRIP;
            let shared = out.len().next_multiple_of(MOST_LANES) + MOST_LANES;
            self.note_columns(start / MOST_LANES, &mut unknown);
            // Whether everything is known in the windows that begin in a block, and end in the next.
            let whole = |block: usize| {
                let next = (block + 1).min(unknown.len() - 1);
                unknown[block].any == Unknown::NONE && unknown[next].any == Unknown::NONE
            };
            for at in (0..shared).step_by(S::F32_LANES) {
                let block = at / MOST_LANES;
                let columns_of = (unknown[block], at % MOST_LANES);
                let windows = [whole(block.saturating_sub(1)), whole(block)];
                if windows.contains(&true) {
                    self.sort_columns(simd, start + at, columns_of, None, &mut columns, at);
                }
                if windows.contains(&false) {
                    let along_y = self
                        .trend
                        .and_then(|trend| trend.of_columns(simd, start + at));
                    self.sort_columns(simd, start + at, columns_of, along_y, &mut levelled, at);
                }
            }
            for (block, out) in out.chunks_mut(S::F32_LANES).enumerate() {
                let at = block * S::F32_LANES;
                let block = at / MOST_LANES;
                let medians = if whole(block) {
                    Self::middle_of_columns(simd, &columns, at, None)[0]
                } else if unknown[block].all == Unknown::ALL
                    && unknown[block + 1].all == Unknown::ALL
                {
                    simd.splat_f32s(f32::NAN)
                } else {
                    let along_x = self.trend.and_then(|trend| trend.at(simd, 0, start + at));
                    let [median, next] = Self::middle_of_columns(simd, &levelled, at, along_x);
                    let lower = lower_middles(unknown[block].odd, unknown[block + 1].odd);
                    let lower = lanes_of(simd, lower, at % MOST_LANES);
                    let lower = simd.less_than_f32s(lower, simd.splat_f32s(0.0));
                    known(simd, simd.select_f32s(lower, next, median))
                };
                Self::write(keep, simd, out, medians);
            }
        }
    }
}

/// The values of the windows, brought to their middles along the slopes along x and y.
#[inline(always)]
fn levelled<S: Simd, const SIDE: usize, const N: usize>(
    simd: S,
    mut window: [S::f32s; N],
    [along_x, along_y]: [S::f32s; 2],
) -> [S::f32s; N] {
    let middle = (SIDE / 2) as f32;
    for y in 0..SIDE {
        let rows = simd.splat_f32s(middle - y as f32);
        for x in 0..SIDE {
            let columns = simd.splat_f32s(middle - x as f32);
            let value = window[SIDE * y + x];
            let value = simd.mul_add_f32s(rows, along_y, value);
            window[SIDE * y + x] = simd.mul_add_f32s(columns, along_x, value);
        }
    }
    window
}

/// In which windows of a block infinities begin and end with the negative one, so that the middle one of all
/// values is the smaller of the two in the middle of the known ones. A window ends where the one five columns
/// further on begins: `here` and `next` say before which columns of this block and of the next an odd number is
/// unknown.
#[inline(always)]
const fn lower_middles(here: u16, next: u16) -> u16 {
    let beyond = (here >> SIDE) | (next << (MOST_LANES - SIDE));
    here & !beyond
}

/// -1 where a bit is set, from the one of `lane` on, and 1 elsewhere.
#[inline(always)]
fn lanes_of<S: Simd>(simd: S, bits: u16, lane: usize) -> S::f32s {
    let mut lanes = [0.0; MOST_LANES];
    for i in 0..MOST_LANES {
        let sign = u32::from(bits) >> i << 31;
        lanes[i] = f32::from_bits(sign | 1.0f32.to_bits());
    }
    vector(simd, &lanes, lane)
}

/// NaN where the median is an infinity: where nothing is known, the middle one of them is left.
#[inline(always)]
fn known<S: Simd>(simd: S, medians: S::f32s) -> S::f32s {
    let finite = simd.less_than_f32s(simd.abs_f32s(medians), simd.splat_f32s(f32::INFINITY));
    simd.select_f32s(finite, medians, simd.splat_f32s(f32::NAN))
}

/// Replaces the unknown values of each lane by plus and minus infinity in turn, from `first` on, so that the
/// median of all values is the median of the known ones.
#[inline(always)]
fn balanced<S: Simd, const N: usize>(
    simd: S,
    mut window: [S::f32s; N],
    first: S::f32s,
) -> [S::f32s; N] {
    let mut next = first;
    for values in &mut window {
        let known = simd.equal_f32s(*values, *values);
        *values = simd.select_f32s(known, *values, next);
        next = simd.select_f32s(known, next, simd.neg_f32s(next));
    }
    window
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The same, pixel by pixel, by sorting.
    fn by_sorting(plane: ArrayView2<'_, f32>, radius: usize) -> Array2<f32> {
        let (height, width) = plane.dim();
        Array2::from_shape_fn((height, width), |(y, x)| {
            let mut known: Vec<f32> = (y.saturating_sub(radius)..(y + radius + 1).min(height))
                .flat_map(|v| {
                    (x.saturating_sub(radius)..(x + radius + 1).min(width)).map(move |u| (v, u))
                })
                .map(|place| plane[place])
                .filter(|value| !value.is_nan())
                .collect();
            known.sort_by(f32::total_cmp);
            known.get(known.len() / 2).copied().unwrap_or(f32::NAN)
        })
    }

    fn same(a: &Array2<f32>, b: &Array2<f32>) -> bool {
        a.iter()
            .zip(b)
            .all(|(a, b)| a == b || (a.is_nan() && b.is_nan()))
    }

    /// Half of a steep plane is known, on one side of a ragged border: across it the medians go on along the
    /// plane. Without the slope they would lag by up to two rows.
    #[test]
    fn medians_go_on_along_a_slope() {
        let size = Size {
            width: 45,
            height: 30,
        };
        // Of the coarser grid; the finer has twice as many pixels a side, and twice the shifts.
        let (along_x, along_y) = (0.2f32, -0.5f32);
        let coarse =
            Array2::from_shape_fn((15, 23), |(y, x)| along_x * x as f32 + along_y * y as f32);
        let level = Array2::zeros((15, 23));
        let mut slopes = Slopes::default();
        slopes.measure((&coarse, &level), 1, (0, 1));
        let plane =
            Array2::from_shape_fn(size.dim(), |(y, x)| along_x * x as f32 + along_y * y as f32);
        let validity = Array2::from_shape_fn(size.dim(), |(y, x)| {
            let known = y + x % 3 < 15;
            if known {
                Validity::Valid
            } else {
                Validity::NoEnergy
            }
        });
        for radius in [MedianRadius::One, MedianRadius::Two] {
            let windows = |slopes| Windows {
                radius,
                step: 1,
                slopes,
            };
            let farthest = |slopes| {
                let mut smoothed = [plane.clone(), Array2::zeros(size.dim())];
                let [dx, dy] = &mut smoothed;
                Medians::default().smooth_valid([dx, dy], &validity, 1, windows(slopes));
                (&smoothed[0] - &plane)
                    .iter()
                    .fold(0.0f32, |most, miss| most.max(miss.abs()))
            };
            assert!(
                farthest(&slopes) < 1e-5,
                "{radius:?}: {}",
                farthest(&slopes)
            );
            assert!(farthest(&Slopes::default()) > 0.4);
        }
    }

    proptest! {
        #[test]
        fn the_network_equals_sorting(
            width in prop_oneof![1usize..40, 250usize..280], height in 1usize..12, unknown in 0.0f64..1.0, seed: u64,
        ) {
            let mut state = seed | 1;
            let mut random = move || {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 11) as f64 / (1u64 << 53) as f64
            };
            let plane = Array2::from_shape_simple_fn((height, width), || {
                if random() < unknown { f32::NAN } else { (random() * 9.0).floor() as f32 - 4.0 }
            });
            for (radius, pixels) in [(MedianRadius::One, 1), (MedianRadius::Two, 2)] {
                let fast = median_of_known(plane.view(), radius);
                prop_assert!(same(&fast, &by_sorting(plane.view(), pixels)));
            }
        }
    }
}
