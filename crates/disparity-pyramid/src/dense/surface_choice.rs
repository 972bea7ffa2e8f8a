use ndarray::{Array2, ArrayView2, Axis};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::dense::neighbour_planes::{LANES, Lanes, Neighbour, NeighbourPlanes, faded, lanes};

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
    dx.axis_iter_mut(Axis(0))
        .into_par_iter()
        .zip(moved.axis_iter_mut(Axis(0)).into_par_iter())
        .enumerate()
        .for_each(|(y, (mut dx, mut moved))| {
            let ranges = ranges.row(y);
            for start in (0..width).step_by(LANES) {
                let end = (start + LANES).min(width);
                if (start..end).all(|x| ranges[x] < MEETING_PX) {
                    continue;
                }
                let chosen = Arch::new().dispatch(Choice {
                    planes,
                    neighbours,
                    place: planes.place(start, y),
                });
                for (x, chosen) in (start..end).zip(chosen) {
                    let step = (chosen - dx[x]).abs();
                    if ranges[x] >= MEETING_PX && step > LEAST_STEP_PX {
                        moved[x] = step;
                        dx[x] = chosen;
                    }
                }
            }
        });
}

/// A few neighbouring pixels of one row, from a place on, and the surfaces next to them.
struct Choice<'a> {
    planes: &'a NeighbourPlanes,
    neighbours: &'a [Neighbour],
    place: usize,
}

/// The weights of those that share a shift, pixel by pixel, and the sums of their weighted shifts.
#[derive(Clone, Copy)]
struct Support {
    shift: Lanes,
    weight: Lanes,
    sum: Lanes,
}

impl Support {
    #[inline(always)]
    const fn of(shift: Lanes) -> Self {
        Self {
            shift,
            weight: [0.0; LANES],
            sum: [0.0; LANES],
        }
    }

    #[inline(always)]
    fn gather(&mut self, dx: &Lanes, weight: &Lanes) {
        for i in 0..LANES {
            let shares = (dx[i] - self.shift[i]).abs() <= SAME_PX;
            let weight = if shares { weight[i] } else { 0.0 };
            self.weight[i] += weight;
            self.sum[i] += weight * dx[i];
        }
    }
}

impl NullaryFnOnce for Choice<'_> {
    type Output = Lanes;

    /// The shifts of the surfaces that the pixels rather belong to; their own if there is none.
    #[inline(always)]
    fn call(self) -> Lanes {
        let Self {
            planes,
            neighbours,
            place,
        } = self;
        let reach = MEETING_REACH.cast_signed();
        let stride = planes.stride().cast_signed();
        let own = lanes(&planes.dx, place);
        let (mut least, mut most) = (own, own);
        for v in -reach..=reach {
            for u in -reach..=reach {
                let dx = lanes(&planes.dx, place.wrapping_add_signed(v * stride + u));
                for i in 0..LANES {
                    least[i] = if dx[i] < least[i] { dx[i] } else { least[i] };
                    most[i] = if dx[i] > most[i] { dx[i] } else { most[i] };
                }
            }
        }
        let mut stay = Support::of(own);
        let (mut near, mut far) = (Support::of(least), Support::of(most));
        for neighbour in neighbours {
            let away = neighbour.v * stride + neighbour.u;
            let there = place.wrapping_add_signed(away);
            let dx = lanes(&planes.dx, there);
            let trust = lanes(&planes.trust, there);
            let mut weight = planes.colour_steps(place, there);
            for i in 0..LANES {
                weight[i] = neighbour.weight * trust[i] * faded(weight[i] * (1.0 / COLOUR));
            }
            stay.gather(&dx, &weight);
            near.gather(&dx, &weight);
            far.gather(&dx, &weight);
        }
        let mut chosen = own;
        for i in 0..LANES {
            let nearer = near.weight[i] > far.weight[i];
            let weight = if nearer {
                near.weight[i]
            } else {
                far.weight[i]
            };
            let sum = if nearer { near.sum[i] } else { far.sum[i] };
            let mean = sum / weight.max(f32::MIN_POSITIVE);
            let goes = weight > STAY * stay.weight[i];
            chosen[i] = if goes { mean } else { own[i] };
        }
        chosen
    }
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
        choose_surfaces(&mut found, &planes, &around, ranges, &mut moved);
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
