use ndarray::{Array2, ArrayView2};
use pulp::{Arch, NullaryFnOnce, Scalar, Simd};
use rayon::prelude::*;

use crate::dense::fitted::numbers;
use crate::dense::neighbour_planes::{LANES, Neighbour, NeighbourPlanes, fade};
use crate::rough::Rough;
use crate::vector::{store, vector};

/// Largest difference of shifts within 5 x 5 pixels from which two surfaces meet there, in pixels.
const MEETING_PX: f32 = 2.0;

/// How far from a pixel the surfaces that meet at it are looked for, in pixels.
pub(crate) const MEETING_REACH: usize = 2;

/// Colour difference of the channel that differs most, in steps of 8 bits, at which a neighbour
/// counts a third.
const COLOUR: f32 = 8.0;

/// Standard deviation of the weight by distance, in pixels.
pub(crate) const DISTANCE_PX: f32 = 7.0;

/// How much more support another surface needs than the one that a pixel is on.
const STAY: f32 = 1.25;

/// How far shifts of one surface may lie apart, in pixels.
const SAME_PX: f32 = 1.25;

/// Weights that sum up to less than this have no mean.
const LEAST_SUM: f32 = 1e-30;

/// Less than this is no other surface, in pixels.
const LEAST_STEP_PX: f32 = 1.0;

/// Decides anew, where surfaces meet, which of them each pixel is on, and moves it there.
///
/// A filter sees both sides of a depth edge, and the side with more contrast wins a little beyond its
/// end, alike in both eyes, so that no look back finds it. The colour of a single pixel knows better:
/// its own shift, and the nearest and the farthest of those next to it, gather the weights, by colour,
/// distance and trust, of the `neighbours` that share them. The pixel goes to the mean of those of the
/// one with the most support, if that is clearly more than its own. `ranges` tells where surfaces meet,
/// `planes` hold the shifts as they are. What a pixel moved is written to `moved`, in pixels.
pub(crate) fn choose_surfaces(
    dx: &mut Array2<f32>,
    planes: &NeighbourPlanes,
    neighbours: &[Neighbour],
    ranges: ArrayView2<'_, f32>,
    moved: &mut Array2<f32>,
) {
    let width = dx.ncols();
    let Some(ranges) = ranges.to_slice() else {
        unreachable!("planes are made in row-major order")
    };
    numbers(dx)
        .par_chunks_exact_mut(width)
        .zip(numbers(moved).par_chunks_exact_mut(width))
        .zip(ranges.par_chunks_exact(width))
        .enumerate()
        .for_each(|(y, ((dx, moved), ranges))| {
            let row = ChoiceRow {
                planes,
                neighbours,
                start: planes.place(0, y),
                ranges,
                dx,
                moved,
            };
            match Arch::new() {
                #[cfg(target_arch = "x86_64")]
                Arch::V4(v4) => v4.vectorize(Compiled(row, v4)),
                #[cfg(target_arch = "x86_64")]
                Arch::V3(v3) => v3.vectorize(Compiled(row, v3)),
                _ => Compiled(row, Scalar).call(),
            }
        });
}

/// The pixels of one row, which begins at a place of the planes.
struct ChoiceRow<'a> {
    planes: &'a NeighbourPlanes,
    neighbours: &'a [Neighbour],
    start: usize,
    ranges: &'a [f32],
    dx: &'a mut [f32],
    moved: &'a mut [f32],
}

/// One row's work, compiled for one machine.
struct Compiled<'a, S>(ChoiceRow<'a>, S);

impl<S: Rough> NullaryFnOnce for Compiled<'_, S> {
    type Output = ();

    // Inlined into the function that is compiled for the vector unit; a call would leave it.
    #[inline(always)]
    fn call(self) {
        let Self(row, simd) = self;
        row.walk(simd);
    }
}

impl ChoiceRow<'_> {
    #[inline(always)]
    fn walk<S: Rough>(self, simd: S) {
        let Self {
            planes,
            neighbours,
            start,
            ranges,
            dx,
            moved,
        } = self;
        let width = dx.len();
        let mut chosen = [0.0; LANES];
        for first in (0..width).step_by(S::F32_LANES) {
            let end = (first + S::F32_LANES).min(width);
            let ranges = &ranges[first..end];
            let mut widest = 0.0f32;
            for range in ranges {
                widest = if *range > widest { *range } else { widest };
            }
            if widest < MEETING_PX {
                continue;
            }
            let choice = choose(simd, planes, neighbours, start + first);
            store(simd, &mut chosen, 0, choice);
            let (dx, moved) = (&mut dx[first..end], &mut moved[first..end]);
            for i in 0..ranges.len().min(LANES) {
                let step = (chosen[i] - dx[i]).abs();
                let takes = (ranges[i] >= MEETING_PX) & (step > LEAST_STEP_PX);
                moved[i] = if takes { step } else { moved[i] };
                dx[i] = if takes { chosen[i] } else { dx[i] };
            }
        }
    }
}

/// The weights of those that share a shift, pixel by pixel, and the sums of their weighted shifts.
#[derive(Clone, Copy)]
struct Support<S: Simd> {
    shift: S::f32s,
    weight: S::f32s,
    sum: S::f32s,
}

impl<S: Simd> Support<S> {
    #[inline(always)]
    fn of(simd: S, shift: S::f32s) -> Self {
        let zero = simd.splat_f32s(0.0);
        Self {
            shift,
            weight: zero,
            sum: zero,
        }
    }

    #[inline(always)]
    fn gather(&mut self, simd: S, dx: S::f32s, weight: S::f32s) {
        let apart = simd.abs_f32s(simd.sub_f32s(dx, self.shift));
        let beyond = simd.less_than_f32s(simd.splat_f32s(SAME_PX), apart);
        let weight = simd.select_f32s(beyond, simd.splat_f32s(0.0), weight);
        self.weight = simd.add_f32s(self.weight, weight);
        self.sum = simd.mul_add_e_f32s(weight, dx, self.sum);
    }
}

/// The shifts of the surfaces that as many pixels as a vector holds, from a place on, rather belong to;
/// their own if there is none.
#[inline(always)]
fn choose<S: Rough>(
    simd: S,
    planes: &NeighbourPlanes,
    neighbours: &[Neighbour],
    place: usize,
) -> S::f32s {
    let reach = MEETING_REACH.cast_signed();
    let stride = planes.stride().cast_signed();
    let own = vector(simd, &planes.dx, place);
    let (mut least, mut most) = (own, own);
    for v in -reach..=reach {
        for u in -reach..=reach {
            let there = place.wrapping_add_signed(v * stride + u);
            let dx = vector(simd, &planes.dx, there);
            (least, most) = (simd.min_f32s(least, dx), simd.max_f32s(most, dx));
        }
    }
    let mut stay = Support::of(simd, own);
    let (mut near, mut far) = (Support::of(simd, least), Support::of(simd, most));
    for neighbour in neighbours {
        let there = place.wrapping_add_signed(neighbour.v * stride + neighbour.u);
        let dx = vector(simd, &planes.dx, there);
        let trust = vector(simd, &planes.trust, there);
        let trust = simd.mul_f32s(trust, simd.splat_f32s(neighbour.weight));
        let colours = planes.colour_step(simd, place, there);
        let weight = simd.mul_f32s(trust, fade(simd, colours, 1.0 / COLOUR));
        stay.gather(simd, dx, weight);
        near.gather(simd, dx, weight);
        far.gather(simd, dx, weight);
    }
    let nearer = simd.less_than_f32s(far.weight, near.weight);
    let weight = simd.select_f32s(nearer, near.weight, far.weight);
    let sum = simd.select_f32s(nearer, near.sum, far.sum);
    let mean = simd.quotient(sum, simd.max_f32s(weight, simd.splat_f32s(LEAST_SUM)));
    let held = simd.mul_f32s(simd.splat_f32s(STAY), stay.weight);
    let goes = simd.less_than_f32s(held, weight);
    simd.select_f32s(goes, mean, own)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use v1_gabor::LumaImage;

    use super::*;
    use crate::Validity;
    use crate::dense::eye_view::EyeView;
    use crate::dense::guide::Guide;
    use crate::dense::local_range::LocalRange;
    use crate::dense::neighbour_planes;

    const RADIUS: usize = 9;

    /// What becomes of a field where every pixel is an answer.
    fn chosen(dx: &Array2<f32>, luma: &Array2<f32>) -> (Array2<f32>, Array2<f32>) {
        let luma = LumaImage::new(luma.clone()).unwrap();
        let mut guide = Guide::default();
        guide.take_in(&EyeView::grey(&luma), false, 1.0);
        let validity = Array2::from_elem(dx.dim(), Validity::Valid);
        let mut planes = NeighbourPlanes::default();
        planes.take_in(&guide, &validity, &Array2::ones(dx.dim()), RADIUS);
        planes.take_shifts(dx.view());
        let mut ranges = LocalRange::default();
        let around = neighbour_planes::neighbours(RADIUS, (1, false), DISTANCE_PX);
        let (mut found, mut moved) = (dx.clone(), Array2::zeros(dx.dim()));
        let ranges = ranges.of(dx.view());
        choose_surfaces(&mut found, &planes, &around, ranges.view(), &mut moved);
        (found, moved)
    }

    /// The twin: what one pixel chooses, and by how much weight that was decided, in double precision.
    fn plainly(dx: &Array2<f32>, luma: &Array2<f32>, (x, y): (usize, usize)) -> (f64, f64) {
        let (height, width) = dx.dim();
        let around = |reach: usize| {
            let rows = y.saturating_sub(reach)..(y + reach + 1).min(height);
            let columns = x.saturating_sub(reach)..(x + reach + 1).min(width);
            rows.flat_map(move |y| columns.clone().map(move |x| (x, y)))
        };
        let shift = |(x, y): (usize, usize)| f64::from(dx[[y, x]]);
        let own = shift((x, y));
        let least = around(2).map(shift).fold(f64::INFINITY, f64::min);
        let most = around(2).map(shift).fold(f64::NEG_INFINITY, f64::max);
        let grey = |(x, y): (usize, usize)| (f64::from(luma[[y, x]]) * 255.0).round();
        let support = |of: f64| {
            let (mut weight, mut sum) = (0.0, 0.0);
            for there in around(RADIUS) {
                if (shift(there) - of).abs() > 1.25 {
                    continue;
                }
                let square = there.0.abs_diff(x).pow(2) + there.1.abs_diff(y).pow(2);
                let colour = (grey((x, y)) - grey(there)).abs() / 8.0;
                let its = (-(square as f64) / (2.0 * 49.0)).exp()
                    * (1.0 - colour / 16.0).max(0.0).powi(16);
                weight += its;
                sum += its * shift(there);
            }
            (weight, sum / weight)
        };
        let (stay, (near, far)) = (support(own).0, (support(least), support(most)));
        let other = if near.0 > far.0 { near } else { far };
        let decided = (other.0 / stay - 1.25)
            .abs()
            .min((near.0 / far.0 - 1.0).abs());
        let goes = most - least >= 2.0 && other.0 > 1.25 * stay && (other.1 - own).abs() > 1.0;
        (if goes { other.1 } else { own }, decided)
    }

    #[test]
    fn a_surface_ends_where_its_colour_does() {
        // The near surface is 20 columns wide in the picture and 22 in the field: the last column of its excess that
        // still sees the end is two away.
        let luma = Array2::from_shape_fn((40, 60), |(_, x)| if x < 20 { 0.8 } else { 0.3 });
        let fattened = Array2::from_shape_fn((40, 60), |(_, x)| if x < 22 { -20.0 } else { -6.0 });
        let (found, moved) = chosen(&fattened, &luma);
        for ((y, x), dx) in found.indexed_iter() {
            let want = if x < 20 { -20.0 } else { -6.0 };
            assert!((dx - want).abs() < 1e-4, "{dx} at ({x}, {y})");
            let step = if (20..22).contains(&x) { 14.0 } else { 0.0 };
            assert!((moved[[y, x]] - step).abs() < 1e-4);
        }
    }

    #[test]
    fn what_has_one_colour_keeps_its_edge() {
        let step = Array2::from_shape_fn((30, 40), |(_, x)| if x < 20 { -9.0 } else { -3.0 });
        let (found, _) = chosen(&step, &Array2::from_elem((30, 40), 0.5));
        assert_eq!(found, step);
    }

    proptest! {
        /// Side by side and one by one pixels choose the same surfaces, where no last bit decides.
        #[test]
        fn fast_and_plain_agree(width in 1usize..40, height in 1usize..30, seed: u64, steps in 1u64..30) {
            let mut state = seed | 1;
            let mut random = |below: u64| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 20) % below
            };
            let dx = Array2::from_shape_simple_fn((height, width), || -(random(steps) as f32));
            let luma = Array2::from_shape_simple_fn((height, width), || random(4) as f32 / 32.0);
            let (found, moved) = chosen(&dx, &luma);
            for ((y, x), found) in found.indexed_iter() {
                let own = dx[[y, x]];
                let (plain, decided) = plainly(&dx, &luma, (x, y));
                prop_assert!(
                    (f64::from(*found) - plain).abs() < 1e-3 || decided < 1e-4,
                    "{found}, {plain} at ({x}, {y})"
                );
                prop_assert_eq!(moved[[y, x]], (found - own).abs());
                prop_assert!(*found == own || moved[[y, x]] > LEAST_STEP_PX);
            }
        }
    }
}
