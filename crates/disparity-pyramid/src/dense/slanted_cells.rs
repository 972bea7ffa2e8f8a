use ndarray::{Array2, Axis};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::dense::neighbour_planes::{LANES, Lanes, Neighbour, NeighbourPlanes, faded, lanes};

/// Colour difference, in steps of 8 bits, at which a neighbour counts a third.
const COLOUR: f32 = 0.08 * 255.0;

/// Standard deviation of the weight by distance, in pixels.
pub(crate) const DISTANCE_PX: f32 = 6.5;

/// How far a neighbour's shift may lie from the pixel's own at no distance, in pixels, and how much
/// of that is added for each pixel of distance: what a slanted surface does.
const NEAR_PX: f32 = 0.7;
const SLANT: f32 = 0.15;

/// Weight of no slant against the neighbours' word, so that a fit to a line or a point has a
/// solution.
const RIDGE: f32 = 1e-3;

/// Trusts and weights that sum up to less than this say nothing.
const LEAST_SUM: f32 = 1e-6;

/// The most that a fit may move a shift, in pixels.
const MOST_STEP_PX: f32 = 1.4;

/// Replaces each shift by that of the slanted plane that fits best to the neighbours on its surface:
/// near in place, colour and shift, each as far as it is trusted. `planes` hold the shifts as they are;
/// `moved` gets how far each pixel moved, in pixels.
///
/// One fit: a second one with weights by the residuals takes as long again, and what it changes is a
/// hundredth of the mean error.
pub(crate) fn fit_surfaces(
    dx: &mut Array2<f32>,
    planes: &NeighbourPlanes,
    neighbours: &[Neighbour],
    moved: &mut Array2<f32>,
) {
    let width = dx.ncols();
    dx.axis_iter_mut(Axis(0))
        .into_par_iter()
        .zip(moved.axis_iter_mut(Axis(0)).into_par_iter())
        .enumerate()
        .for_each(|(y, (mut dx, mut moved))| {
            for start in (0..width).step_by(LANES) {
                let fitted = Arch::new().dispatch(Cells {
                    planes,
                    neighbours,
                    place: planes.place(start, y),
                });
                let end = (start + LANES).min(width);
                for (x, fitted) in (start..end).zip(fitted) {
                    let step = fitted - dx[x];
                    let takes = step.abs() < MOST_STEP_PX;
                    moved[x] = if takes { step.abs() } else { 0.0 };
                    dx[x] = if takes { fitted } else { dx[x] };
                }
            }
        });
}

/// A few neighbouring pixels of one row, from a place on, and their surface cells.
struct Cells<'a> {
    planes: &'a NeighbourPlanes,
    neighbours: &'a [Neighbour],
    place: usize,
}

impl NullaryFnOnce for Cells<'_> {
    type Output = Lanes;

    /// The shifts of the planes `a + b u + c v` at the pixels themselves, `(u, v)` counted from each.
    #[inline(always)]
    fn call(self) -> Lanes {
        let Self {
            planes,
            neighbours,
            place,
        } = self;
        let own = lanes(&planes.dx, place);
        let zero = [0.0f32; LANES];
        // Sums of w, w u, w v, w u u, w u v, w v v, w d, w d u, w d v, with d from the own shift.
        let (mut s, mut su, mut sv) = (zero, zero, zero);
        let (mut suu, mut suv, mut svv) = (zero, zero, zero);
        let (mut sd, mut sdu, mut sdv) = (zero, zero, zero);
        for neighbour in neighbours {
            let away = neighbour.v * planes.stride().cast_signed() + neighbour.u;
            let there = place.wrapping_add_signed(away);
            let (u, v) = (neighbour.u as f32, neighbour.v as f32);
            let reach = NEAR_PX * (1.0 + SLANT * u.abs().max(v.abs()));
            let colours = planes.colour_steps(place, there);
            let dx = lanes(&planes.dx, there);
            let trust = lanes(&planes.trust, there);
            for i in 0..LANES {
                let d = dx[i] - own[i];
                let weight = neighbour.weight * trust[i] * faded(colours[i] * (1.0 / COLOUR));
                let weight = if d.abs() < reach { weight } else { 0.0 };
                s[i] += weight;
                su[i] += weight * u;
                sv[i] += weight * v;
                suu[i] += weight * (u * u);
                suv[i] += weight * (u * v);
                svv[i] += weight * (v * v);
                sd[i] += weight * d;
                sdu[i] += weight * d * u;
                sdv[i] += weight * d * v;
            }
        }
        let mut fitted = zero;
        for i in 0..LANES {
            // Eliminate a, then solve two by two about the weighted mean.
            let total = s[i].max(f32::MIN_POSITIVE);
            let share = 1.0 / total;
            let (mu, mv, md) = (su[i] * share, sv[i] * share, sd[i] * share);
            let ridge = RIDGE * total;
            let cuu = suu[i] - su[i] * mu + ridge;
            let cuv = suv[i] - su[i] * mv;
            let cvv = svv[i] - sv[i] * mv + ridge;
            let cdu = sdu[i] - sd[i] * mu;
            let cdv = sdv[i] - sd[i] * mv;
            let inverse = 1.0 / (cuu * cvv - cuv * cuv).max(f32::MIN_POSITIVE);
            let b = (cdu * cvv - cdv * cuv) * inverse;
            let c = (cdv * cuu - cdu * cuv) * inverse;
            let a = own[i] + md - b * mu - c * mv;
            // Where nobody is trusted there is no plane.
            fitted[i] = if s[i] > LEAST_SUM { a } else { own[i] };
        }
        fitted
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
    use crate::dense::neighbour_planes::neighbours;

    const RADIUS: usize = 5;

    /// What the fit makes of shifts that are all answers.
    fn fitted(dx: &Array2<f32>, luma: &Array2<f32>) -> (Array2<f32>, Array2<f32>) {
        let luma = LumaImage::new(luma.clone()).unwrap();
        let mut guide = Guide::default();
        guide.take_in(&EyeView::grey(&luma), false, 1.0);
        let validity = Array2::from_elem(dx.dim(), Validity::Valid);
        let mut planes = NeighbourPlanes::default();
        planes.take_in(&guide, &validity, &Array2::ones(dx.dim()), RADIUS);
        planes.take_shifts(dx.view());
        let around = neighbours(RADIUS, (2, false), DISTANCE_PX);
        let (mut found, mut moved) = (dx.clone(), Array2::zeros(dx.dim()));
        fit_surfaces(&mut found, &planes, &around, &mut moved);
        (found, moved)
    }

    /// The twin: one pixel's normal equations in double precision, by a library's solver.
    fn plainly(dx: &Array2<f32>, luma: &Array2<f32>, (x, y): (usize, usize)) -> f64 {
        let (height, width) = dx.dim();
        let own = f64::from(dx[[y, x]]);
        let grey = |y: usize, x: usize| (f64::from(luma[[y, x]]) * 255.0).round();
        let (mut total, mut sums) = (0.0, [[0.0; 4]; 3]);
        for there_y in y.saturating_sub(4)..(y + 5).min(height) {
            for there_x in x.saturating_sub(4)..(x + 5).min(width) {
                let (u, v) = (there_x as f64 - x as f64, there_y as f64 - y as f64);
                if u % 2.0 != 0.0 || v % 2.0 != 0.0 {
                    continue;
                }
                let d = f64::from(dx[[there_y, there_x]]) - own;
                if d.abs() >= 0.7 * (1.0 + 0.15 * u.abs().max(v.abs())) {
                    continue;
                }
                let colour = (grey(y, x) - grey(there_y, there_x)).abs() / (0.08 * 255.0);
                let weight = (-(u * u + v * v) / (2.0 * 6.5 * 6.5)).exp()
                    * (1.0 - colour / 16.0).max(0.0).powi(16);
                total += weight;
                let row = [1.0, u, v, d];
                for i in 0..3 {
                    for j in 0..4 {
                        sums[i][j] += weight * row[i] * row[j];
                    }
                }
            }
        }
        let about = |i: usize, j: usize| sums[i][j] - sums[0][i] * sums[0][j] / total;
        let ridge = |i: usize| about(i, i) + 1e-3 * total;
        let determinant = ridge(1) * ridge(2) - about(1, 2) * about(1, 2);
        let b = (about(1, 3) * ridge(2) - about(2, 3) * about(1, 2)) / determinant;
        let c = (about(2, 3) * ridge(1) - about(1, 3) * about(1, 2)) / determinant;
        own + (sums[0][3] - b * sums[0][1] - c * sums[0][2]) / total
    }

    proptest! {
        /// Side by side and one by one pixels get the same planes.
        #[test]
        fn fast_and_plain_agree(width in 1usize..40, height in 1usize..20, seed: u64) {
            let mut state = seed | 1;
            let mut random = |below: u64| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 20) % below
            };
            let dx = Array2::from_shape_fn((height, width), |(y, x)| {
                let surface = if x + y < 20 { -3.0 } else { -8.0 };
                surface + 0.1 * x as f32 + random(10) as f32 / 20.0
            });
            let luma = Array2::from_shape_simple_fn((height, width), || random(30) as f32 / 255.0);
            let (found, moved) = fitted(&dx, &luma);
            for ((y, x), found) in found.indexed_iter() {
                let plain = plainly(&dx, &luma, (x, y));
                let own = f64::from(dx[[y, x]]);
                let step = (plain - own).abs();
                prop_assert!(step < f64::from(MOST_STEP_PX), "a plane among what is near");
                // Single precision, and sums of products.
                prop_assert!((f64::from(*found) - plain).abs() < 1e-3, "{found}, {plain}");
                prop_assert!((f64::from(moved[[y, x]]) - step).abs() < 1e-3);
            }
        }
    }

    /// A plane stays as it is, and noise on it becomes less.
    #[test]
    fn planes_stay_planes() {
        let plane =
            Array2::from_shape_fn((30, 50), |(y, x)| -12.0 + 0.08 * x as f32 - 0.05 * y as f32);
        let luma = Array2::from_elem((30, 50), 0.5);
        let (found, _) = fitted(&plane, &luma);
        for (found, own) in found.iter().zip(&plane) {
            // The ridge pulls a slant at the image's rim to none, by less than a thousandth.
            assert!((found - own).abs() < 2e-3, "{found}, {own}");
        }
        let noise = |(y, x): (usize, usize)| 0.3 * ((13 * x + 7 * y * y) as f32).sin();
        let noisy = Array2::from_shape_fn((30, 50), |at| plane[at] + noise(at));
        let (found, _) = fitted(&noisy, &luma);
        let error = |dx: &Array2<f32>| (dx - &plane).mapv(|e| e * e).mean().unwrap();
        assert!(error(&found) < 0.3 * error(&noisy));
    }
}
