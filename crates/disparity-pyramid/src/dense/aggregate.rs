use ndarray::{Array2, ArrayViewMut2, Axis, s};
use rayon::prelude::*;

use crate::SearchRange;
use crate::dense::padding::Padding;
use crate::dense::path_step::{FAR, path_step};
use crate::dense::pixel_cost::{LANES, PixelCost};
use crate::dense::strip::{BAND, Ground, STRIP, Strip};
use crate::dense::wide::{Wide, WideWork, widest};
use crate::dense::winner::{NO_SHIFT, winner};

/// Rows that one thread takes at a time.
const ROWS_A_JOB: usize = 2;

/// The shift of every pixel whose paths cost least.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Winners {
    /// Shifts in pixels, between whole ones by the parabola.
    pub(crate) dx: Array2<f32>,
    /// How much more the best other shift costs, in the integers of a cost; 0 where nothing tells
    /// two shifts apart.
    pub(crate) margin: Array2<i16>,
    /// The shift (still `dx`, right minus left) of every pixel of the other eye by the same sums,
    /// in whole pixels; NaN where no shift leads there.
    pub(crate) other_dx: Option<Array2<f32>>,
}

/// Semi-global aggregation: four paths, from the left, the right, above and below, run through
/// every pixel; each adds to the pixel's cost of a shift what it paid to arrive there with it.
///
/// Bands of rows come one after the other; in each the columns' paths run side by side in strips,
/// then the rows'. No sum depends on how many threads share the work. With `other` the sums also
/// say what the other eye sees.
pub(crate) fn aggregate<C: PixelCost>(
    ground: Ground<'_, C>,
    search: SearchRange,
    other: bool,
) -> Winners {
    let (width, height) = (ground.guide.width(), ground.guide.height());
    let mut strips = Strip::all(width, ground.shifts);
    strips.par_iter_mut().for_each(|strip| strip.mark(ground));

    let mut dx = Array2::zeros((height, width));
    let mut margin = Array2::zeros((height, width));
    let mut other_dx = other.then(|| Array2::zeros((height, width)));
    let mut spaces = vec![RowSpace::new(width, search); BAND / ROWS_A_JOB];
    for top in (0..height).step_by(BAND) {
        strips
            .par_iter_mut()
            .for_each(|strip| strip.fill_band(ground, top));
        let rows = s![top..(top + BAND).min(height), ..];
        let mut dx = dx.slice_mut(rows);
        let mut margin = margin.slice_mut(rows);
        let jobs = dx
            .axis_chunks_iter_mut(Axis(0), ROWS_A_JOB)
            .zip(margin.axis_chunks_iter_mut(Axis(0), ROWS_A_JOB))
            .zip(&mut spaces);
        let mut others = other_dx.as_mut().map(|other| other.slice_mut(rows));
        let mut others = others
            .iter_mut()
            .flat_map(|other| other.axis_chunks_iter_mut(Axis(0), ROWS_A_JOB));
        let jobs = jobs.enumerate().map(|(job, ((dx, margin), space))| Rows {
            ground,
            strips: &strips,
            search,
            top,
            first: job * ROWS_A_JOB,
            space,
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

/// What the paths of one row need.
#[derive(Clone)]
struct RowSpace {
    places: usize,
    /// The sums of three paths `[[x, place]]`.
    sums: Vec<i16>,
    before: Vec<i16>,
    now: Vec<i16>,
    total: Vec<i16>,
    /// What a large step from each pixel to the next costs.
    large: Vec<i16>,
    /// The least sum that leads to each pixel of the other eye, and its shift's place.
    other_least: Vec<i16>,
    other_place: Vec<i16>,
    /// How the two above are padded.
    padding: Padding,
}

impl RowSpace {
    fn new(width: usize, search: SearchRange) -> Self {
        let places = search.shifts().next_multiple_of(LANES);
        let padding = Padding::of(search);
        Self {
            places,
            sums: vec![0; width * places],
            before: vec![FAR; places + 2],
            now: vec![FAR; places + 2],
            total: vec![0; places],
            large: vec![0; width],
            other_least: vec![0; padding.stride(width)],
            other_place: vec![0; padding.stride(width)],
            padding,
        }
    }

    /// Before the first pixel of a path: nothing has been paid.
    #[inline(always)]
    fn unpaid(&mut self) {
        self.before[1..=self.places].fill(0);
    }
}

/// The horizontal paths of a few rows, and their winners.
struct Rows<'a, C> {
    ground: Ground<'a, C>,
    strips: &'a [Strip],
    search: SearchRange,
    /// The first row of the band.
    top: usize,
    /// The first row of the job, within the band.
    first: usize,
    space: &'a mut RowSpace,
    dx: ArrayViewMut2<'a, f32>,
    margin: ArrayViewMut2<'a, i16>,
    other_dx: Option<ArrayViewMut2<'a, f32>>,
}

impl<C: PixelCost> WideWork for Rows<'_, C> {
    #[inline(always)]
    fn work<W: Wide>(mut self, wide: W) {
        for row in 0..self.dx.nrows() {
            self.row(wide, row);
        }
    }
}

impl<C: PixelCost> Rows<'_, C> {
    #[inline(always)]
    fn row<W: Wide>(&mut self, wide: W, row: usize) {
        let Self {
            ground,
            strips,
            search,
            top,
            first,
            space,
            dx,
            margin,
            other_dx,
        } = self;
        let (ground, search) = (*ground, *search);
        let band_row = *first + row;
        let y = *top + band_row;
        let mut dx = dx.row_mut(row);
        let mut margin = margin.row_mut(row);
        let (width, places, shifts) = (dx.len(), space.places, ground.shifts);
        let steps = ground.guide.beside(y);
        for (large, step) in space.large[1..].iter_mut().zip(steps) {
            *large = ground.penalty.large(*step);
        }
        let small = ground.penalty.small;

        space.unpaid();
        let mut least = 0;
        for strip in strips.iter() {
            let (costs, vertical) = strip.row(band_row);
            let runs = costs
                .chunks_exact(places)
                .zip(vertical.chunks_exact(places));
            for (column, (costs, vertical)) in runs.enumerate() {
                let x = strip.start() + column;
                let penalties = (small, space.large[x]);
                let (before, now) = (&space.before, &mut space.now);
                least = path_step(wide, before, least, penalties, costs, shifts, now);
                let sums = &mut space.sums[x * places..(x + 1) * places];
                add(wide, &now[1..=places], vertical, sums);
                std::mem::swap(&mut space.before, &mut space.now);
            }
        }

        space.unpaid();
        space.other_least.fill(NO_SHIFT);
        let mut least = 0;
        for x in (0..width).rev() {
            let strip = &strips[x / STRIP];
            let column = x - strip.start();
            let costs = &strip.row(band_row).0[column * places..(column + 1) * places];
            let large = space.large.get(x + 1).copied().unwrap_or(0);
            let (before, now) = (&space.before, &mut space.now);
            least = path_step(wide, before, least, (small, large), costs, shifts, now);
            let sums = &space.sums[x * places..(x + 1) * places];
            add(wide, &now[1..=places], sums, &mut space.total);
            space.total[shifts..].fill(NO_SHIFT);
            if other_dx.is_some() {
                space.tell_the_other(wide, x);
            }
            let found = winner(wide, &mut space.total);
            let whole = search.least_dx() + found.place as i32;
            dx[x] = whole as f32 + found.beyond;
            margin[x] = found.margin;
            std::mem::swap(&mut space.before, &mut space.now);
        }
        let Some(other_dx) = other_dx else {
            return;
        };
        let own = space.padding.place(0)..space.padding.place(width);
        let told = space.other_least[own.clone()]
            .iter()
            .zip(&space.other_place[own]);
        for (dx, (least, place)) in other_dx.row_mut(row).iter_mut().zip(told) {
            *dx = if *least < NO_SHIFT {
                (search.least_dx() + i32::from(*place)) as f32
            } else {
                f32::NAN
            };
        }
    }
}

impl RowSpace {
    /// Offers the sums of pixel `x` to the pixels of the other eye that its shifts lead to, and to
    /// the padding where they lead out of view.
    #[inline(always)]
    fn tell_the_other<W: Wide>(&mut self, wide: W, x: usize) {
        let first = self.padding.first(x);
        let seen = first..first + self.places;
        let least = self.other_least[seen.clone()].as_chunks_mut::<LANES>().0;
        let best = self.other_place[seen].as_chunks_mut::<LANES>().0;
        let mut place = wide.load(&FIRST_PLACES);
        let offers = self.total.as_chunks::<LANES>().0;
        for ((offer, least), best) in offers.iter().zip(least).zip(best) {
            let (offer, held) = (wide.load(offer), wide.load(least));
            let chosen = wide.if_less(offer, held, place, wide.load(best));
            wide.store(chosen, best);
            wide.store(wide.min(offer, held), least);
            place = wide.add(place, wide.splat(LANES as i16));
        }
    }
}

/// The first places of a run.
const FIRST_PLACES: [i16; LANES] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

/// The sums of two runs.
#[inline(always)]
fn add<W: Wide>(wide: W, one: &[i16], other: &[i16], sums: &mut [i16]) {
    let one = one.as_chunks::<LANES>().0;
    let other = other.as_chunks::<LANES>().0;
    let sums = sums.as_chunks_mut::<LANES>().0;
    for ((one, other), sum) in one.iter().zip(other).zip(sums) {
        wide.store(wide.add(wide.load(one), wide.load(other)), sum);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use v1_gabor::LumaImage;

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
        fn costs<W: Wide>(&self, _: W, x: usize, y: usize, costs: &mut [u8]) {
            let start = (y * self.width + x) * self.shifts;
            costs[..self.shifts].copy_from_slice(&self.costs[start..start + self.shifts]);
        }

        fn seen_by_the_other_eye(&self) -> Self {
            unreachable!("aggregation looks with one eye")
        }
    }

    /// The summed path costs of every pixel and shift, one path after the other, in whole volumes.
    fn plainly(given: &Given, guide: &Guide, penalty: &StepPenalty) -> Vec<i32> {
        let (width, height, shifts) = (given.width, guide.height(), given.shifts);
        let mut sums = vec![0; width * height * shifts];
        for (step_x, step_y) in [(1, 0), (-1, 0), (0, 1), (0, -1)] {
            let mut path = vec![0; sums.len()];
            let columns: Vec<usize> = if step_x < 0 {
                (0..width).rev().collect()
            } else {
                (0..width).collect()
            };
            let rows: Vec<usize> = if step_y < 0 {
                (0..height).rev().collect()
            } else {
                (0..height).collect()
            };
            for &y in &rows {
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
            let costs = (0..width * height * shifts).map(|_| random(128) as u8).collect();
            let given = Given { width, shifts, costs };
            let luma = Array2::from_shape_simple_fn((height, width), || random(9) as f32 / 255.0);
            let luma = LumaImage::new(luma).unwrap();
            let guide = Guide::of(&EyeView::grey(&luma), true);
            let penalty = StepPenalty::new(&DenseParams::best());
            let search = SearchRange::new(least, least + shifts as i32 - 1).unwrap();
            let ground = Ground { cost: &given, guide: &guide, penalty: &penalty, shifts };
            let winners = aggregate(ground, search, true);
            let plain = plainly(&given, &guide, &penalty);
            let other = winners.other_dx.unwrap();
            for y in 0..height {
                for x in 0..width {
                    let sums = &plain[(y * width + x) * shifts..][..shifts];
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
                        None => prop_assert!(other[[y, x]].is_nan()),
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
