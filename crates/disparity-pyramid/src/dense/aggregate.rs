use ndarray::{Array2, ArrayViewMut1, ArrayViewMut2, Axis, s};
use rayon::prelude::*;

use crate::SearchRange;
use crate::dense::guide::Guide;
use crate::dense::padding::Padding;
use crate::dense::path_step::{moved, path_step};
use crate::dense::pixel_cost::{LANES, PixelCost, RowCost};
use crate::dense::search_windows::{RowWindows, SearchWindows, Window};
use crate::dense::step_penalty::StepPenalty;
use crate::dense::wide::{Wide, WideWork, widest};
use crate::dense::winner::{NO_SHIFT, winner};

/// Rows whose paths one thread walks side by side: a path along a row waits for its last pixel, and
/// another row's has nothing to do with it.
const ROWS_A_JOB: usize = 2;

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

/// The shift of every pixel whose paths cost least.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Winners {
    /// Shifts in pixels, between whole ones by the parabola.
    pub(crate) dx: Array2<f32>,
    /// How much more the best other shift costs, in the integers of a cost; 0 where nothing tells
    /// two shifts apart.
    pub(crate) margin: Array2<u8>,
    /// The shift (still `dx`, right minus left) of every pixel of the other eye by the same sums,
    /// in whole pixels; NaN where no shift leads there.
    pub(crate) other_dx: Option<Array2<f32>>,
}

/// Semi-global aggregation: three paths, from the left, the right and above, run through every
/// pixel; each adds to the pixel's cost of a shift what it paid to arrive there with it.
///
/// A path from below would need every column to its end before the first row is known: twice the
/// work of one from above, for a hundredth of the errors. So the image is walked once, in bands of a
/// few rows: first the paths down, thread by thread in strips of columns, then those along the rows.
/// No sum depends on how many threads share the work. With `other` the sums also say what the other
/// eye sees.
///
/// All sums are bytes. A sum of three paths above 255 stays there; the winner's is far below, since
/// no path pays more than the winner's cost and a large step for being elsewhere.
pub(crate) fn aggregate<C: PixelCost>(
    ground: Ground<'_, C>,
    search: SearchRange,
    other: bool,
) -> Winners {
    let (width, height) = (ground.guide.width(), ground.guide.height());
    let places = ground.windows.most_places();
    let threads = rayon::current_num_threads();
    let band = (ROWS_A_JOB * threads).min(height.next_multiple_of(ROWS_A_JOB));
    let columns = width.div_ceil(threads);

    let mut down = vec![0; width * places];
    let mut down_least = vec![0; width];
    let mut costs = vec![0; band * width * places];
    let mut sums = vec![0; band * width * places];
    let mut spaces = vec![RowSpace::new(width, search, places); band];

    let mut dx = Array2::zeros((height, width));
    let mut margin = Array2::zeros((height, width));
    let mut other_dx = other.then(|| Array2::zeros((height, width)));
    for top in (0..height).step_by(band) {
        let rows = band.min(height - top);
        let mut strips: Vec<Strip<'_, C>> = down
            .chunks_mut(columns * places)
            .zip(down_least.chunks_mut(columns))
            .enumerate()
            .map(|(i, (runs, least))| Strip {
                ground,
                start: i * columns,
                top,
                places,
                runs,
                least,
                costs: Vec::with_capacity(rows),
                sums: Vec::with_capacity(rows),
            })
            .collect();
        let of_rows = costs
            .chunks_mut(width * places)
            .zip(sums.chunks_mut(width * places));
        for (costs, sums) in of_rows.take(rows) {
            let parts = costs
                .chunks_mut(columns * places)
                .zip(sums.chunks_mut(columns * places));
            for (strip, (costs, sums)) in strips.iter_mut().zip(parts) {
                strip.costs.push(costs);
                strip.sums.push(sums);
            }
        }
        strips.into_par_iter().for_each(widest);

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
            .zip(costs.chunks(ROWS_A_JOB * width * places))
            .zip(sums.chunks_mut(ROWS_A_JOB * width * places))
            .enumerate()
            .map(|(job, ((((dx, margin), spaces), costs), sums))| Rows {
                ground,
                search,
                top: top + job * ROWS_A_JOB,
                spaces,
                costs,
                sums,
                dx,
                margin,
                other_dx: others.next(),
            });
        let jobs: Vec<_> = jobs.collect();
        jobs.into_par_iter().for_each(widest);
    }
    Winners {
        dx,
        margin,
        other_dx,
    }
}

/// The paths down through a few columns of one band.
struct Strip<'a, C> {
    ground: Ground<'a, C>,
    /// The first column.
    start: usize,
    /// The first row of the band.
    top: usize,
    places: usize,
    /// The paths' costs after the row above, a run a column, and the least of each.
    runs: &'a mut [u8],
    least: &'a mut [u8],
    /// What is found for each row of the band, `[[column, place]]`: costs, and costs of the path.
    costs: Vec<&'a mut [u8]>,
    sums: Vec<&'a mut [u8]>,
}

impl<C: PixelCost> WideWork for Strip<'_, C> {
    #[inline(always)]
    fn work<W: Wide>(self, wide: W) {
        let Self {
            ground,
            start,
            top,
            places,
            runs,
            least,
            costs,
            sums,
        } = self;
        let mut spare = vec![0; places];
        for (row, (costs, sums)) in costs.into_iter().zip(sums).enumerate() {
            let y = top + row;
            let (cost, windows) = (ground.cost.row(y), ground.windows.row(y));
            let above = y.checked_sub(1);
            let above = above.map(|y| (ground.guide.below(y), ground.windows.row(y)));
            let pixels = costs
                .chunks_exact_mut(places)
                .zip(sums.chunks_exact_mut(places))
                .zip(runs.chunks_exact_mut(places).zip(&mut *least));
            for (column, ((costs, sums), (run, least))) in pixels.enumerate() {
                let x = start + column;
                let window = windows.at(x);
                let costs = &mut costs[..window.places];
                cost.costs(wide, x, window.first, costs);
                // What is no shift costs the most there is.
                let left_over = costs.iter_mut().skip(ground.shifts - window.first);
                for cost in left_over {
                    *cost = NO_SHIFT;
                }
                let large = match above {
                    None => 0,
                    Some((steps, windows)) => {
                        let before = windows.at(x);
                        if before != window {
                            moved(run, before, window, &mut spare);
                        }
                        ground.penalty.large(steps[x])
                    }
                };
                let penalties = (ground.penalty.small, large);
                let costs = costs.as_chunks().0;
                let sums = sums[..window.places].as_chunks_mut().0;
                let run = run.as_chunks_mut().0;
                *least = path_step(wide, run, *least, penalties, costs, |i, cost| {
                    wide.store(cost, &mut sums[i]);
                });
            }
        }
    }
}

/// What the paths of one row need.
#[derive(Clone, Debug)]
struct RowSpace {
    places: usize,
    /// The costs of a path along the row at its last pixel, and the least of them.
    run: Vec<u8>,
    least: u8,
    spare: Vec<u8>,
    total: Vec<u8>,
    /// What a large step from each pixel to the one before costs.
    large: Vec<u8>,
    /// The least sum that leads to each pixel of the other eye, and its shift's place in the block:
    /// places are counted within blocks of as many as a byte tells apart.
    other: Vec<OtherEye>,
    /// How the rows of the other eye are padded.
    padding: Padding,
}

/// What a block of shifts tells the other eye, pixel by pixel of a padded row.
#[derive(Clone, Debug)]
struct OtherEye {
    least: Vec<u8>,
    place: Vec<u8>,
}

/// Places that are counted together: a vector that begins at any of them ends at one that a byte
/// still tells apart.
const BLOCK: usize = 256 - LANES;

impl RowSpace {
    fn new(width: usize, search: SearchRange, places: usize) -> Self {
        let padding = Padding::of(search);
        let stride = padding.stride(width);
        let other = OtherEye {
            least: vec![0; stride],
            place: vec![0; stride],
        };
        Self {
            places,
            run: vec![0; places],
            least: 0,
            spare: vec![0; places],
            total: vec![0; places],
            large: vec![0; width + 1],
            other: vec![other; search.shifts().div_ceil(BLOCK)],
            padding,
        }
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
            moved(&mut self.run, from, to, &mut self.spare);
        }
    }
}

/// The horizontal paths of a few rows, and their winners.
struct Rows<'a, C> {
    ground: Ground<'a, C>,
    search: SearchRange,
    /// The first row.
    top: usize,
    spaces: &'a mut [RowSpace],
    /// Costs and sums of the rows, `[[row, x, place]]`.
    costs: &'a [u8],
    sums: &'a mut [u8],
    dx: ArrayViewMut2<'a, f32>,
    margin: ArrayViewMut2<'a, u8>,
    other_dx: Option<ArrayViewMut2<'a, f32>>,
}

impl<C: PixelCost> WideWork for Rows<'_, C> {
    #[inline(always)]
    fn work<W: Wide>(self, wide: W) {
        let Self {
            ground,
            search,
            top,
            spaces,
            costs,
            sums,
            mut dx,
            mut margin,
            mut other_dx,
        } = self;
        let (rows, width) = dx.dim();
        let spaces = &mut spaces[..rows];
        let small = ground.penalty.small;
        let last = ground.guide.height() - 1;
        let windows: [RowWindows<'_>; ROWS_A_JOB] =
            std::array::from_fn(|row| ground.windows.row((top + row).min(last)));
        for (row, space) in spaces.iter_mut().enumerate() {
            let steps = ground.guide.beside(top + row);
            for (large, step) in space.large[1..].iter_mut().zip(steps) {
                *large = ground.penalty.large(*step);
            }
            space.begin();
        }
        for x in 0..width {
            for (row, space) in spaces.iter_mut().enumerate() {
                let windows = windows[row];
                let window = windows.at(x);
                space.enter(windows.at(x.saturating_sub(1)), window);
                let pixel = (row * width + x) * space.places;
                let pixel = pixel..pixel + window.places;
                let costs = costs[pixel.clone()].as_chunks().0;
                let sums = sums[pixel].as_chunks_mut().0;
                let penalties = (small, space.large[x]);
                let run = space.run.as_chunks_mut().0;
                space.least = path_step(wide, run, space.least, penalties, costs, |i, cost| {
                    wide.store(wide.add(wide.load(&sums[i]), cost), &mut sums[i]);
                });
            }
        }

        for space in &mut *spaces {
            space.begin();
            if other_dx.is_some() {
                for other in &mut space.other {
                    other.least.fill(NO_SHIFT);
                }
            }
        }
        for x in (0..width).rev() {
            for (row, space) in spaces.iter_mut().enumerate() {
                let windows = windows[row];
                let window = windows.at(x);
                space.enter(windows.at((x + 1).min(width - 1)), window);
                let pixel = (row * width + x) * space.places;
                let pixel = pixel..pixel + window.places;
                let costs = costs[pixel.clone()].as_chunks().0;
                let sums = sums[pixel].as_chunks().0;
                let penalties = (small, space.large[x + 1]);
                let run = space.run.as_chunks_mut().0;
                let total = space.total.as_chunks_mut().0;
                let mut lowest = wide.splat(NO_SHIFT);
                space.least = path_step(wide, run, space.least, penalties, costs, |i, cost| {
                    let sum = wide.add(wide.load(&sums[i]), cost);
                    lowest = wide.min(lowest, sum);
                    wide.store(sum, &mut total[i]);
                });
                if other_dx.is_some() {
                    space.tell_the_other(wide, x, window);
                }
                let total = &space.total[..window.places];
                let found = winner(wide, total, wide.least(lowest));
                let whole = search.least_dx() + (window.first + found.place) as i32;
                dx[[row, x]] = whole as f32 + found.beyond;
                margin[[row, x]] = found.margin;
            }
        }
        let Some(other_dx) = &mut other_dx else {
            return;
        };
        for (mut other_dx, space) in other_dx.rows_mut().into_iter().zip(spaces) {
            space.told(search, &mut other_dx);
        }
    }
}

impl RowSpace {
    /// Offers the sums of pixel `x` to the pixels of the other eye that its shifts lead to, and to
    /// the padding where they lead out of view.
    #[inline(always)]
    fn tell_the_other<W: Wide>(&mut self, wide: W, x: usize, window: Window) {
        let first = self.padding.first(x) + window.first;
        let offers = self.total[..window.places].as_chunks::<LANES>().0;
        for (i, offer) in offers.iter().enumerate() {
            let place = window.first + i * LANES;
            // Beyond the last shift nothing is offered.
            let Some(other) = self.other.get_mut(place / BLOCK) else {
                return;
            };
            let seen = first + i * LANES..first + (i + 1) * LANES;
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
    fn told(&self, search: SearchRange, other_dx: &mut ArrayViewMut1<'_, f32>) {
        let own = self.padding.place(0)..self.padding.place(other_dx.len());
        let mut least = vec![NO_SHIFT; other_dx.len()];
        other_dx.fill(f32::NAN);
        for (block, other) in self.other.iter().enumerate() {
            let first = (search.least_dx() + (block * BLOCK) as i32) as f32;
            let told = other.least[own.clone()]
                .iter()
                .zip(&other.place[own.clone()]);
            for ((dx, least), (sum, place)) in other_dx.iter_mut().zip(&mut least).zip(told) {
                if *sum < *least {
                    (*least, *dx) = (*sum, first + f32::from(*place));
                }
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

        fn seen_by_the_other_eye(&self) -> Self {
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
            let guide = Guide::of(&EyeView::grey(&luma), true);
            let penalty = StepPenalty::new(&DenseParams::best());
            let search = SearchRange::new(least, least + shifts as i32 - 1).unwrap();
            let size = Size { width, height };
            let windows = SearchWindows::all(size, search);
            let ground =
                Ground { cost: &given, guide: &guide, penalty: &penalty, shifts, windows: &windows };
            let winners = aggregate(ground, search, true);
            let plain = plainly(&given, &guide, &penalty);
            let other = winners.other_dx.unwrap();
            for y in 0..height {
                for x in 0..width {
                    let sums = &plain[(y * width + x) * shifts..][..shifts];
                    prop_assert!(sums.iter().any(|sum| *sum < 255), "the winner's sum is a byte");
                    let best = (0..shifts).min_by_key(|d| sums[*d]).unwrap();
                    let found = winners.dx[[y, x]] - least as f32;
                    prop_assert!((found - best as f32).abs() <= 0.5);
                    let second = (0..shifts).filter(|d| d.abs_diff(best) > 1).map(|d| sums[d]).min();
                    if let Some(second) = second {
                        prop_assert_eq!(i32::from(winners.margin[[y, x]]), second - sums[best]);
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
