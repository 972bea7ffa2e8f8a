use std::ops::Range;

use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::SearchRange;
use crate::dense::partial_field::{PartialField, is_hidden};

/// Directions in which a missed pixel looks for known ones.
const DIRECTIONS: usize = 16;

/// Those that lead to rows further on, as (x, rows) steps; the others are the same the other way
/// round, and along the row itself.
const ONWARD: [(isize, usize); 7] = [(2, 1), (1, 1), (1, 2), (0, 1), (-1, 2), (-1, 1), (-2, 1)];

/// The farthest step, in pixels along a row and in rows.
const FARTHEST: usize = 2;

/// Pixels whose shifts are sorted side by side.
const LANES: usize = 16;

/// What filling works in, kept from field to field.
#[derive(Clone, Debug, Default)]
pub(crate) struct FillRoom {
    /// What must look around, row by row, and where each row's begin and end.
    missed: Vec<Missed>,
    rows: Vec<Range<usize>>,
    /// What each of them sees above and below, and the median of all that.
    above: Vec<[f32; ONWARD.len()]>,
    below: Vec<[f32; ONWARD.len()]>,
    medians: Vec<Option<f32>>,
    onward: (Onward, Onward),
}

/// Gives every pixel a shift: a hidden one takes what lies behind it on its row, and at the image's rim
/// what is beside it goes on as slanted as it is; any other takes the median of the nearest known shifts
/// in sixteen directions (of two in the middle the farther), and if nothing at all is known there the
/// shift of the search that says least.
///
/// What a pixel sees in a direction is what its neighbour there is or sees. So one walk up the image
/// and one down, side by side, tell every pixel, however far it has to look.
pub(crate) fn fill(field: &mut PartialField, search: SearchRange, room: &mut FillRoom) {
    let otherwise = 0.clamp(search.least_dx(), search.most_dx()) as f32;
    let height = field.dx.nrows();
    let FillRoom {
        missed,
        rows,
        above,
        below,
        medians,
        onward,
    } = room;
    missed.clear();
    rows.clear();
    for y in 0..height {
        let first = missed.len();
        let mut next = 0;
        while let Some(hole) = field.hole_from(y, next) {
            next = hole.columns.end;
            let behind = hole.behind();
            let line = field.goes_on(y, &hole);
            let beside = [hole.left, hole.right].map(|dx| dx.unwrap_or(f32::INFINITY));
            for x in hole.columns {
                match behind {
                    Some(behind) if is_hidden(field.validity[[y, x]]) => {
                        let least = search.least_dx() as f32;
                        let most = search.most_dx() as f32;
                        let goes_on = line.map(|line| line.at(x).clamp(least, most));
                        field.dx[[y, x]] = goes_on.unwrap_or(behind);
                    }
                    _ => missed.push(Missed { x, beside }),
                }
            }
        }
        rows.push(first..missed.len());
    }

    let (down, up) = (&mut *above, &mut *below);
    let (first, last) = onward;
    rayon::join(
        || first.walk(field, (rows.iter().enumerate(), missed), down),
        || last.walk(field, (rows.iter().enumerate().rev(), missed), up),
    );
    medians.clear();
    medians.resize(missed.len(), None);
    medians
        .par_chunks_mut(LANES)
        .zip(missed.par_chunks(LANES))
        .zip(above.par_chunks(LANES).zip(below.par_chunks(LANES)))
        .for_each(|((medians, missed), (above, below))| {
            let mut around = [[f32::INFINITY; DIRECTIONS]; LANES];
            let seen = missed.iter().zip(above.iter().zip(below));
            for (around, (missed, (above, below))) in around.iter_mut().zip(seen) {
                around[..2].copy_from_slice(&missed.beside);
                around[2..9].copy_from_slice(above);
                around[9..].copy_from_slice(below);
            }
            medians.copy_from_slice(&medians_of(&around)[..missed.len()]);
        });
    for (y, row) in rows.iter().enumerate() {
        for (missed, median) in missed[row.clone()].iter().zip(&medians[row.clone()]) {
            field.dx[[y, missed.x]] = median.unwrap_or(otherwise);
        }
    }
}

/// A pixel that must look around, and the nearest known shifts to its left and right, infinite where
/// there is none.
#[derive(Clone, Copy, Debug)]
struct Missed {
    x: usize,
    beside: [f32; 2],
}

/// What is nearest in each direction that leads back to the rows walked over, from each pixel of
/// the last of them, itself included: infinite where nothing is known.
#[derive(Clone, Debug, Default)]
struct Onward {
    /// For each direction the last rows, the latest first, between columns that know nothing.
    rows: [[Vec<f32>; FARTHEST]; ONWARD.len()],
    spare: Vec<f32>,
    /// What a row itself knows.
    own: Vec<f32>,
}

impl Onward {
    /// Before the first row, where nothing is seen.
    fn begin(&mut self, width: usize) {
        self.own.resize(width, 0.0);
        let rows = self.rows.iter_mut().flatten();
        for row in rows.chain(std::iter::once(&mut self.spare)) {
            row.clear();
            row.resize(width + 2 * FARTHEST, f32::INFINITY);
        }
    }

    /// Walks over all rows in an order, and writes what the pixels to be told see back on the way:
    /// those of each row are a range of `missed`.
    fn walk<'a>(
        &mut self,
        field: &PartialField,
        (rows, missed): (impl Iterator<Item = (usize, &'a Range<usize>)>, &[Missed]),
        seen: &mut Vec<[f32; ONWARD.len()]>,
    ) {
        seen.resize(missed.len(), [f32::INFINITY; ONWARD.len()]);
        self.begin(field.dx.ncols());
        for (y, row) in rows {
            for (seen, missed) in seen[row.clone()].iter_mut().zip(&missed[row.clone()]) {
                *seen = self.seen_from(missed.x);
            }
            self.pass(field, y);
        }
    }

    /// What pixel `x` of the next row sees.
    fn seen_from(&self, x: usize) -> [f32; ONWARD.len()] {
        std::array::from_fn(|i| {
            let (step, rows) = ONWARD[i];
            self.rows[i][rows - 1][(FARTHEST + x).wrapping_add_signed(step)]
        })
    }

    /// Walks over row `y`.
    fn pass(&mut self, field: &PartialField, y: usize) {
        let (dx, known) = (field.dx.row(y), field.known.row(y));
        let (Some(dx), Some(known)) = (dx.to_slice(), known.to_slice()) else {
            unreachable!("planes are made in row-major order")
        };
        Arch::new().dispatch(Walked {
            rows: &mut self.rows,
            spare: &mut self.spare,
            own: &mut self.own,
            dx,
            known,
        });
    }
}

/// A row on the way: what it knows, and what the rows before it are seen to hold.
struct Walked<'a> {
    rows: &'a mut [[Vec<f32>; FARTHEST]; ONWARD.len()],
    spare: &'a mut Vec<f32>,
    own: &'a mut [f32],
    dx: &'a [f32],
    known: &'a [bool],
}

impl NullaryFnOnce for Walked<'_> {
    type Output = ();

    /// In each direction the row's own where it knows something, else what it sees.
    #[inline(always)]
    fn call(self) {
        let Self {
            rows,
            spare,
            own,
            dx,
            known,
        } = self;
        let length = own.len();
        let (dx, known) = (&dx[..length], &known[..length]);
        for i in 0..length {
            own[i] = if known[i] { dx[i] } else { f32::INFINITY };
        }
        for ([latest, before], (step, back)) in rows.iter_mut().zip(ONWARD) {
            let from = if back == 1 { &*latest } else { &*before };
            let from = &from[FARTHEST.wrapping_add_signed(step)..][..length];
            let next = &mut spare[FARTHEST..][..length];
            for i in 0..length {
                next[i] = if own[i] < f32::INFINITY {
                    own[i]
                } else {
                    from[i]
                };
            }
            std::mem::swap(latest, before);
            std::mem::swap(latest, spare);
        }
    }
}

/// The median of what each of a few pixels sees, of two in the middle the farther; `None` if it
/// sees nothing.
fn medians_of(around: &[[f32; DIRECTIONS]; LANES]) -> [Option<f32>; LANES] {
    let mut counts = [0; LANES];
    let mut sorted = [[f32::INFINITY; LANES]; DIRECTIONS];
    for (lane, around) in around.iter().enumerate() {
        counts[lane] = around.iter().filter(|dx| dx.is_finite()).count();
        for (sorted, dx) in sorted.iter_mut().zip(around) {
            sorted[lane] = *dx;
        }
    }
    Arch::new().dispatch(Sort(&mut sorted));
    std::array::from_fn(|lane| {
        let count = counts[lane];
        (count > 0).then(|| sorted[count / 2][lane])
    })
}

/// Sorts the columns of a block, the least first.
struct Sort<'a>(&'a mut [[f32; LANES]; DIRECTIONS]);

impl NullaryFnOnce for Sort<'_> {
    type Output = ();

    /// Batcher's network for sixteen: sorted runs are merged by pairs, in steps of halving distance.
    #[inline(always)]
    fn call(mut self) {
        let mut run = 1;
        while run < DIRECTIONS {
            let mut distance = run;
            while distance > 0 {
                for start in (distance % run..DIRECTIONS - distance).step_by(2 * distance) {
                    for low in start..(start + distance).min(DIRECTIONS - distance) {
                        if low / (2 * run) == (low + distance) / (2 * run) {
                            self.exchange(low, low + distance);
                        }
                    }
                }
                distance /= 2;
            }
            run *= 2;
        }
    }
}

impl Sort<'_> {
    #[inline(always)]
    fn exchange(&mut self, low: usize, high: usize) {
        let (a, b) = (self.0[low], self.0[high]);
        for lane in 0..LANES {
            self.0[low][lane] = if a[lane] < b[lane] { a[lane] } else { b[lane] };
            self.0[high][lane] = if a[lane] < b[lane] { b[lane] } else { a[lane] };
        }
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;
    use proptest::prelude::*;

    use super::*;
    use crate::Validity;

    proptest! {
        /// Two walks over the image tell every pixel what it sees itself.
        #[test]
        fn walks_and_looks_agree(width in 1usize..30, height in 1usize..30, holes in 0u64..8, seed: u64) {
            let mut state = seed | 1;
            let mut random = |below: u64| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 20) % below
            };
            let dx = Array2::from_shape_simple_fn((height, width), || -(random(40) as f32));
            let validity = Array2::from_shape_simple_fn((height, width), || {
                if random(8) < holes { Validity::Inconsistent } else { Validity::Valid }
            });
            let field = PartialField::new(dx, validity, Array2::default((0, 0)));
            let search = SearchRange::new(-50, -2).unwrap();
            let mut filled = field.clone();
            fill(&mut filled, search, &mut FillRoom::default());
            for ((y, x), dx) in filled.dx.indexed_iter() {
                let want = if field.known[[y, x]] {
                    field.dx[[y, x]]
                } else {
                    median_around(&field, x, y).unwrap_or(-2.0)
                };
                prop_assert_eq!(*dx, want, "at ({}, {})", x, y);
            }
        }
    }

    /// The twin of [`fill`]: each pixel looks for itself. The median of the nearest known shifts in sixteen directions; of two in the middle the farther.
    fn median_around(field: &PartialField, x: usize, y: usize) -> Option<f32> {
        let (height, width) = field.dx.dim();
        let (Some(dx), Some(known)) = (field.dx.as_slice(), field.known.as_slice()) else {
            unreachable!("planes are made in row-major order")
        };
        let here = y * width + x;
        let mut found = [0.0; DIRECTIONS];
        let mut count = 0;
        for (step_x, step_y) in STEPS {
            // Steps that stay within the image.
            let within = |at: usize, length: usize, step: isize| match step {
                0 => usize::MAX,
                1.. => (length - 1 - at) / step.unsigned_abs(),
                _ => at / step.unsigned_abs(),
            };
            let steps = within(x, width, step_x).min(within(y, height, step_y));
            let stride = step_y * width as isize + step_x;
            let places = (1..=steps).map(|step| here.wrapping_add_signed(stride * step as isize));
            if let Some(place) = places.into_iter().find(|place| known[*place]) {
                found[count] = dx[place];
                count += 1;
            }
        }
        let found = &mut found[..count];
        found.sort_by(f32::total_cmp);
        found.get(count / 2).copied()
    }

    /// All directions, as (x, y) steps.
    const STEPS: [(isize, isize); DIRECTIONS] = [
        (1, 0),
        (2, 1),
        (1, 1),
        (1, 2),
        (0, 1),
        (-1, 2),
        (-1, 1),
        (-2, 1),
        (-1, 0),
        (-2, -1),
        (-1, -1),
        (-1, -2),
        (0, -1),
        (1, -2),
        (1, -1),
        (2, -1),
    ];

    #[test]
    fn hidden_pixels_take_the_background_and_missed_ones_their_surroundings() {
        let dx = Array2::from_shape_fn((5, 9), |(_, x)| if x < 4 { -2.0 } else { -7.0 });
        let mut validity = Array2::from_elem((5, 9), Validity::Valid);
        validity[[2, 4]] = Validity::Occluded;
        validity[[2, 6]] = Validity::Inconsistent;
        let mut field = PartialField::new(dx, validity, Array2::default((0, 0)));
        field.dx[[2, 4]] = 99.0;
        field.dx[[2, 6]] = 99.0;
        fill(
            &mut field,
            SearchRange::new(-9, 0).unwrap(),
            &mut FillRoom::default(),
        );
        assert_eq!((field.dx[[2, 4]], field.dx[[2, 6]]), (-2.0, -7.0));
        assert_eq!(field.dx[[0, 4]], -7.0);
    }

    #[test]
    fn slants_go_on_beyond_the_rim() {
        // A surface that the right eye does not see in its first 20 columns.
        let slanted = |x: usize| -10.0 + 0.125 * x as f32;
        let dx = Array2::from_shape_fn((4, 60), |(_, x)| if x < 20 { 9.0 } else { slanted(x) });
        let validity = Array2::from_shape_fn((4, 60), |(_, x)| match x {
            0..20 => Validity::OutOfView,
            _ => Validity::Valid,
        });
        let mut field = PartialField::new(dx, validity, Array2::default((0, 0)));
        let search = SearchRange::new(-9, 0).unwrap();
        fill(&mut field, search, &mut FillRoom::default());
        for ((_, x), dx) in field.dx.indexed_iter() {
            // Medians of twelve lie half a pixel beside the middle, in both runs alike.
            let want = slanted(x).max(-9.0);
            assert!((dx - want).abs() < 0.1, "{dx} for {want} at {x}");
        }
    }

    #[test]
    fn where_nothing_is_known_there_is_a_last_word() {
        let nothing = Array2::from_elem((3, 4), Validity::NoEnergy);
        let guess = Array2::from_elem((3, 4), -5.0);
        let mut field = PartialField::new(guess, nothing, Array2::default((0, 0)));
        fill(
            &mut field,
            SearchRange::new(-9, -1).unwrap(),
            &mut FillRoom::default(),
        );
        assert!(field.dx.iter().all(|dx| *dx == -1.0));
    }
}
