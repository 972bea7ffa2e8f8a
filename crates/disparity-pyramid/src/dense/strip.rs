use crate::dense::guide::Guide;
use crate::dense::path_step::{FAR, path_step};
use crate::dense::pixel_cost::{LANES, PixelCost};
use crate::dense::step_penalty::StepPenalty;
use crate::dense::wide::{Wide, WideWork, widest};

/// Columns of a strip: their path costs stay in the innermost cache for any usual search.
pub(crate) const STRIP: usize = 64;

/// Rows of a band, which is kept whole: costs and vertical paths of one band fill the memory of
/// sixteen rows, not of an image.
pub(crate) const BAND: usize = 16;

/// What all strips share.
#[derive(Debug)]
pub(crate) struct Ground<'a, C> {
    pub(crate) cost: &'a C,
    pub(crate) guide: &'a Guide,
    pub(crate) penalty: &'a StepPenalty,
    /// Shifts that are tried.
    pub(crate) shifts: usize,
}

impl<C> Clone for Ground<'_, C> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<C> Copy for Ground<'_, C> {}

/// A few columns of the image, over which the paths down and up run on their own.
///
/// Whoever needs a pixel's vertical paths needs the whole column below it. So the upward paths are
/// walked once from bottom to top, leaving a mark below each band, and once more band by band from
/// there, while the downward ones come along: twice the work for one of four paths, and no volume
/// of an image's size.
#[derive(Debug)]
pub(crate) struct Strip {
    start: usize,
    columns: usize,
    /// Shifts, rounded up to whole vectors.
    places: usize,
    down: Column,
    /// The upward paths at the row below each band, the topmost band's first.
    marks: Vec<Column>,
    spare: Column,
    /// `[[row of the band, column, place]]`
    costs: Vec<u8>,
    /// The sum of both vertical paths, likewise.
    vertical: Vec<i16>,
}

/// The path costs of one row's pixels: for each a run of costs between two far ones, and its least.
#[derive(Clone, Debug)]
struct Column {
    runs: Vec<i16>,
    least: Vec<i16>,
}

impl Column {
    /// Before the first pixel of a path: nothing has been paid.
    fn unpaid(columns: usize, places: usize) -> Self {
        let mut run = vec![0; places + 2];
        run[0] = FAR;
        run[places + 1] = FAR;
        Self {
            runs: run.repeat(columns),
            least: vec![0; columns],
        }
    }
}

impl Strip {
    /// The strips of an image.
    pub(crate) fn all(width: usize, shifts: usize) -> Vec<Self> {
        let places = shifts.next_multiple_of(LANES);
        let starts = (0..width).step_by(STRIP);
        starts
            .map(|start| {
                let columns = STRIP.min(width - start);
                Self {
                    start,
                    columns,
                    places,
                    down: Column::unpaid(columns, places),
                    marks: Vec::new(),
                    spare: Column::unpaid(columns, places),
                    costs: vec![0; BAND * columns * places],
                    vertical: vec![0; BAND * columns * places],
                }
            })
            .collect()
    }

    /// Walks the upward paths from the last row to the first band and leaves the marks.
    pub(crate) fn mark<C: PixelCost>(&mut self, ground: Ground<'_, C>) {
        widest(Mark(self, ground));
    }

    /// Fills the band that begins at row `top` with its costs and the sums of its vertical paths.
    /// Bands come in order, from the first on.
    pub(crate) fn fill_band<C: PixelCost>(&mut self, ground: Ground<'_, C>, top: usize) {
        widest(FillBand(self, ground, top));
    }

    /// The first column.
    pub(crate) const fn start(&self) -> usize {
        self.start
    }

    /// Costs and sums of the vertical paths of one row of the band, `[[column, place]]`.
    pub(crate) fn row(&self, row: usize) -> (&[u8], &[i16]) {
        let length = self.columns * self.places;
        let span = row * length..(row + 1) * length;
        (&self.costs[span.clone()], &self.vertical[span])
    }
}

struct Mark<'a, C>(&'a mut Strip, Ground<'a, C>);

impl<C: PixelCost> WideWork for Mark<'_, C> {
    #[inline(always)]
    fn work<W: Wide>(self, wide: W) {
        let Self(strip, ground) = self;
        let height = ground.guide.height();
        let bands = height.div_ceil(BAND);
        let mut up = Column::unpaid(strip.columns, strip.places);
        let mut marks = vec![up.clone()];
        let mut costs = vec![0; strip.places];
        for y in (BAND..height).rev() {
            for column in 0..strip.columns {
                cost_run(wide, &ground, strip.start + column, y, &mut costs);
                let large = below(&ground, strip.start + column, y);
                advance(wide, &up, &mut strip.spare, column, large, &ground, &costs);
            }
            std::mem::swap(&mut up, &mut strip.spare);
            if y.is_multiple_of(BAND) {
                marks.push(up.clone());
            }
        }
        debug_assert_eq!(marks.len(), bands);
        marks.reverse();
        strip.marks = marks;
    }
}

struct FillBand<'a, C>(&'a mut Strip, Ground<'a, C>, usize);

impl<C: PixelCost> WideWork for FillBand<'_, C> {
    #[inline(always)]
    fn work<W: Wide>(self, wide: W) {
        let Self(strip, ground, top) = self;
        let Strip {
            start,
            columns,
            places,
            down,
            marks,
            spare,
            costs,
            vertical,
        } = strip;
        let (start, columns, places) = (*start, *columns, *places);
        let rows = BAND.min(ground.guide.height() - top);
        let up = &mut marks[top / BAND];
        let run = |row: usize, column: usize| {
            let first = (row * columns + column) * places;
            first..first + places
        };
        for row in (0..rows).rev() {
            for column in 0..columns {
                let costs = &mut costs[run(row, column)];
                cost_run(wide, &ground, start + column, top + row, costs);
                let large = below(&ground, start + column, top + row);
                let now = advance(wide, up, spare, column, large, &ground, costs);
                vertical[run(row, column)].copy_from_slice(now);
            }
            std::mem::swap(up, spare);
        }
        // Spent: the band is filled once.
        *up = Column {
            runs: Vec::new(),
            least: Vec::new(),
        };
        for row in 0..rows {
            for column in 0..columns {
                let costs = &costs[run(row, column)];
                let large = match (top + row).checked_sub(1) {
                    Some(above) => below(&ground, start + column, above),
                    None => 0,
                };
                let now = advance(wide, down, spare, column, large, &ground, costs);
                let sums = vertical[run(row, column)].as_chunks_mut::<LANES>().0;
                for (sum, cost) in sums.iter_mut().zip(now.as_chunks::<LANES>().0) {
                    wide.store(wide.add(wide.load(sum), wide.load(cost)), sum);
                }
            }
            std::mem::swap(down, spare);
        }
    }
}

/// The costs of a pixel; places beyond the last shift cost the most there is.
#[inline(always)]
fn cost_run<C: PixelCost, W: Wide>(
    wide: W,
    ground: &Ground<'_, C>,
    x: usize,
    y: usize,
    costs: &mut [u8],
) {
    ground.cost.costs(wide, x, y, costs);
    costs[ground.shifts..].fill(u8::MAX);
}

/// What a large step of the shift costs between a pixel and the one below it.
#[inline(always)]
fn below<C>(ground: &Ground<'_, C>, x: usize, y: usize) -> i16 {
    ground.penalty.large(ground.guide.below(y)[x])
}

/// One step of the path in a column, from `before` to `now`.
#[inline(always)]
fn advance<'a, C, W: Wide>(
    wide: W,
    before: &Column,
    now: &'a mut Column,
    column: usize,
    large: i16,
    ground: &Ground<'_, C>,
    costs: &[u8],
) -> &'a [i16] {
    let length = costs.len() + 2;
    let span = column * length..(column + 1) * length;
    let run = &mut now.runs[span.clone()];
    now.least[column] = path_step(
        wide,
        &before.runs[span],
        before.least[column],
        (ground.penalty.small, large),
        costs,
        ground.shifts,
        run,
    );
    &run[1..=costs.len()]
}
