use std::ops::Range;

use ndarray::{Array2, ArrayViewMut2, Axis, s};
use rayon::prelude::*;

use crate::SearchRange;
use crate::dense::guide::Guide;
use crate::dense::padding::Padding;
use crate::dense::path_step::{moved, path_step};
use crate::dense::pixel_cost::{LANES, PixelCost, RowCost};
use crate::dense::search_windows::{RowWindows, SearchWindows, TILE, Tile, Window};
use crate::dense::step_penalty::StepPenalty;
use crate::dense::wide::{Wide, WideWork, widest};
use crate::dense::winner::{NO_SHIFT, winner};

/// Rows whose paths one thread walks side by side: a path along a row waits for its last pixel, and
/// another row's has nothing to do with it.
const ROWS_A_JOB: usize = 4;

/// What aggregation is made over.
#[derive(Debug)]
pub(crate) struct Ground<'a, C> {
    pub(crate) cost: &'a C,
    pub(crate) guide: &'a Guide,
    pub(crate) penalty: &'a StepPenalty,
    /// Shifts of the whole search.
    pub(crate) shifts: usize,
    /// Which of them are tried at each pixel.
    pub(crate) windows: &'a SearchWindows,
}

impl<C> Clone for Ground<'_, C> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<C> Copy for Ground<'_, C> {}

/// Where the shift of every pixel whose paths cost least is written. All planes have the size of the
/// guide.
#[derive(Debug)]
pub(crate) struct Winners<'a> {
    /// Shifts in pixels, between whole ones by the parabola.
    pub(crate) dx: &'a mut Array2<f32>,
    /// How much more the best other shift costs, in the integers of a cost; 0 where nothing tells
    /// two shifts apart.
    pub(crate) margin: &'a mut Array2<u8>,
    /// The shift (still `dx`, right minus left) of every pixel of the other eye by the same sums,
    /// in whole pixels; NaN where no shift leads there.
    pub(crate) other_dx: Option<&'a mut Array2<f32>>,
}

/// What paths need, kept from pair to pair.
#[derive(Clone, Debug, Default)]
pub(crate) struct PathRoom {
    strips: Vec<Strip>,
    rows: Vec<RowSpace>,
}

/// Semi-global aggregation: three paths, from the left, the right and above, run through every
/// pixel; each adds to the pixel's cost of a shift what it paid to arrive there with it.
///
/// A path from below would need every column to its end before the first row is known: twice the
/// work of one from above, for a hundredth of the errors. So the image is walked once, in bands of a
/// few rows: first the paths down, thread by thread in strips of columns, then those along the rows.
/// No sum depends on how many threads share the work. With [`Winners::other_dx`] the sums also say
/// what the other eye sees.
///
/// All sums are bytes. A sum of three paths above 255 stays there; the winner's is far below, since
/// no path pays more than the winner's cost and a large step for being elsewhere.
pub(crate) fn aggregate<C: PixelCost>(
    ground: Ground<'_, C>,
    search: SearchRange,
    room: &mut PathRoom,
    winners: Winners<'_>,
) {
    let (width, height) = (ground.guide.width(), ground.guide.height());
    let threads = rayon::current_num_threads();
    let band = (ROWS_A_JOB * threads).min(height.next_multiple_of(ROWS_A_JOB));
    let tiles = ground.windows.columns();
    let of_strip = tiles.div_ceil(threads);
    let PathRoom {
        strips,
        rows: spaces,
    } = room;
    strips.resize_with(tiles.div_ceil(of_strip), Strip::default);
    for (strip, first) in strips.iter_mut().zip((0..tiles).step_by(of_strip)) {
        let tiles = first..(first + of_strip).min(tiles);
        strip.fit(ground.windows, tiles, band);
    }
    spaces.resize_with(band, RowSpace::default);
    for space in &mut *spaces {
        space.fit(ground.windows, width, search);
    }

    let Winners {
        dx,
        margin,
        mut other_dx,
    } = winners;
    for top in (0..height).step_by(band) {
        let rows = band.min(height - top);
        strips.par_iter_mut().for_each(|strip| {
            widest(Down {
                ground,
                strip,
                rows: top..top + rows,
            });
        });

        let rows = s![top..top + rows, ..];
        let mut dx = dx.slice_mut(rows);
        let mut margin = margin.slice_mut(rows);
        let mut others = other_dx.as_mut().map(|other| other.slice_mut(rows));
        let mut others = others
            .iter_mut()
            .flat_map(|other| other.axis_chunks_iter_mut(Axis(0), ROWS_A_JOB));
        let jobs = dx
            .axis_chunks_iter_mut(Axis(0), ROWS_A_JOB)
            .zip(margin.axis_chunks_iter_mut(Axis(0), ROWS_A_JOB))
            .zip(spaces.chunks_mut(ROWS_A_JOB))
            .enumerate()
            .map(|(job, ((dx, margin), spaces))| Rows {
                ground,
                search,
                strips,
                band_top: top,
                top: top + job * ROWS_A_JOB,
                spaces: &mut spaces[..dx.nrows()],
                dx,
                margin,
                other_dx: others.next(),
            });
        let jobs: Vec<_> = jobs.collect();
        jobs.into_par_iter().for_each(widest);
    }
}

/// Runs `$work::<N>` with as many vectors as a window has, or 0 where that is no common number: loops
/// over a number that the compiler knows leave nothing to count.
macro_rules! with_vectors {
    ($places:expr, $work:ident ( $($argument:expr),* )) => {
        match $places / LANES {
            1 => $work::<_, _, 1>($($argument),*),
            2 => $work::<_, _, 2>($($argument),*),
            3 => $work::<_, _, 3>($($argument),*),
            4 => $work::<_, _, 4>($($argument),*),
            _ => $work::<_, _, 0>($($argument),*),
        }
    };
}

/// Places of a window of `N` vectors, or of as many as it says if that is 0.
#[inline(always)]
const fn places<const N: usize>(window: Window) -> usize {
    if N == 0 { window.places } else { N * LANES }
}

/// A few columns of tiles: the paths down through them, and what they find in the rows of one band.
#[derive(Clone, Debug, Default)]
struct Strip {
    tiles: Range<usize>,
    /// The paths' costs after the row above, a run a column, and the least of each.
    runs: Vec<u8>,
    least: Vec<u8>,
    spare: Vec<u8>,
    /// Places to a row.
    stride: usize,
    /// What is found for each row of the band, `[[row, column, place]]`: costs, and costs of the
    /// path.
    costs: Vec<u8>,
    down: Vec<u8>,
}

impl Strip {
    /// Makes room for these tiles, and begins above the first row, where nothing has been paid.
    fn fit(&mut self, windows: &SearchWindows, tiles: Range<usize>, band: usize) {
        let stride = windows.most_in_row(&tiles);
        self.stride = stride;
        for (places, count) in [
            (&mut self.runs, stride),
            (&mut self.least, tiles.len() * TILE.width),
        ] {
            places.clear();
            places.resize(count, 0);
        }
        self.spare.resize(stride, 0);
        self.costs.resize(band * stride, 0);
        self.down.resize(band * stride, 0);
        self.tiles = tiles;
    }

    /// On the way from a row of some windows to one of others.
    fn enter(&mut self, from: RowWindows<'_>, to: RowWindows<'_>) {
        std::mem::swap(&mut self.runs, &mut self.spare);
        let first = self.tiles.start;
        let (from_start, to_start) = (from.tile(first).start, to.tile(first).start);
        for tile in self.tiles.clone() {
            let (from, to) = (from.tile(tile), to.tile(tile));
            let runs = self.spare[from.start - from_start..].chunks(from.window.places);
            let moved_runs = self.runs[to.start - to_start..].chunks_mut(to.window.places);
            for (run, moved_run) in runs.zip(moved_runs).take(to.columns.len()) {
                moved(run, from.window, to.window, moved_run);
            }
        }
    }

    /// Where the places of a tile lie in a row of the band.
    #[inline(always)]
    fn places(&self, row: usize, windows: RowWindows<'_>, tile: &Tile) -> Range<usize> {
        let start = tile.start - windows.tile(self.tiles.start).start + row * self.stride;
        start..start + tile.columns.len() * tile.window.places
    }
}

/// The walk down a strip through the rows of a band.
struct Down<'a, C> {
    ground: Ground<'a, C>,
    strip: &'a mut Strip,
    rows: Range<usize>,
}

impl<C: PixelCost> WideWork for Down<'_, C> {
    #[inline(always)]
    fn work<W: Wide>(self, wide: W) {
        let Self {
            ground,
            strip,
            rows,
        } = self;
        let mut top = rows.start;
        while top < rows.end {
            // Rows that share their windows.
            let end = (top + 1).next_multiple_of(TILE.height).min(rows.end);
            let windows = ground.windows.row(top);
            if top > 0 && top.is_multiple_of(TILE.height) {
                strip.enter(ground.windows.row(top - 1), windows);
            }
            for tile in strip.tiles.clone() {
                let tile = windows.tile(tile);
                for y in top..end {
                    let found = strip.places(y - rows.start, windows, &tile);
                    with_vectors!(
                        tile.window.places,
                        walk_down(wide, ground, strip, y, windows, &tile, found)
                    );
                }
            }
            top = end;
        }
    }
}

/// One step down of the paths through a row of a tile; their costs are `found` at those places.
#[inline(always)]
fn walk_down<W: Wide, C: PixelCost, const N: usize>(
    wide: W,
    ground: Ground<'_, C>,
    strip: &mut Strip,
    y: usize,
    windows: RowWindows<'_>,
    tile: &Tile,
    found: Range<usize>,
) {
    let places = places::<N>(tile.window);
    let cost = ground.cost.row(y);
    let above = y.checked_sub(1).map(|y| ground.guide.below(y));
    let first = windows.tile(strip.tiles.start);
    let pixels = strip.costs[found.clone()]
        .chunks_exact_mut(places)
        .zip(strip.down[found].chunks_exact_mut(places))
        .zip(strip.runs[tile.start - first.start..].chunks_exact_mut(places))
        .zip(&mut strip.least[tile.columns.start - first.columns.start..]);
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

/// What the paths of one row need.
#[derive(Clone, Debug, Default)]
struct RowSpace {
    /// The costs of a path along the row at its last pixel, and the least of them.
    run: Vec<u8>,
    least: u8,
    spare: Vec<u8>,
    /// The costs of the path from the left, `[[x, place]]`.
    onward: Vec<u8>,
    total: Vec<u8>,
    /// What a large step from each pixel to the one before costs.
    large: Vec<u8>,
    /// The least sum that leads to each pixel of the other eye, and its shift's place in the block:
    /// places are counted within blocks of as many as a byte tells apart.
    other: Vec<OtherEye>,
    /// The least sum of all blocks.
    told: Vec<u8>,
    /// How the rows of the other eye are padded.
    padding: Padding,
}

/// What a block of shifts tells the other eye, pixel by pixel of a padded row.
#[derive(Clone, Debug, Default)]
struct OtherEye {
    least: Vec<u8>,
    place: Vec<u8>,
}

/// Places that are counted together: a vector that begins at any of them ends at one that a byte
/// still tells apart.
const BLOCK: usize = 256 - LANES;

impl RowSpace {
    fn fit(&mut self, windows: &SearchWindows, width: usize, search: SearchRange) {
        self.padding = Padding::of(search);
        let stride = self.padding.stride(width);
        let blocks = search.shifts().div_ceil(BLOCK);
        self.other.resize_with(blocks, OtherEye::default);
        for other in &mut self.other {
            other.least.resize(stride, 0);
            other.place.resize(stride, 0);
        }
        let places = windows.most_places();
        for run in [&mut self.run, &mut self.spare, &mut self.total] {
            run.resize(places, 0);
        }
        let of_row = windows.most_in_row(&(0..windows.columns()));
        self.onward.resize(of_row, 0);
        self.large.resize(width + 1, 0);
        self.told.resize(width, 0);
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

/// The horizontal paths of a few rows that share their windows, and their winners.
struct Rows<'a, C> {
    ground: Ground<'a, C>,
    search: SearchRange,
    /// Costs and paths down of the band.
    strips: &'a [Strip],
    /// The first row of the band, and of these.
    band_top: usize,
    top: usize,
    spaces: &'a mut [RowSpace],
    dx: ArrayViewMut2<'a, f32>,
    margin: ArrayViewMut2<'a, u8>,
    other_dx: Option<ArrayViewMut2<'a, f32>>,
}

impl<C: PixelCost> WideWork for Rows<'_, C> {
    #[inline(always)]
    fn work<W: Wide>(mut self, wide: W) {
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
        for strip in self.strips {
            for tile in strip.tiles.clone() {
                let tile = windows.tile(tile);
                for space in &mut *self.spaces {
                    space.enter(before, tile.window);
                }
                before = tile.window;
                let first = strip.places(self.top - self.band_top, windows, &tile);
                let costs = &strip.costs[first.start..];
                with_vectors!(
                    tile.window.places,
                    walk_right(wide, ground, self.spaces, &tile, (costs, strip.stride))
                );
            }
        }

        for space in &mut *self.spaces {
            space.begin();
            if self.other_dx.is_some() {
                for other in &mut space.other {
                    other.least.fill(NO_SHIFT);
                }
            }
        }
        for strip in self.strips.iter().rev() {
            for tile in strip.tiles.clone().rev() {
                let tile = windows.tile(tile);
                for space in &mut *self.spaces {
                    space.enter(before, tile.window);
                }
                before = tile.window;
                let first = strip.places(self.top - self.band_top, windows, &tile);
                let found = (&strip.costs[first.start..], &strip.down[first.start..]);
                with_vectors!(
                    tile.window.places,
                    walk_left(wide, &mut self, &tile, found, strip.stride)
                );
            }
        }
        let Some(other_dx) = &mut self.other_dx else {
            return;
        };
        for (mut other_dx, space) in other_dx.rows_mut().into_iter().zip(self.spaces) {
            if let Some(other_dx) = other_dx.as_slice_mut() {
                space.tell(self.search, other_dx);
            }
        }
    }
}

/// The paths from the left through a tile, row by row; `costs` begin at its first place of the first
/// row, and again after each stride.
#[inline(always)]
fn walk_right<W: Wide, C: PixelCost, const N: usize>(
    wide: W,
    ground: Ground<'_, C>,
    spaces: &mut [RowSpace],
    tile: &Tile,
    (costs, stride): (&[u8], usize),
) {
    let places = places::<N>(tile.window);
    for (i, x) in tile.columns.clone().enumerate() {
        for (row, space) in spaces.iter_mut().enumerate() {
            let costs = costs[row * stride + i * places..][..places].as_chunks().0;
            let onward = &mut space.onward[tile.start + i * places..][..places];
            let onward = onward.as_chunks_mut().0;
            let penalties = (ground.penalty.small, space.large[x]);
            let run = space.run.as_chunks_mut().0;
            space.least = path_step(wide, run, space.least, penalties, costs, |i, cost| {
                wide.store(cost, &mut onward[i]);
            });
        }
    }
}

/// The paths from the right through a tile, and its winners. Costs and paths down begin at its first
/// place of the first row, and again after each stride.
#[inline(always)]
fn walk_left<W: Wide, C: PixelCost, const N: usize>(
    wide: W,
    rows: &mut Rows<'_, C>,
    tile: &Tile,
    (costs, down): (&[u8], &[u8]),
    stride: usize,
) {
    let places = places::<N>(tile.window);
    let least_dx = rows.search.least_dx() + tile.window.first as i32;
    for (i, x) in tile.columns.clone().enumerate().rev() {
        for (row, space) in rows.spaces.iter_mut().enumerate() {
            let found = row * stride + i * places;
            let costs = costs[found..][..places].as_chunks().0;
            let down = down[found..][..places].as_chunks().0;
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
            if rows.other_dx.is_some() {
                space.tell_the_other(wide, x, tile.window.first, places);
            }
            let found = winner(wide, &space.total[..places], wide.least(lowest));
            rows.dx[[row, x]] = (least_dx + found.place as i32) as f32 + found.beyond;
            rows.margin[[row, x]] = found.margin;
        }
    }
}

impl RowSpace {
    /// Offers the sums of pixel `x` to the pixels of the other eye that its shifts lead to, and to
    /// the padding where they lead out of view.
    #[inline(always)]
    fn tell_the_other<W: Wide>(&mut self, wide: W, x: usize, first: usize, places: usize) {
        let seen_first = self.padding.first(x) + first;
        let offers = self.total[..places].as_chunks::<LANES>().0;
        for (i, offer) in offers.iter().enumerate() {
            let place = first + i * LANES;
            // Beyond the last shift nothing is offered.
            let Some(other) = self.other.get_mut(place / BLOCK) else {
                return;
            };
            let seen = seen_first + i * LANES..seen_first + (i + 1) * LANES;
            let ([least], [best]) = (
                other.least[seen.clone()].as_chunks_mut::<LANES>().0,
                other.place[seen].as_chunks_mut::<LANES>().0,
            ) else {
                return;
            };
            let places = wide.add(wide.load(&FIRST_PLACES), wide.splat((place % BLOCK) as u8));
            let (offer, held) = (wide.load(offer), wide.load(least));
            let chosen = wide.if_less(offer, held, places, wide.load(best));
            wide.store(chosen, best);
            wide.store(wide.min(offer, held), least);
        }
    }

    /// The shift that leads to each pixel of the other eye with the least sum, NaN where none does.
    #[inline(always)]
    fn tell(&mut self, search: SearchRange, other_dx: &mut [f32]) {
        let width = other_dx.len();
        let start = self.padding.place(0);
        let held = &mut self.told[..width];
        held.fill(NO_SHIFT);
        other_dx.fill(f32::NAN);
        for (block, other) in self.other.iter().enumerate() {
            let first = (search.least_dx() + (block * BLOCK) as i32) as f32;
            let (sums, places) = (
                &other.least[start..][..width],
                &other.place[start..][..width],
            );
            for x in 0..width {
                let less = sums[x] < held[x];
                let dx = first + f32::from(places[x]);
                other_dx[x] = if less { dx } else { other_dx[x] };
                held[x] = if less { sums[x] } else { held[x] };
            }
        }
    }
}

/// The first places of a run.
pub(crate) const FIRST_PLACES: [u8; LANES] = [
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25,
    26, 27, 28, 29, 30, 31,
];

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use v1_gabor::{LumaImage, Size};

    use super::*;
    use crate::dense::dense_params::DenseParams;
    use crate::dense::eye_view::EyeView;
    use crate::dense::guide::Guide;
    use crate::dense::step_penalty::StepPenalty;

    /// Costs that are simply there, `[[y, x, shift]]`.
    struct Given {
        width: usize,
        shifts: usize,
        costs: Vec<u8>,
    }

    impl PixelCost for Given {
        type Row<'a> = (&'a Self, usize);

        fn row(&self, y: usize) -> (&Self, usize) {
            (self, y)
        }

        fn change_eyes(&mut self) {
            unreachable!("aggregation looks with one eye")
        }
    }

    impl RowCost for (&Given, usize) {
        fn costs<W: Wide>(self, _: W, x: usize, first: usize, costs: &mut [u8]) {
            let (given, y) = self;
            let start = (y * given.width + x) * given.shifts + first;
            let shifts = costs.len().min(given.shifts - first);
            costs[..shifts].copy_from_slice(&given.costs[start..start + shifts]);
        }
    }

    /// The summed path costs of every pixel and shift, one path after the other, in whole volumes.
    fn plainly(given: &Given, guide: &Guide, penalty: &StepPenalty) -> Vec<i32> {
        let (width, height, shifts) = (given.width, guide.height(), given.shifts);
        let mut sums = vec![0; width * height * shifts];
        for (step_x, step_y) in [(1, 0), (-1, 0), (0, 1)] {
            let mut path = vec![0; sums.len()];
            let columns: Vec<usize> = if step_x < 0 {
                (0..width).rev().collect()
            } else {
                (0..width).collect()
            };
            for y in 0..height {
                for &x in &columns {
                    let here = y * width + x;
                    let before = x
                        .checked_add_signed(-step_x)
                        .filter(|x| *x < width)
                        .zip(y.checked_add_signed(-step_y).filter(|y| *y < height))
                        .map(|(x, y)| y * width + x);
                    for d in 0..shifts {
                        let cost = i32::from(given.costs[here * shifts + d]);
                        let paid = before.map_or(0, |before| {
                            let run: &[i32] = &path[before * shifts..(before + 1) * shifts];
                            let least = *run.iter().min().unwrap();
                            let large = i32::from(penalty.large(guide.step(before, here)));
                            let candidates = (0..shifts).map(|other| match d.abs_diff(other) {
                                0 => run[other],
                                1 => run[other] + i32::from(penalty.small),
                                _ => run[other] + large,
                            });
                            // A step of one pixel may also be paid as a large one.
                            candidates.min().unwrap().min(least + large) - least
                        });
                        path[here * shifts + d] = cost + paid;
                    }
                }
            }
            for (sum, path) in sums.iter_mut().zip(path) {
                *sum += path;
            }
        }
        // What a byte holds.
        for sum in &mut sums {
            *sum = (*sum).min(255);
        }
        sums
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// Bands, strips and vectors give the winners of the plain sums, and tell the other eye the
        /// same.
        #[test]
        fn fast_and_plain_agree(
            width in 1usize..90, height in 1usize..40, shifts in 1usize..40, least in -30i32..3, seed: u64,
        ) {
            let mut state = seed | 1;
            let mut random = move |below: u64| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 20) % below
            };
            let costs = (0..width * height * shifts).map(|_| random(27) as u8).collect();
            let given = Given { width, shifts, costs };
            let luma = Array2::from_shape_simple_fn((height, width), || random(9) as f32 / 255.0);
            let luma = LumaImage::new(luma).unwrap();
            let mut guide = Guide::default();
            guide.take_in(&EyeView::grey(&luma), true, 1.0);
            let penalty = StepPenalty::new(&DenseParams::best());
            let search = SearchRange::new(least, least + shifts as i32 - 1).unwrap();
            let size = Size { width, height };
            let mut windows = SearchWindows::default();
            windows.take_all(size, search);
            let ground =
                Ground { cost: &given, guide: &guide, penalty: &penalty, shifts, windows: &windows };
            let mut dx = Array2::zeros((height, width));
            let mut margin = Array2::zeros((height, width));
            let mut other = Array2::zeros((height, width));
            let winners =
                Winners { dx: &mut dx, margin: &mut margin, other_dx: Some(&mut other) };
            aggregate(ground, search, &mut PathRoom::default(), winners);
            let plain = plainly(&given, &guide, &penalty);
            for y in 0..height {
                for x in 0..width {
                    let sums = &plain[(y * width + x) * shifts..][..shifts];
                    prop_assert!(sums.iter().any(|sum| *sum < 255), "the winner's sum is a byte");
                    let best = (0..shifts).min_by_key(|d| sums[*d]).unwrap();
                    let found = dx[[y, x]] - least as f32;
                    prop_assert!((found - best as f32).abs() <= 0.5);
                    let second = (0..shifts).filter(|d| d.abs_diff(best) > 1).map(|d| sums[d]).min();
                    if let Some(second) = second {
                        prop_assert_eq!(i32::from(margin[[y, x]]), second - sums[best]);
                    }
                    // The pixel x of the other eye is seen from x - dx.
                    let told = (0..shifts).filter_map(|d| {
                        let from = usize::try_from(x as i32 - least - d as i32).ok()?;
                        let sums = plain.get((y * width + from) * shifts + d)?;
                        (from < width).then_some((*sums, d))
                    });
                    match told.map(|(sum, _)| sum).min() {
                        None | Some(255) => prop_assert!(other[[y, x]].is_nan()),
                        Some(least_sum) => {
                            let d = (other[[y, x]] - least as f32) as usize;
                            let from = (x as i32 - least - d as i32) as usize;
                            prop_assert_eq!(plain[(y * width + from) * shifts + d], least_sum);
                        }
                    }
                }
            }
        }
    }
}
