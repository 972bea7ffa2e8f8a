use ndarray::Array2;
use pulp::{Arch, NullaryFnOnce, Scalar, Simd};
use rayon::prelude::*;

use crate::dense::fitted::numbers;
use crate::dense::neighbour_planes::{
    LANES, Neighbour, NeighbourPlanes, neighbours, sixteenth_power,
};
use crate::rough::Rough;
use crate::vector::{store, vector};

/// Colour difference, in steps of 8 bits, at which a neighbour counts a third.
const COLOUR: f32 = 0.08 * 255.0;

/// Standard deviation of the weight by distance, in pixels.
const DISTANCE_PX: f32 = 6.5;

/// How far a neighbour's shift may lie from the pixel's own at no distance, in pixels, and how much
/// of that is added for each pixel of distance: what a slanted surface does.
const NEAR_PX: f32 = 0.7;
const SLANT: f32 = 0.15;

/// Weight of no slant against the neighbours' word, so that a fit to a line or a point has a
/// solution.
const RIDGE: f32 = 1e-3;

/// Trusts and weights that sum up to less than this say nothing.
const LEAST_SUM: f32 = 1e-6;

/// That of the least sum of trusts at one place, `(RIDGE LEAST_SUM)^2`: less is an error of rounding.
const LEAST_DETERMINANT: f32 = 1e-18;

/// The most that a fit may move a shift, in pixels.
const MOST_STEP_PX: f32 = 1.4;

/// The neighbours of a surface cell, each with the one opposite to it: what both say is added and
/// subtracted once, and enters nine sums in place of eighteen.
#[derive(Clone, Debug)]
pub(crate) struct Cell {
    pairs: Vec<Opposites>,
}

/// A neighbour at `(u, v)` from a pixel and the one at `(-u, -v)`.
#[derive(Clone, Copy, Debug)]
struct Opposites {
    /// Steps in a plane of rows of the pixel's own: columns and rows.
    u: isize,
    v: isize,
    /// `u`, `v` and their products `u u`, `u v`, `v v`.
    place: [f32; 2],
    products: [f32; 3],
    /// How far their shifts may lie from the pixel's own, in pixels.
    reach_px: f32,
    /// The sixteenth root of their weight by distance, and what a step of colour takes off it.
    nearness: f32,
    fading: f32,
}

impl Cell {
    /// The cell of the neighbours within a `radius`, on a grid as [`neighbours`] has it.
    pub(crate) fn new(radius: usize, grid: (usize, bool)) -> Self {
        // Row by row, as they come, the second half is opposite to the first.
        let all = neighbours(radius, grid, DISTANCE_PX);
        let pairs = all[all.len() / 2 + 1..].iter().map(Opposites::of).collect();
        Self { pairs }
    }
}

impl Opposites {
    fn of(neighbour: &Neighbour) -> Self {
        let (u, v) = (neighbour.u as f32, neighbour.v as f32);
        let nearness = neighbour.weight.powf(1.0 / 16.0);
        Self {
            u: neighbour.u,
            v: neighbour.v,
            place: [u, v],
            products: [u * u, u * v, v * v],
            reach_px: NEAR_PX * (1.0 + SLANT * u.abs().max(v.abs())),
            nearness,
            fading: nearness / (16.0 * COLOUR),
        }
    }
}

/// Replaces each shift by that of the slanted plane that fits best to the neighbours on its surface:
/// near in place, colour and shift, each as far as it is trusted. `planes` hold the shifts as they are;
/// `moved` gets how far each pixel moved, in pixels.
///
/// One fit: a second one with weights by the residuals takes as long again, and what it changes is a
/// hundredth of the mean error.
pub(crate) fn fit_surfaces(
    dx: &mut Array2<f32>,
    planes: &NeighbourPlanes,
    cell: &Cell,
    moved: &mut Array2<f32>,
) {
    match &*planes.channels {
        [grey] => fit_rows(dx, planes, [grey], cell, moved),
        [red, green, blue] => fit_rows(dx, planes, [red, green, blue], cell, moved),
        _ => unreachable!("a guide has one channel or three"),
    }
}

/// The same with a number of channels that the compiler knows.
fn fit_rows<const C: usize>(
    dx: &mut Array2<f32>,
    planes: &NeighbourPlanes,
    channels: [&[f32]; C],
    cell: &Cell,
    moved: &mut Array2<f32>,
) {
    let width = dx.ncols();
    numbers(dx)
        .par_chunks_exact_mut(width)
        .zip(numbers(moved).par_chunks_exact_mut(width))
        .enumerate()
        .for_each(|(y, (dx, moved))| {
            let row = CellRow {
                planes,
                channels,
                cell,
                start: planes.place(0, y),
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

/// The surface cells of one row, which begins at a place of the planes.
struct CellRow<'a, const C: usize> {
    planes: &'a NeighbourPlanes,
    channels: [&'a [f32]; C],
    cell: &'a Cell,
    start: usize,
    dx: &'a mut [f32],
    moved: &'a mut [f32],
}

/// One row's work, compiled for one machine.
struct Compiled<'a, S, const C: usize>(CellRow<'a, C>, S);

impl<S: Rough, const C: usize> NullaryFnOnce for Compiled<'_, S, C> {
    type Output = ();

    // Inlined into the function that is compiled for the vector unit; a call would leave it.
    #[inline(always)]
    fn call(self) {
        let Self(row, simd) = self;
        row.walk(simd);
    }
}

impl<const C: usize> CellRow<'_, C> {
    #[inline(always)]
    fn walk<S: Rough>(self, simd: S) {
        let width = self.dx.len();
        let mut fitted = [0.0; LANES];
        for first in (0..width).step_by(LANES) {
            for lane in (0..LANES).step_by(S::F32_LANES) {
                let cells = self.fit_planes(simd, self.start + first + lane);
                store(simd, &mut fitted, lane, cells);
            }
            let end = (first + LANES).min(width);
            let (dx, moved) = (&mut self.dx[first..end], &mut self.moved[first..end]);
            for i in 0..dx.len().min(LANES) {
                let step = (fitted[i] - dx[i]).abs();
                let takes = step < MOST_STEP_PX;
                moved[i] = if takes { step } else { 0.0 };
                dx[i] = if takes { fitted[i] } else { dx[i] };
            }
        }
    }

    /// The shifts at as many pixels as a vector holds, from a place on, by the planes `a + b u + c v` of
    /// their neighbours, `(u, v)` counted from each.
    #[inline(always)]
    fn fit_planes<S: Rough>(&self, simd: S, place: usize) -> S::f32s {
        let splat = |value| simd.splat_f32s(value);
        let sum = |a, b, c| simd.mul_add_e_f32s(a, b, c);
        let less = |a, b, c| simd.negate_mul_add_e_f32s(a, b, c);
        let zero = splat(0.0);
        let planes = self.planes;
        let mut own = Own {
            dx: vector(simd, &planes.dx, place),
            colours: [zero; C],
        };
        for channel in 0..C {
            own.colours[channel] = vector(simd, self.channels[channel], place);
        }
        // Sums of w, w u, w v, w u u, w u v, w v v, w d, w d u, w d v, with d from the own shift: the pixel's
        // own word adds to the first alone.
        let mut s = vector(simd, &planes.trust, place);
        let (mut su, mut sv) = (zero, zero);
        let (mut suu, mut suv, mut svv) = (zero, zero, zero);
        let (mut sd, mut sdu, mut sdv) = (zero, zero, zero);
        for pair in &self.cell.pairs {
            let away = pair.v * planes.stride().cast_signed() + pair.u;
            let (w, wd) = self.word(simd, &own, pair, place.wrapping_add_signed(away));
            let (x, xd) = self.word(simd, &own, pair, place.wrapping_add_signed(-away));
            let [u, v] = pair.place.map(splat);
            let [uu, uv, vv] = pair.products.map(splat);
            let (both, more) = (simd.add_f32s(w, x), simd.sub_f32s(w, x));
            let (both_d, more_d) = (simd.add_f32s(wd, xd), simd.sub_f32s(wd, xd));
            s = simd.add_f32s(s, both);
            su = sum(more, u, su);
            sv = sum(more, v, sv);
            suu = sum(both, uu, suu);
            suv = sum(both, uv, suv);
            svv = sum(both, vv, svv);
            sd = simd.add_f32s(sd, both_d);
            sdu = sum(more_d, u, sdu);
            sdv = sum(more_d, v, sdv);
        }
        // Eliminate a, then solve two by two about the weighted mean.
        let one = splat(1.0);
        let total = simd.max_f32s(s, splat(LEAST_SUM));
        let share = simd.quotient(one, total);
        let [mu, mv, md] = [su, sv, sd].map(|sum| simd.mul_f32s(sum, share));
        let ridge = splat(RIDGE);
        let cuu = sum(ridge, total, less(su, mu, suu));
        let cuv = less(su, mv, suv);
        let cvv = sum(ridge, total, less(sv, mv, svv));
        let cdu = less(sd, mu, sdu);
        let cdv = less(sd, mv, sdv);
        let determinant = less(cuv, cuv, simd.mul_f32s(cuu, cvv));
        let inverse = simd.quotient(one, simd.max_f32s(determinant, splat(LEAST_DETERMINANT)));
        let b = simd.mul_f32s(less(cdv, cuv, simd.mul_f32s(cdu, cvv)), inverse);
        let c = simd.mul_f32s(less(cdu, cuv, simd.mul_f32s(cdv, cuu)), inverse);
        let a = simd.add_f32s(own.dx, less(c, mv, less(b, mu, md)));
        // Where nobody is trusted there is no plane.
        let heard = simd.less_than_f32s(splat(LEAST_SUM), s);
        simd.select_f32s(heard, a, own.dx)
    }

    /// The weights of neighbours, and with them how far their shifts lie from the pixels' own.
    #[inline(always)]
    fn word<S: Rough>(
        &self,
        simd: S,
        own: &Own<S, C>,
        pair: &Opposites,
        there: usize,
    ) -> (S::f32s, S::f32s) {
        let zero = simd.splat_f32s(0.0);
        let mut colours = zero;
        for channel in 0..C {
            let colour = vector(simd, self.channels[channel], there);
            let step = simd.abs_f32s(simd.sub_f32s(colour, own.colours[channel]));
            colours = if channel == 0 {
                step
            } else {
                simd.max_f32s(colours, step)
            };
        }
        let (fading, nearness) = (simd.splat_f32s(pair.fading), simd.splat_f32s(pair.nearness));
        let faded = sixteenth_power(
            simd,
            simd.max_f32s(simd.negate_mul_add_e_f32s(colours, fading, nearness), zero),
        );
        let d = simd.sub_f32s(vector(simd, &self.planes.dx, there), own.dx);
        let near = simd.less_than_f32s(simd.abs_f32s(d), simd.splat_f32s(pair.reach_px));
        let weight = simd.mul_f32s(vector(simd, &self.planes.trust, there), faded);
        let weight = simd.select_f32s(near, weight, zero);
        (weight, simd.mul_f32s(weight, d))
    }
}

/// What the pixels themselves are known by.
struct Own<S: Simd, const C: usize> {
    dx: S::f32s,
    colours: [S::f32s; C],
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use v1_gabor::LumaImage;

    use super::*;
    use crate::Validity;
    use crate::dense::eye_view::EyeView;
    use crate::dense::guide::Guide;

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
        let cell = Cell::new(RADIUS, (2, false));
        let (mut found, mut moved) = (dx.clone(), Array2::zeros(dx.dim()));
        fit_surfaces(&mut found, &planes, &cell, &mut moved);
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
