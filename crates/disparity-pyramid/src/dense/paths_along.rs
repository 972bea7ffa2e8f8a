use ndarray::ArrayViewMut2;

use crate::SearchRange;
use crate::dense::aggregate::{Ground, with_vectors};
use crate::dense::other_eye::OtherEye;
use crate::dense::path_step::{moved, path_step};
use crate::dense::paths_down::{Found, PathsDown};
use crate::dense::pixel_cost::PixelCost;
use crate::dense::search_windows::{SearchWindows, Tile, Window};
use crate::dense::wide::Wide;
use crate::dense::winner::{NO_SHIFT, WonRow};

/// What the paths of one row need.
#[derive(Clone, Debug, Default)]
pub(crate) struct RowSpace {
    /// The costs of a path along the row at its last pixel, and the least of them.
    run: Vec<u8>,
    least: u8,
    spare: Vec<u8>,
    /// The costs of the path from the left, `[[x, place]]`.
    onward: Vec<u8>,
    total: Vec<u8>,
    /// What a large step from each pixel to the one before costs.
    large: Vec<u8>,
    won: WonRow,
    other: OtherEye,
}

impl RowSpace {
    /// Makes room.
    pub(crate) fn fit(&mut self, windows: &SearchWindows, width: usize, search: SearchRange) {
        self.other.fit(width, search);
        self.won.fit(width);
        let places = windows.most_places();
        for run in [&mut self.run, &mut self.spare, &mut self.total] {
            run.resize(places, 0);
        }
        self.onward.resize(windows.most_in_row(), 0);
        self.large.resize(width + 1, 0);
    }

    /// Before the first pixel of a path, where nothing has been paid.
    #[inline(always)]
    fn begin(&mut self) {
        self.run.fill(0);
        self.least = 0;
    }

    /// On the way from a pixel of one window to one of another.
    #[inline(always)]
    fn enter(&mut self, from: Window, to: Window) {
        if from != to {
            moved(&self.run, from, to, &mut self.spare[..to.places]);
            std::mem::swap(&mut self.run, &mut self.spare);
        }
    }
}

/// The paths along a few rows that share their windows, and the rows' winners.
pub(crate) struct Along<'a, C> {
    pub(crate) ground: Ground<'a, C>,
    pub(crate) search: SearchRange,
    /// Costs and paths down of these rows.
    pub(crate) down: &'a PathsDown,
    /// The first of the rows.
    pub(crate) top: usize,
    pub(crate) spaces: &'a mut [RowSpace],
    pub(crate) dx: ArrayViewMut2<'a, f32>,
    pub(crate) margin: ArrayViewMut2<'a, u8>,
    pub(crate) other_dx: Option<ArrayViewMut2<'a, f32>>,
}

impl<C: PixelCost> Along<'_, C> {
    /// Walks from the left to the right, and back.
    #[inline(always)]
    pub(crate) fn walk<W: Wide>(mut self, wide: W) {
        let ground = self.ground;
        let windows = ground.windows.row(self.top);
        for (row, space) in self.spaces.iter_mut().enumerate() {
            let steps = ground.guide.beside(self.top + row);
            for (large, step) in space.large[1..].iter_mut().zip(steps) {
                *large = ground.penalty.large(*step);
            }
            space.begin();
        }
        let mut before = windows.tile(0).window;
        for tile in windows.tiles() {
            for space in &mut *self.spaces {
                space.enter(before, tile.window);
            }
            before = tile.window;
            let found = self.down.found(tile.start);
            with_vectors!(
                tile.window.places,
                walk_right(wide, ground, self.spaces, &tile, found)
            );
        }

        for space in &mut *self.spaces {
            space.begin();
            if self.other_dx.is_some() {
                space.other.begin();
            }
        }
        for tile in windows.tiles().rev() {
            for space in &mut *self.spaces {
                space.enter(before, tile.window);
            }
            before = tile.window;
            let found = self.down.found(tile.start);
            with_vectors!(tile.window.places, walk_left(wide, &mut self, &tile, found));
        }
        let spaces = self.spaces.iter_mut();
        for (row, space) in spaces.enumerate() {
            if let Some(dx) = self.dx.row_mut(row).as_slice_mut() {
                space.won.shifts(self.search.least_dx(), dx);
            }
            let Some(other_dx) = &mut self.other_dx else {
                continue;
            };
            if let Some(other_dx) = other_dx.row_mut(row).as_slice_mut() {
                space.other.tell(self.search, other_dx);
            }
        }
    }
}

/// The paths from the left through a tile, row by row.
#[inline(always)]
fn walk_right<W: Wide, C: PixelCost, const N: usize>(
    wide: W,
    ground: Ground<'_, C>,
    spaces: &mut [RowSpace],
    tile: &Tile,
    found: Found<'_>,
) {
    let places = tile.window.places_of::<N>();
    for (i, x) in tile.columns.clone().enumerate() {
        for (row, space) in spaces.iter_mut().enumerate() {
            let costs = &found.costs[row * found.stride + i * places..][..places];
            let onward = &mut space.onward[tile.start + i * places..][..places];
            let onward = onward.as_chunks_mut().0;
            let penalties = (ground.penalty.small, space.large[x]);
            let run = space.run.as_chunks_mut().0;
            let costs = costs.as_chunks().0;
            space.least = path_step(wide, run, space.least, penalties, costs, |i, cost| {
                wide.store(cost, &mut onward[i]);
            });
        }
    }
}

/// The paths from the right through a tile, and its winners.
#[inline(always)]
fn walk_left<W: Wide, C: PixelCost, const N: usize>(
    wide: W,
    rows: &mut Along<'_, C>,
    tile: &Tile,
    found: Found<'_>,
) {
    let places = tile.window.places_of::<N>();
    let first = tile.window.first;
    for (i, x) in tile.columns.clone().enumerate().rev() {
        for (row, space) in rows.spaces.iter_mut().enumerate() {
            let here = row * found.stride + i * places;
            let costs = found.costs[here..][..places].as_chunks().0;
            let down = found.down[here..][..places].as_chunks().0;
            let onward = &space.onward[tile.start + i * places..][..places];
            let onward = onward.as_chunks().0;
            let penalties = (rows.ground.penalty.small, space.large[x + 1]);
            let run = space.run.as_chunks_mut().0;
            let total = space.total[..places].as_chunks_mut().0;
            let mut lowest = wide.splat(NO_SHIFT);
            space.least = path_step(wide, run, space.least, penalties, costs, |i, cost| {
                let others = wide.add(wide.load(&down[i]), wide.load(&onward[i]));
                let sum = wide.add(others, cost);
                lowest = wide.min(lowest, sum);
                wide.store(sum, &mut total[i]);
            });
            let least = wide.least(lowest);
            if rows.other_dx.is_some() {
                space.other.hear(wide, x, first, (total, least));
            }
            let sums = &space.total[..places];
            rows.margin[[row, x]] = space.won.note(wide, x, (first, sums), least);
        }
    }
}
