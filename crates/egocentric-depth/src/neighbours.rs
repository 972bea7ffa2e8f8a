use disparity_pyramid::{DisparityField, Validity};
use ndarray::ArrayView2;
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::roughness::REACH;

/// What the roughness of a field is worked out in, kept from field to field.
///
/// It gives the numbers of [`scatter`](crate::scatter()), bit for bit, without asking 25 neighbours at every pixel: the
/// farthest of them is the largest or the smallest, and both are found along columns first, then along rows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Neighbours {
    bands: Vec<Band>,
    counts: Vec<u32>,
    near: Vec<f32>,
}

/// What one thread works in.
#[derive(Clone, Debug, Default)]
struct Band {
    /// The smallest and the largest of each column, with [`REACH`] more at either end that say nothing.
    least: Vec<f32>,
    most: Vec<f32>,
    /// How far the shifts of a row are from their neighbours, and the valid shifts of all its rows.
    farthest: Vec<f32>,
    found: Vec<f32>,
}

impl Neighbours {
    /// See [`roughness_px`](crate::roughness_px()).
    pub(crate) fn roughness_px(&mut self, field: &DisparityField) -> Option<f64> {
        let across = self.ninetieth(field.dx(), field.validity())?;
        let down = self.ninetieth(field.dy(), field.validity())?;
        Some(if down > 0.0 {
            (across * across * down).cbrt()
        } else {
            across
        })
    }

    /// See [`roughness_across_px`](crate::roughness_across_px()).
    pub(crate) fn roughness_across_px(&mut self, field: &DisparityField) -> Option<f64> {
        self.ninetieth(field.dx(), field.validity())
    }

    /// What nine valid pixels of ten keep within.
    fn ninetieth(
        &mut self,
        shifts: ArrayView2<'_, f32>,
        validity: ArrayView2<'_, Validity>,
    ) -> Option<f64> {
        let (height, width) = shifts.dim();
        let threads = rayon::current_num_threads().max(1);
        let rows = height.div_ceil(threads).max(1);
        self.bands.resize_with(threads, Band::default);
        self.bands
            .par_iter_mut()
            .enumerate()
            .for_each(|(place, band)| {
                let rows = (place * rows).min(height)..((place + 1) * rows).min(height);
                band.found.clear();
                band.found.reserve((rows.len() + 1) * width);
                for y in rows {
                    band.walk_row(shifts, validity, y);
                }
            });
        let all = self
            .bands
            .iter()
            .map(|band| band.found.len())
            .sum::<usize>();
        (all > 0).then(|| f64::from(self.nth(all * 9 / 10)))
    }

    /// The number that so many of those found are not above. They are not negative, so their bits are in
    /// their own order: the leading ones are counted, and a selection is left among a few.
    fn nth(&mut self, place: usize) -> f32 {
        const DROPPED: u32 = 20;
        let bin = |value: &f32| (value.to_bits() >> DROPPED) as usize;
        let found = || self.bands.iter().flat_map(|band| &band.found);
        self.counts.clear();
        self.counts.resize(1 << (32 - DROPPED), 0);
        for value in found() {
            self.counts[bin(value)] += 1;
        }
        let (mut below, mut wanted) = (0, 0);
        while below + self.counts[wanted] as usize <= place {
            below += self.counts[wanted] as usize;
            wanted += 1;
        }
        self.near.clear();
        // Room for all of one bin, whatever the next field holds.
        self.near.reserve(found().count());
        self.near
            .extend(found().filter(|value| bin(value) == wanted));
        *self
            .near
            .select_nth_unstable_by(place - below, f32::total_cmp)
            .1
    }
}

impl Band {
    /// Adds what is found in one row.
    fn walk_row(
        &mut self,
        shifts: ArrayView2<'_, f32>,
        validity: ArrayView2<'_, Validity>,
        y: usize,
    ) {
        let (height, width) = shifts.dim();
        let padded = width + 2 * REACH;
        for (plane, nothing) in [
            (&mut self.least, f32::INFINITY),
            (&mut self.most, f32::NEG_INFINITY),
        ] {
            plane.clear();
            plane.resize(padded, nothing);
        }
        let row = |y: usize| match (shifts.row(y).to_slice(), validity.row(y).to_slice()) {
            (Some(shifts), Some(validity)) => (shifts, validity),
            _ => unreachable!("fields are kept in row-major order"),
        };
        let first = if y < REACH { y % 2 } else { y - REACH };
        for y in (first..(y + REACH + 1).min(height)).step_by(2) {
            Arch::new().dispatch(Widen {
                least: &mut self.least[REACH..][..width],
                most: &mut self.most[REACH..][..width],
                row: row(y),
            });
        }
        let (shifts, validity) = row(y);
        self.farthest.resize(width, 0.0);
        Arch::new().dispatch(Farthest {
            least: &self.least,
            most: &self.most,
            shifts,
            farthest: &mut self.farthest,
        });
        // Every number is written, and those of no answer written over.
        let mut count = self.found.len();
        self.found.resize(count + width, 0.0);
        for (farthest, validity) in self.farthest.iter().zip(validity) {
            self.found[count] = *farthest;
            count += usize::from(*validity == Validity::Valid);
        }
        self.found.truncate(count);
    }
}

/// The smallest and the largest valid shift of each column, and a row that may hold others.
struct Widen<'a> {
    least: &'a mut [f32],
    most: &'a mut [f32],
    row: (&'a [f32], &'a [Validity]),
}

impl NullaryFnOnce for Widen<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let (shifts, validity) = self.row;
        let width = shifts.len();
        let (least, most) = (&mut self.least[..width], &mut self.most[..width]);
        let validity = &validity[..width];
        for x in 0..width {
            let heard = validity[x] == Validity::Valid;
            let low = if heard { shifts[x] } else { f32::INFINITY };
            let high = if heard { shifts[x] } else { f32::NEG_INFINITY };
            least[x] = if low < least[x] { low } else { least[x] };
            most[x] = if high > most[x] { high } else { most[x] };
        }
    }
}

/// How far each shift of a row is from the farthest of its neighbours.
struct Farthest<'a> {
    least: &'a [f32],
    most: &'a [f32],
    shifts: &'a [f32],
    farthest: &'a mut [f32],
}

impl NullaryFnOnce for Farthest<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let width = self.shifts.len();
        let (least, most) = (
            &self.least[..width + 2 * REACH],
            &self.most[..width + 2 * REACH],
        );
        let farthest = &mut self.farthest[..width];
        for x in 0..width {
            let (mut low, mut high) = (least[x], most[x]);
            for neighbour in (2..=2 * REACH).step_by(2) {
                let (other_low, other_high) = (least[x + neighbour], most[x + neighbour]);
                low = if other_low < low { other_low } else { low };
                high = if other_high > high { other_high } else { high };
            }
            let (up, down) = (high - self.shifts[x], self.shifts[x] - low);
            farthest[x] = if up > down { up } else { down };
        }
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;
    use proptest::prelude::*;

    use super::*;
    use crate::scatter;

    proptest! {
        /// The numbers are those that every neighbour is asked for, in one room for fields of any size.
        #[test]
        fn the_farthest_neighbour_is_the_largest_or_the_smallest(
            sizes in prop::collection::vec((1usize..24, 1usize..24), 1..4),
            seed: u64,
            threads in 1usize..4,
        ) {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let mut state = seed | 1;
            let mut next = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (state >> 40) as f32 / (1u64 << 24) as f32
            };
            let mut room = Neighbours::default();
            for size in sizes {
                let mut plane = || Array2::from_shape_fn(size, |_| 20.0 * next() - 10.0);
                let (dx, dy) = (plane(), plane());
                let validity = Array2::from_shape_fn(size, |_| {
                    if next() < 0.7 { Validity::Valid } else { Validity::Occluded }
                });
                let field = DisparityField::new(dx, dy, Array2::ones(size), validity).unwrap();
                let scatter = scatter(&field);
                for component in [|s: &(f32, f32)| s.0, |s: &(f32, f32)| s.1] {
                    let mut all: Vec<f32> = scatter.iter().flatten().map(component).collect();
                    all.sort_by(f32::total_cmp);
                    let want = all.get(all.len() * 9 / 10).map(|&px| f64::from(px));
                    let plane = if component(&(1.0, 0.0)) > 0.0 { field.dx() } else { field.dy() };
                    let found = pool.install(|| room.ninetieth(plane, field.validity()));
                    prop_assert_eq!(found, want);
                }
            }
        }
    }
}
