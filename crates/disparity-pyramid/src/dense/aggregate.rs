use std::ops::Range;

use ndarray::{Array2, ArrayViewMut2, Axis};
use rayon::prelude::*;

use crate::SearchRange;
use crate::dense::guide::Guide;
use crate::dense::paths_along::{Along, RowSpace};
use crate::dense::paths_down::PathsDown;
use crate::dense::pixel_cost::PixelCost;
use crate::dense::search_windows::{SearchWindows, TILE};
use crate::dense::step_penalty::StepPenalty;
use crate::dense::wide::{Wide, WideWork, widest};

/// Rows whose paths are walked side by side: a path along a row waits for its last pixel, and another
/// row's has nothing to do with it.
pub(crate) const ROWS: usize = 4;

/// Rows above a stretch from which its paths down come: what a path has paid further up is forgotten
/// on the way (of half as many rows Teddy still shows the cut). A whole number of tiles.
const LEAD: usize = 4 * TILE.height;

/// About how many rows a stretch has at least and at most.
const ROWS_OF_STRETCH: Range<usize> = 32..200;

/// An image has a multiple of so many stretches, as long as they are not too short: threads get as
/// many each.
const SHARES: usize = 4;

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

/// What paths need, kept from pair to pair: a room for each stretch.
#[derive(Clone, Debug, Default)]
pub(crate) struct PathRoom {
    stretches: Vec<StretchRoom>,
}

#[derive(Clone, Debug, Default)]
struct StretchRoom {
    down: PathsDown,
    rows: Vec<RowSpace>,
}

/// Semi-global aggregation: three paths, from the left, the right and above, run through every
/// pixel; each adds to the pixel's cost of a shift what it paid to arrive there with it.
///
/// A path from below would need every column to its end before the first row is known: twice the
/// work of one from above, for a hundredth of the errors. The image is walked in stretches of rows that
/// ask nothing of one another: the paths down through one begin [`LEAD`] rows above it. So threads share
/// the work without ever waiting, and how the rows are cut depends on the height alone: no sum depends
/// on how many threads there are. With [`Winners::other_dx`] the sums also say what the other eye sees.
///
/// All sums are bytes. A sum of three paths above 255 stays there; the winner's is far below, since
/// no path pays more than the winner's cost and a large step for being elsewhere.
pub(crate) fn aggregate<C: PixelCost>(
    ground: Ground<'_, C>,
    search: SearchRange,
    room: &mut PathRoom,
    winners: Winners<'_>,
) {
    let rows = rows_of_stretch(ground.guide.height());
    let count = ground.guide.height().div_ceil(rows);
    if room.stretches.len() < count {
        room.stretches.resize_with(count, StretchRoom::default);
    }
    let Winners {
        dx,
        margin,
        other_dx,
    } = winners;
    let mut others = other_dx.map(|other| other.axis_chunks_iter_mut(Axis(0), rows));
    let stretches: Vec<_> = dx
        .axis_chunks_iter_mut(Axis(0), rows)
        .zip(margin.axis_chunks_iter_mut(Axis(0), rows))
        .zip(&mut room.stretches)
        .enumerate()
        .map(|(stretch, ((dx, margin), room))| Stretch {
            ground,
            search,
            top: stretch * rows,
            room,
            dx,
            margin,
            other_dx: others.as_mut().and_then(Iterator::next),
        })
        .collect();
    stretches.into_par_iter().for_each(widest);
}

/// How many rows a stretch of an image of this height has, whole tiles.
fn rows_of_stretch(height: usize) -> usize {
    let shared = SHARES * height.div_ceil(SHARES * ROWS_OF_STRETCH.end);
    let most = height.div_ceil(ROWS_OF_STRETCH.start);
    let rows = height.div_ceil(shared.min(most).max(1));
    rows.next_multiple_of(TILE.height)
}

/// Some rows of the image, and where their winners are written.
struct Stretch<'a, C> {
    ground: Ground<'a, C>,
    search: SearchRange,
    top: usize,
    room: &'a mut StretchRoom,
    dx: ArrayViewMut2<'a, f32>,
    margin: ArrayViewMut2<'a, u8>,
    other_dx: Option<ArrayViewMut2<'a, f32>>,
}

impl<C: PixelCost> WideWork for Stretch<'_, C> {
    #[inline(always)]
    fn work<W: Wide>(self, wide: W) {
        let Self {
            ground,
            search,
            top,
            room: StretchRoom { down, rows: spaces },
            mut dx,
            mut margin,
            mut other_dx,
        } = self;
        let width = ground.guide.width();
        let lead = top.saturating_sub(LEAD);
        down.begin(ground.windows);
        spaces.resize_with(ROWS, RowSpace::default);
        for space in &mut *spaces {
            space.fit(ground.windows, width, search);
        }
        for y in (lead..top).step_by(ROWS) {
            down.walk(wide, ground, y..y + ROWS, y == lead);
        }
        let others = other_dx.as_mut();
        let mut others = others.map(|other| other.axis_chunks_iter_mut(Axis(0), ROWS));
        let winners = dx
            .axis_chunks_iter_mut(Axis(0), ROWS)
            .zip(margin.axis_chunks_iter_mut(Axis(0), ROWS));
        for (y, (dx, margin)) in (top..).step_by(ROWS).zip(winners) {
            let rows = y..y + dx.nrows();
            down.walk(wide, ground, rows.clone(), y == lead);
            let along = Along {
                ground,
                search,
                down,
                top: y,
                spaces: &mut spaces[..rows.len()],
                dx,
                margin,
                other_dx: others.as_mut().and_then(Iterator::next),
            };
            along.walk(wide);
        }
    }
}

/// Runs `$work::<N>` with as many vectors as a window has, or 0 where that is no common number: loops
/// over a number that the compiler knows leave nothing to count.
macro_rules! with_vectors {
    ($places:expr, $work:ident ( $($argument:expr),* )) => {
        match $places / $crate::dense::pixel_cost::LANES {
            1 => $work::<_, _, 1>($($argument),*),
            2 => $work::<_, _, 2>($($argument),*),
            3 => $work::<_, _, 3>($($argument),*),
            4 => $work::<_, _, 4>($($argument),*),
            _ => $work::<_, _, 0>($($argument),*),
        }
    };
}
pub(crate) use with_vectors;

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use v1_gabor::{LumaImage, Size};

    use super::*;
    use crate::dense::dense_params::DenseParams;
    use crate::dense::eye_view::EyeView;
    use crate::dense::guide::Guide;
    use crate::dense::pixel_cost::RowCost;
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
        let height = guide.height();
        let mut sums = vec![0; given.width * height * given.shifts];
        for step_x in [1, -1] {
            add_path(
                given,
                guide,
                penalty,
                (step_x, 0),
                (0..height, 0),
                &mut sums,
            );
        }
        let rows = rows_of_stretch(height);
        for top in (0..height).step_by(rows) {
            let stretch = top.saturating_sub(LEAD)..(top + rows).min(height);
            add_path(given, guide, penalty, (0, 1), (stretch, top), &mut sums);
        }
        // What a byte holds.
        for sum in &mut sums {
            *sum = (*sum).min(255);
        }
        sums
    }

    /// Walks a path in steps of `(x, y)` through some rows, and adds what it pays from row `counted` on.
    fn add_path(
        given: &Given,
        guide: &Guide,
        penalty: &StepPenalty,
        (step_x, step_y): (isize, isize),
        (rows, counted): (Range<usize>, usize),
        sums: &mut [i32],
    ) {
        let (width, shifts) = (given.width, given.shifts);
        let mut path = vec![0; sums.len()];
        let columns: Vec<usize> = if step_x < 0 {
            (0..width).rev().collect()
        } else {
            (0..width).collect()
        };
        for y in rows.clone() {
            for &x in &columns {
                let here = y * width + x;
                let before = x
                    .checked_add_signed(-step_x)
                    .filter(|x| *x < width)
                    .zip(y.checked_add_signed(-step_y).filter(|y| rows.contains(y)))
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
        let from = counted * width * shifts;
        for (sum, path) in sums[from..].iter_mut().zip(&path[from..]) {
            *sum += path;
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// Stretches, windows and vectors give the winners of the plain sums, and tell the other eye
        /// the same.
        #[test]
        fn fast_and_plain_agree(
            width in 1usize..50, height in 1usize..150, shifts in 1usize..40, least in -30i32..3, seed: u64,
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
            // What a shift asks beyond most of what the pixel's own best asks.
            let offer = |plain: &[i32], place: usize, d: usize| {
                let sums = &plain[place * shifts..][..shifts];
                let least = *sums.iter().min().unwrap();
                if sums[d] < 255 { sums[d] - least + least / 5 } else { 255 }
            };
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
                        (from < width).then(|| offer(&plain, y * width + from, d))
                    });
                    match told.min() {
                        None | Some(255) => prop_assert!(other[[y, x]].is_nan()),
                        Some(least_offer) => {
                            let d = (other[[y, x]] - least as f32) as usize;
                            let from = (x as i32 - least - d as i32) as usize;
                            prop_assert_eq!(offer(&plain, y * width + from, d), least_offer);
                        }
                    }
                }
            }
        }
    }
}
