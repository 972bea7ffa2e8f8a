use ndarray::ArrayView2;
use v1_gabor::Size;

use crate::SearchRange;
use crate::dense::pixel_cost::LANES;

/// Width and height in pixels of the tiles that share a window: a path crosses from one window to
/// the next seldom, and few pixels search what only their neighbours need.
const TILE: Size = Size {
    width: 16,
    height: 8,
};

/// A run of the shifts of a search, by their places in it: a whole number of vectors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Window {
    /// The place of its first shift.
    pub(crate) first: usize,
    /// How many places it has, a multiple of [`LANES`]; the last may be no shifts.
    pub(crate) places: usize,
}

/// Which shifts are searched at each pixel of an image: one window a tile.
#[derive(Clone, Debug)]
pub(crate) struct SearchWindows {
    columns: usize,
    windows: Vec<Window>,
    most_places: usize,
}

impl SearchWindows {
    /// All shifts at every pixel.
    pub(crate) fn all(size: Size, search: SearchRange) -> Self {
        let tiles = tiles(size);
        let window = Window {
            first: 0,
            places: search.shifts().next_multiple_of(LANES),
        };
        Self {
            columns: tiles.width,
            windows: vec![window; tiles.area()],
            most_places: window.places,
        }
    }

    /// Around what a look at half the size has found in a tile and the tiles beside it: from the
    /// least shift there to the largest, and at least `margin_px` further on either side.
    ///
    /// `coarse_dx` holds the shifts of every second pixel of every second row, in its own pixels.
    pub(crate) fn around(
        coarse_dx: ArrayView2<'_, f32>,
        size: Size,
        search: SearchRange,
        margin_px: u16,
    ) -> Self {
        let tiles = tiles(size);
        let own = spans(coarse_dx, tiles);
        let margin_px = f32::from(margin_px);
        let (least_dx, shifts) = (search.least_dx() as f32, search.shifts());
        let all = shifts.next_multiple_of(LANES);
        let window = |tile: usize| {
            let (x, y) = (tile % tiles.width, tile / tiles.width);
            let (mut least, mut most) = own[tile];
            for row in y.saturating_sub(1)..(y + 2).min(tiles.height) {
                for column in x.saturating_sub(1)..(x + 2).min(tiles.width) {
                    let (low, high) = own[row * tiles.width + column];
                    (least, most) = (least.min(low), most.max(high));
                }
            }
            let place = |dx: f32| (dx - least_dx).clamp(0.0, (shifts - 1) as f32);
            let low = place((2.0 * least).floor() - margin_px) as usize;
            let high = place((2.0 * most).ceil() + margin_px) as usize;
            let span = high - low + 1;
            let places = span.next_multiple_of(LANES).min(all);
            // What is left over of the last vector lies on both sides.
            let first = low.saturating_sub((places - span) / 2);
            Window {
                first: first.min(shifts.saturating_sub(places)),
                places,
            }
        };
        let windows: Vec<Window> = (0..tiles.area()).map(window).collect();
        let most_places = windows.iter().map(|window| window.places).max();
        Self {
            columns: tiles.width,
            most_places: most_places.unwrap_or(LANES),
            windows,
        }
    }

    /// The most places of any window.
    pub(crate) const fn most_places(&self) -> usize {
        self.most_places
    }

    /// The windows of a row's pixels.
    #[inline(always)]
    pub(crate) fn row(&self, y: usize) -> RowWindows<'_> {
        let start = y / TILE.height * self.columns;
        RowWindows(&self.windows[start..start + self.columns])
    }
}

/// The windows of one row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowWindows<'a>(&'a [Window]);

impl RowWindows<'_> {
    /// What is searched at pixel `x`.
    #[inline(always)]
    pub(crate) fn at(self, x: usize) -> Window {
        self.0[x / TILE.width]
    }
}

/// How many tiles cover an image.
const fn tiles(size: Size) -> Size {
    Size {
        width: size.width.div_ceil(TILE.width),
        height: size.height.div_ceil(TILE.height),
    }
}

/// The least and the largest shift of each tile, in coarse pixels.
fn spans(coarse_dx: ArrayView2<'_, f32>, tiles: Size) -> Vec<(f32, f32)> {
    let mut spans = vec![(f32::INFINITY, f32::NEG_INFINITY); tiles.area()];
    for (y, row) in coarse_dx.rows().into_iter().enumerate() {
        let start = 2 * y / TILE.height * tiles.width;
        let of_row = &mut spans[start..start + tiles.width];
        for (x, dx) in row.iter().enumerate() {
            let (least, most) = &mut of_row[2 * x / TILE.width];
            (*least, *most) = (least.min(*dx), most.max(*dx));
        }
    }
    spans
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
            let coarse = Array2::from_shape_simple_fn(size.halved().dim(), || {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (least as f32 + (state >> 20) as f32 % (more as f32 + 1.0)) / 2.0
            });
            let windows = SearchWindows::around(coarse.view(), size, search, margin);
            let all = search.shifts().next_multiple_of(LANES);
            for y in 0..height {
                for x in 0..width {
                    let window = windows.row(y).at(x);
                    prop_assert!(window.places.is_multiple_of(LANES) && window.places <= all);
                    prop_assert!(window.places <= windows.most_places());
                    prop_assert!(window.first == 0 || window.first + window.places <= search.shifts());
                    let dx = 2.0 * coarse[[y / 2, x / 2]];
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
