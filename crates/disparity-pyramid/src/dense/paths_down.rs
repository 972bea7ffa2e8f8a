use std::ops::Range;

use crate::dense::aggregate::{Ground, ROWS, with_vectors};
use crate::dense::path_step::{moved, path_step};
use crate::dense::pixel_cost::{PixelCost, RowCost};
use crate::dense::search_windows::{RowWindows, SearchWindows, TILE, Tile};
use crate::dense::wide::Wide;
use crate::dense::winner::NO_SHIFT;

/// The paths down through all columns, and what they find in the last rows they came through.
#[derive(Clone, Debug, Default)]
pub(crate) struct PathsDown {
    /// Their costs after the row above, a run a column, and the least of each.
    runs: Vec<u8>,
    least: Vec<u8>,
    spare: Vec<u8>,
    /// Places to a row.
    stride: usize,
    /// What is found for each of [`ROWS`] rows, `[[row, column, place]]`: costs, and costs of the
    /// path.
    costs: Vec<u8>,
    down: Vec<u8>,
}

/// What is found for a tile, from its first place of a row on; a row's begins a stride after the one
/// above it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Found<'a> {
    pub(crate) costs: &'a [u8],
    pub(crate) down: &'a [u8],
    pub(crate) stride: usize,
}

impl PathsDown {
    /// Makes room, and begins above a row, where nothing has been paid.
    pub(crate) fn begin(&mut self, windows: &SearchWindows) {
        let stride = windows.most_in_row();
        self.stride = stride;
        for (places, count) in [
            (&mut self.runs, stride),
            (&mut self.least, windows.columns() * TILE.width),
        ] {
            places.clear();
            places.resize(count, 0);
        }
        self.spare.resize(stride, 0);
        self.costs.resize(ROWS * stride, 0);
        self.down.resize(ROWS * stride, 0);
    }

    /// Walks down through at most [`ROWS`] rows of the same tiles; `first` if nothing lies above.
    #[inline(always)]
    pub(crate) fn walk<W: Wide, C: PixelCost>(
        &mut self,
        wide: W,
        ground: Ground<'_, C>,
        rows: Range<usize>,
        first: bool,
    ) {
        let windows = ground.windows.row(rows.start);
        if !first && rows.start.is_multiple_of(TILE.height) {
            self.enter(ground.windows.row(rows.start - 1), windows);
        }
        for tile in windows.tiles() {
            for y in rows.clone() {
                let above = (!first || y > rows.start).then(|| ground.guide.below(y - 1));
                let found = (y - rows.start) * self.stride + tile.start;
                with_vectors!(
                    tile.window.places,
                    step_down(wide, ground, self, (y, above), &tile, found)
                );
            }
        }
    }

    /// On the way from a row of some windows to one of others.
    fn enter(&mut self, from: RowWindows<'_>, to: RowWindows<'_>) {
        std::mem::swap(&mut self.runs, &mut self.spare);
        for (from, to) in from.tiles().zip(to.tiles()) {
            let runs = self.spare[from.start..].chunks(from.window.places);
            let moved_runs = self.runs[to.start..].chunks_mut(to.window.places);
            for (run, moved_run) in runs.zip(moved_runs).take(to.columns.len()) {
                moved(run, from.window, to.window, moved_run);
            }
        }
    }

    /// What is found for the tile that begins at this place of a row.
    #[inline(always)]
    pub(crate) fn found(&self, start: usize) -> Found<'_> {
        Found {
            costs: &self.costs[start..],
            down: &self.down[start..],
            stride: self.stride,
        }
    }
}

/// One step down through a row of a tile, from the guide's steps `above` it if there is a row above;
/// what it costs is `found` from that place on.
#[inline(always)]
fn step_down<W: Wide, C: PixelCost, const N: usize>(
    wide: W,
    ground: Ground<'_, C>,
    paths: &mut PathsDown,
    (y, above): (usize, Option<&[u8]>),
    tile: &Tile,
    found: usize,
) {
    let places = tile.window.places_of::<N>();
    let cost = ground.cost.row(y);
    let found = found..found + tile.columns.len() * places;
    let pixels = paths.costs[found.clone()]
        .chunks_exact_mut(places)
        .zip(paths.down[found].chunks_exact_mut(places))
        .zip(paths.runs[tile.start..].chunks_exact_mut(places))
        .zip(&mut paths.least[tile.columns.start..]);
    for (x, (((costs, down), run), least)) in tile.columns.clone().zip(pixels) {
        cost.costs(wide, x, tile.window.first, costs);
        // What is no shift costs the most there is.
        if tile.window.first + places > ground.shifts {
            costs[ground.shifts - tile.window.first..].fill(NO_SHIFT);
        }
        let large = above.map_or(0, |steps| ground.penalty.large(steps[x]));
        let penalties = (ground.penalty.small, large);
        let (costs, down) = (costs.as_chunks().0, down.as_chunks_mut().0);
        let run = run.as_chunks_mut().0;
        *least = path_step(wide, run, *least, penalties, costs, |i, cost| {
            wide.store(cost, &mut down[i]);
        });
    }
}
