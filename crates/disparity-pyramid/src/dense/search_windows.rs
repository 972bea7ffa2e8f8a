use std::ops::Range;

use ndarray::{ArrayView2, s};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;
use v1_gabor::Size;

use crate::SearchRange;
use crate::dense::lesser::{greater, lesser};
use crate::dense::pixel_cost::LANES;

/// Width and height in pixels of the tiles that share a window: a path crosses from one window to
/// the next seldom, and few pixels search what only their neighbours need.
pub(crate) const TILE: Size = Size {
    width: 16,
    height: 8,
};

/// How many pixels a pixel of a coarse look is wide and high.
const COARSE: usize = 4;

/// How far about a tile a coarse look is asked, in its own pixels: what lies there may reach into the
/// tile.
const AROUND: usize = 8;

/// A run of the shifts of a search, by their places in it: a whole number of vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Window {
    /// The place of its first shift.
    pub(crate) first: usize,
    /// How many places it has, a multiple of [`LANES`]; the last may be no shifts.
    pub(crate) places: usize,
}

/// Which shifts are searched at each pixel of an image: one window a tile.
#[derive(Clone, Debug, Default)]
pub(crate) struct SearchWindows {
    width: usize,
    /// Tiles to a row.
    columns: usize,
    windows: Vec<Window>,
    /// How many places the pixels of a row have up to each tile, and altogether.
    starts: Vec<usize>,
    most_places: usize,
    /// The least and the largest shift that a coarse look has found, tile by tile and, of a row of
    /// tiles together, column by column.
    spans: Vec<(f32, f32)>,
    least: Vec<f32>,
    most: Vec<f32>,
}

impl SearchWindows {
    /// All shifts at every pixel.
    pub(crate) fn take_all(&mut self, size: Size, search: SearchRange) {
        let window = Window {
            first: 0,
            places: search.shifts().next_multiple_of(LANES),
        };
        self.windows.clear();
        self.windows.resize(tiles(size).area(), window);
        self.count(size);
    }

    /// Around what a look at a quarter of the size has found in a tile and close about it: from the
    /// least shift there to the largest, and at least `margin_px` further on either side.
    ///
    /// `coarse_dx` holds the shifts of every fourth pixel of every fourth row, in its own pixels.
    pub(crate) fn take_around(
        &mut self,
        coarse_dx: ArrayView2<'_, f32>,
        size: Size,
        search: SearchRange,
        margin_px: u16,
    ) {
        self.take_spans(coarse_dx, tiles(size));
        let margin_px = f32::from(margin_px);
        let (least_dx, shifts) = (search.least_dx() as f32, search.shifts());
        let all = shifts.next_multiple_of(LANES);
        let window = |(least, most): &(f32, f32)| {
            let place = |dx: f32| (dx - least_dx).clamp(0.0, (shifts - 1) as f32);
            let low = place((COARSE as f32 * least).floor() - margin_px) as usize;
            let high = place((COARSE as f32 * most).ceil() + margin_px) as usize;
            let span = high - low + 1;
            let places = span.next_multiple_of(LANES).min(all);
            // What is left over of the last vector lies on both sides.
            let first = low.saturating_sub((places - span) / 2);
            Window {
                first: first.min(shifts.saturating_sub(places)),
                places,
            }
        };
        self.windows.clear();
        self.windows.extend(self.spans.iter().map(window));
        self.count(size);
    }

    /// Counts the places of windows that are there.
    fn count(&mut self, size: Size) {
        self.width = size.width;
        self.columns = tiles(size).width;
        self.starts.clear();
        for windows in self.windows.chunks(self.columns) {
            let mut start = 0;
            for (tile, window) in windows.iter().enumerate() {
                self.starts.push(start);
                start += window.places * columns_of(tile, size.width).len();
            }
            self.starts.push(start);
        }
        let most_places = self.windows.iter().map(|window| window.places).max();
        self.most_places = most_places.unwrap_or(LANES);
    }

    /// The least and the largest shift of each tile and of [`AROUND`] pixels about it, in coarse
    /// pixels.
    fn take_spans(&mut self, coarse_dx: ArrayView2<'_, f32>, tiles: Size) {
        let (height, width) = coarse_dx.dim();
        let reach = |tile: usize, side: usize, end: usize| {
            let (first, last) = (tile * side / COARSE, (tile + 1) * side / COARSE + AROUND);
            first.saturating_sub(AROUND).min(end - 1)..last.min(end)
        };
        self.spans.resize(tiles.area(), (0.0, 0.0));
        for extremes in [&mut self.least, &mut self.most] {
            extremes.resize(tiles.height * width, 0.0);
        }
        self.spans
            .par_chunks_mut(tiles.width)
            .zip(self.least.par_chunks_mut(width))
            .zip(self.most.par_chunks_mut(width))
            .enumerate()
            .for_each(|(tile_y, ((spans, least), most))| {
                least.fill(f32::INFINITY);
                most.fill(f32::NEG_INFINITY);
                let rows = reach(tile_y, TILE.height, height);
                for row in coarse_dx.slice(s![rows, ..]).rows() {
                    let Some(row) = row.to_slice() else {
                        unreachable!("planes are made in row-major order")
                    };
                    Arch::new().dispatch(Widen {
                        least: &mut *least,
                        most: &mut *most,
                        row,
                    });
                }
                for (tile_x, span) in spans.iter_mut().enumerate() {
                    let columns = reach(tile_x, TILE.width, width);
                    let least = least[columns.clone()].iter().copied();
                    let most = most[columns].iter().copied();
                    *span = (
                        least.fold(f32::INFINITY, lesser),
                        most.fold(f32::NEG_INFINITY, greater),
                    );
                }
            });
    }

    /// Tiles to a row.
    pub(crate) const fn columns(&self) -> usize {
        self.columns
    }

    /// The most places that the pixels of a row have together.
    pub(crate) fn most_in_row(&self) -> usize {
        let rows = self.starts.chunks(self.columns + 1);
        let most = rows.map(|starts| starts[self.columns]);
        most.max().unwrap_or(0)
    }

    /// The most places of any window.
    pub(crate) const fn most_places(&self) -> usize {
        self.most_places
    }

    /// The tiles of a row's pixels.
    #[inline(always)]
    pub(crate) fn row(&self, y: usize) -> RowWindows<'_> {
        let row = y / TILE.height;
        RowWindows {
            width: self.width,
            windows: &self.windows[row * self.columns..][..self.columns],
            starts: &self.starts[row * (self.columns + 1)..][..=self.columns],
        }
    }
}

/// The windows of one row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowWindows<'a> {
    width: usize,
    windows: &'a [Window],
    starts: &'a [usize],
}

/// A few pixels of a row that share a window.
#[derive(Clone, Debug)]
pub(crate) struct Tile {
    pub(crate) columns: Range<usize>,
    pub(crate) window: Window,
    /// How many places the pixels before it have.
    pub(crate) start: usize,
}

impl Window {
    /// How many places it has: `N` vectors, or as many as it says if that is 0.
    #[inline(always)]
    pub(crate) const fn places_of<const N: usize>(self) -> usize {
        if N == 0 { self.places } else { N * LANES }
    }
}

impl<'a> RowWindows<'a> {
    /// The tiles of the row, from the left.
    #[inline(always)]
    pub(crate) fn tiles(self) -> impl DoubleEndedIterator<Item = Tile> + use<'a> {
        (0..self.windows.len()).map(move |tile| self.tile(tile))
    }

    /// A tile of the row.
    #[inline(always)]
    pub(crate) fn tile(&self, tile: usize) -> Tile {
        Tile {
            columns: columns_of(tile, self.width),
            window: self.windows[tile],
            start: self.starts[tile],
        }
    }
}

/// The least and the largest shift of each column, and a row that may hold others.
struct Widen<'a> {
    least: &'a mut [f32],
    most: &'a mut [f32],
    row: &'a [f32],
}

impl NullaryFnOnce for Widen<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let width = self.row.len();
        let (least, most) = (&mut self.least[..width], &mut self.most[..width]);
        for x in 0..width {
            least[x] = lesser(self.row[x], least[x]);
            most[x] = greater(self.row[x], most[x]);
        }
    }
}

/// The columns of a tile.
#[inline(always)]
fn columns_of(tile: usize, width: usize) -> Range<usize> {
    let start = tile * TILE.width;
    start..(start + TILE.width).min(width)
}

/// How many tiles cover an image.
const fn tiles(size: Size) -> Size {
    Size {
        width: size.width.div_ceil(TILE.width),
        height: size.height.div_ceil(TILE.height),
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Every window holds what lies near it, in shifts of the search, and no more vectors than
        /// that takes.
        #[test]
        fn windows_hold_what_is_near(
            width in 1usize..80, height in 1usize..40, least in -90i32..10, more in 0i32..120,
            margin in 0u16..9, seed: u64,
        ) {
            let size = Size { width, height };
            let search = SearchRange::new(least, least + more).unwrap();
            let mut state = seed | 1;
            let coarse = Array2::from_shape_simple_fn(size.halved().halved().dim(), || {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (least as f32 + (state >> 20) as f32 % (more as f32 + 1.0)) / 4.0
            });
            let mut windows = SearchWindows::default();
            windows.take_around(coarse.view(), size, search, margin);
            let all = search.shifts().next_multiple_of(LANES);
            for y in 0..height {
                for x in 0..width {
                    let window = windows.row(y).tile(x / TILE.width).window;
                    prop_assert!(window.places.is_multiple_of(LANES) && window.places <= all);
                    prop_assert!(window.places <= windows.most_places());
                    prop_assert!(window.first == 0 || window.first + window.places <= search.shifts());
                    let dx = 4.0 * coarse[[y / 4, x / 4]];
                    let margin = i32::from(margin);
                    for near in [dx.floor() as i32 - margin, dx.ceil() as i32 + margin] {
                        let place = (near.clamp(least, least + more) - least) as usize;
                        prop_assert!((window.first..window.first + window.places).contains(&place));
                    }
                }
            }
        }
    }
}
