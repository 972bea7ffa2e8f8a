use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;

use crate::dense::guide::Guide;
use crate::{SearchRange, Validity};

/// Largest difference of shifts within 5 x 5 pixels from which two surfaces meet there, in pixels.
const MEETING_PX: f32 = 2.0;

/// Colour difference of the channel that differs most, in steps of 8 bits, at which a neighbour
/// counts a third.
const COLOUR: f32 = 8.0;

/// Standard deviation of the weight by distance, in pixels.
const DISTANCE_PX: f32 = 7.0;

/// How much a filled neighbour counts against one that is an answer.
const FILLED: f32 = 0.3;

/// How much more support another surface needs than the one that a pixel is on.
const STAY: f32 = 1.6;

/// Bins a pixel, and how many on either side of one are of the same surface.
const BINS: f32 = 2.0;
const SAME: usize = 2;

/// Less than this is no other surface, in pixels.
const LEAST_STEP_PX: f32 = 1.0;

/// Decides anew, where surfaces meet, which of them each pixel is on, and moves it there.
///
/// A filter sees both sides of a depth edge, and the side with more contrast wins a little beyond its
/// end, alike in both eyes, so that no look back finds it. The colour of a single pixel knows better:
/// every shift within `radius` pixels gathers the weights, by colour and distance, of the neighbours
/// that share it, and the pixel goes to the mean of those of the shift with the most support, if that
/// is clearly more than its own. `ranges` tells where surfaces meet. What a pixel moved is written
/// to `moved`, in pixels.
pub(crate) fn choose_surfaces(
    (dx, moved): (&mut Array2<f32>, &mut Array2<f32>),
    validity: ArrayView2<'_, Validity>,
    ranges: ArrayView2<'_, f32>,
    guide: &Guide,
    search: SearchRange,
    radius: usize,
) {
    let before = dx.clone();
    let neighbours = Neighbours {
        dx: before.view(),
        validity,
        guide,
        radius,
        least_dx: search.least_dx() as f32,
        by_colour: std::array::from_fn(|step| (-(step as f32) / COLOUR).exp()),
        by_distance: (0..=radius)
            .map(|away| (-(away.pow(2) as f32) / (2.0 * DISTANCE_PX * DISTANCE_PX)).exp())
            .collect(),
    };
    let bins = (BINS * search.shifts() as f32) as usize + 1;
    dx.axis_iter_mut(Axis(0))
        .into_par_iter()
        .zip(moved.axis_iter_mut(Axis(0)).into_par_iter())
        .enumerate()
        .for_each_init(
            || vec![Bin::default(); bins],
            |bins, (y, (mut dx, mut moved))| {
                for (x, dx) in dx.iter_mut().enumerate() {
                    if ranges[[y, x]] >= MEETING_PX
                        && let Some(chosen) = neighbours.choose((x, y), bins)
                    {
                        moved[x] = (chosen - *dx).abs();
                        *dx = chosen;
                    }
                }
            },
        );
}

/// The neighbours that share a shift: their weight, and the sum of their weighted shifts.
#[derive(Clone, Copy, Debug, Default)]
struct Bin {
    weight: f32,
    shift: f32,
}

/// What pixels are told by.
struct Neighbours<'a> {
    dx: ArrayView2<'a, f32>,
    validity: ArrayView2<'a, Validity>,
    guide: &'a Guide,
    radius: usize,
    least_dx: f32,
    by_colour: [f32; 256],
    /// By the distance along one axis; both together are the product.
    by_distance: Vec<f32>,
}

impl Neighbours<'_> {
    /// The shift of another surface that a pixel rather belongs to, if there is one.
    fn choose(&self, (x, y): (usize, usize), bins: &mut [Bin]) -> Option<f32> {
        let (height, width) = self.dx.dim();
        let rows = y.saturating_sub(self.radius)..(y + self.radius + 1).min(height);
        let columns = x.saturating_sub(self.radius)..(x + self.radius + 1).min(width);
        bins.fill(Bin::default());
        let (mut first, mut last) = (bins.len(), 0);
        for row in rows {
            let by_row = self.by_distance[row.abs_diff(y)];
            for column in columns.clone() {
                let place = [row, column];
                let colour = self.by_colour[self.colour_step((x, y), (column, row))];
                let found = if self.validity[place].is_valid() {
                    1.0
                } else {
                    FILLED
                };
                let weight = by_row * self.by_distance[column.abs_diff(x)] * colour * found;
                let shift = self.dx[place];
                let bin = self.bin(shift, bins.len());
                (first, last) = (first.min(bin), last.max(bin));
                bins[bin].weight += weight;
                bins[bin].shift += weight * shift;
            }
        }
        let shared = |bin: usize| {
            let around = bin.saturating_sub(SAME)..(bin + SAME + 1).min(bins.len());
            bins[around].iter().fold(Bin::default(), |sum, bin| Bin {
                weight: sum.weight + bin.weight,
                shift: sum.shift + bin.shift,
            })
        };
        let own = self.dx[[y, x]];
        let own_support = STAY * shared(self.bin(own, bins.len())).weight;
        let mut most = Bin {
            weight: own_support,
            shift: own * own_support,
        };
        for sum in (first..=last).map(shared) {
            if sum.weight > most.weight {
                most = sum;
            }
        }
        let chosen = most.shift / most.weight.max(f32::MIN_POSITIVE);
        ((chosen - own).abs() > LEAST_STEP_PX).then_some(chosen)
    }

    /// The bin of a shift.
    fn bin(&self, shift: f32, bins: usize) -> usize {
        let place = BINS * (shift - self.least_dx) + 0.5;
        (place.max(0.0) as usize).min(bins - 1)
    }

    /// How far the colours of two pixels lie apart in the channel that differs most.
    fn colour_step(&self, one: (usize, usize), other: (usize, usize)) -> usize {
        let place = |(x, y)| y * self.guide.width() + x;
        let (one, other) = (place(one), place(other));
        let step = |channel| {
            let plane = self.guide.plane(channel);
            plane[one].abs_diff(plane[other])
        };
        let steps = (0..self.guide.channels()).map(step);
        usize::from(steps.max().unwrap_or(0))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use v1_gabor::LumaImage;

    use super::*;
    use crate::dense::eye_view::EyeView;
    use crate::dense::local_range::LocalRange;

    const RADIUS: usize = 9;

    /// What becomes of a field where every pixel is an answer.
    fn chosen(dx: &Array2<f32>, luma: Array2<f32>) -> (Array2<f32>, Array2<f32>) {
        let luma = LumaImage::new(luma).unwrap();
        let mut guide = Guide::default();
        guide.take_in(&EyeView::grey(&luma), false, 1.0);
        let validity = Array2::from_elem(dx.dim(), Validity::Valid);
        let mut ranges = LocalRange::default();
        let ranges = ranges.of(dx.view());
        let (mut found, mut moved) = (dx.clone(), Array2::zeros(dx.dim()));
        let search = SearchRange::new(-31, 0).unwrap();
        choose_surfaces(
            (&mut found, &mut moved),
            validity.view(),
            ranges,
            &guide,
            search,
            RADIUS,
        );
        (found, moved)
    }

    #[test]
    fn a_surface_ends_where_its_colour_does() {
        // The near surface is 20 columns wide in the picture and 22 in the field: the last column of its excess that
        // still sees the end is two away.
        let luma = Array2::from_shape_fn((40, 60), |(_, x)| if x < 20 { 0.8 } else { 0.3 });
        let fattened = Array2::from_shape_fn((40, 60), |(_, x)| if x < 22 { -20.0 } else { -6.0 });
        let (found, moved) = chosen(&fattened, luma);
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
        let (found, _) = chosen(&step, Array2::from_elem((30, 40), 0.5));
        assert_eq!(found, step);
    }

    proptest! {
        /// No pixel leaves what its neighbours say, only other surfaces are gone to, and what lies
        /// on one surface stays.
        #[test]
        fn pixels_go_to_neighbours_surfaces(width in 1usize..40, height in 1usize..30, seed: u64, steps in 1u64..30) {
            let mut state = seed | 1;
            let mut random = |below: u64| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 20) % below
            };
            let dx = Array2::from_shape_simple_fn((height, width), || -(random(steps) as f32));
            let luma = Array2::from_shape_simple_fn((height, width), || random(4) as f32 / 32.0);
            let (found, moved) = chosen(&dx, luma);
            let least = dx.iter().copied().fold(f32::INFINITY, f32::min);
            let most = dx.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            for (place, found) in found.indexed_iter() {
                let step = (found - dx[place]).abs();
                // Means of shifts are rounded.
                prop_assert!(least - 1e-4 <= *found && *found <= most + 1e-4);
                prop_assert_eq!(moved[place], step);
                prop_assert!(step == 0.0 || step > LEAST_STEP_PX);
                prop_assert!(most - least >= MEETING_PX || step == 0.0);
            }
        }
    }
}
