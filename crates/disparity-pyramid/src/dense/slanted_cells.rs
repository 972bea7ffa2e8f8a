use ndarray::{Array2, ArrayView2, Axis};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::dense::guide::Guide;

/// Pixels that are fitted side by side.
const LANES: usize = 16;

/// Every so many pixels, along rows and columns, a neighbour is asked: a quarter of the time, and
/// neighbours know little that theirs do not.
const STRIDE: usize = 2;

/// Colour difference, in parts of the whole range, at which a neighbour counts a third.
const COLOUR: f32 = 0.08;

/// Standard deviation of the weight by distance, in pixels.
const DISTANCE_PX: f32 = 6.5;

/// How far a neighbour's shift may lie from the pixel's own at no distance, in pixels, and how much
/// of that is added for each pixel of distance: what a slanted surface does.
const NEAR_PX: f32 = 0.7;
const SLANT: f32 = 0.15;

/// Residual at which a neighbour counts half in the second fit, in pixels.
const RESIDUAL_PX: f32 = 0.3;

/// Weight of no slant against the neighbours' word, so that a fit to a line or a point has a
/// solution.
const RIDGE: f32 = 1e-3;

/// The most that a fit may move a shift, in pixels.
const MOST_STEP_PX: f32 = 1.4;

/// Replaces each shift by that of the slanted plane that fits best to the neighbours on its surface,
/// within `radius` pixels: near in place, colour and shift, each with its own `trust`. One fit, one
/// more with the residuals' weights. Returns how far each pixel moved, in pixels.
pub(crate) fn fit_surfaces(
    dx: &mut Array2<f32>,
    trust: ArrayView2<'_, f32>,
    guide: &Guide,
    radius: usize,
) -> Array2<f32> {
    let (height, width) = dx.dim();
    let stride = width.next_multiple_of(LANES) + 2 * radius;
    let pad = |value: &dyn Fn(usize, usize) -> f32| {
        let mut padded = vec![0.0; stride * (height + 2 * radius)];
        for (y, row) in padded
            .chunks_mut(stride)
            .skip(radius)
            .take(height)
            .enumerate()
        {
            for x in 0..width {
                row[radius + x] = value(x, y);
            }
        }
        padded
    };
    let channels: Vec<&[u8]> = (0..guide.channels())
        .map(|channel| guide.plane(channel))
        .collect();
    let planes = Planes {
        stride,
        radius,
        dx: pad(&|x, y| dx[[y, x]]),
        // Nothing lies outside the image, so nobody trusts it.
        trust: pad(&|x, y| trust[[y, x]]),
        channels: channels
            .iter()
            .map(|plane| pad(&|x, y| f32::from(plane[y * width + x]) / (255.0 * COLOUR)))
            .collect(),
    };
    let weights = distance_weights(radius);
    let mut moved = Array2::zeros((height, width));
    dx.axis_iter_mut(Axis(0))
        .into_par_iter()
        .zip(moved.axis_iter_mut(Axis(0)).into_par_iter())
        .enumerate()
        .for_each(|(y, (mut dx, mut moved))| {
            for start in (0..width).step_by(LANES) {
                let fitted = Arch::new().dispatch(Cells {
                    planes: &planes,
                    distances: &weights,
                    start,
                    y,
                });
                let end = (start + LANES).min(width);
                for (x, fitted) in (start..end).zip(fitted) {
                    let step = fitted - dx[x];
                    if step.abs() < MOST_STEP_PX {
                        dx[x] = fitted;
                        moved[x] = step.abs();
                    }
                }
            }
        });
    moved
}

/// Planes with a border of `radius` pixels.
struct Planes {
    stride: usize,
    radius: usize,
    dx: Vec<f32>,
    trust: Vec<f32>,
    /// The guide in units of [`COLOUR`].
    channels: Vec<Vec<f32>>,
}

/// The weights of the neighbours by their distance, row by row.
fn distance_weights(radius: usize) -> Vec<f32> {
    let side = 2 * radius + 1;
    let weight = |place: usize| {
        let (y, x) = (place / side, place % side);
        let square = (x.abs_diff(radius).pow(2) + y.abs_diff(radius).pow(2)) as f32;
        (-square / (2.0 * DISTANCE_PX * DISTANCE_PX)).exp()
    };
    (0..side * side).map(weight).collect()
}

type Lanes = [f32; LANES];

/// A few neighbouring pixels of one row and their surface cells.
struct Cells<'a> {
    planes: &'a Planes,
    distances: &'a [f32],
    start: usize,
    y: usize,
}

/// A plane `a + b u + c v` for each pixel, `(u, v)` counted from it.
#[derive(Clone, Copy)]
struct Plane {
    a: Lanes,
    b: Lanes,
    c: Lanes,
}

impl NullaryFnOnce for Cells<'_> {
    type Output = Lanes;

    #[inline(always)]
    fn call(self) -> Lanes {
        let own = self.own();
        let first = self.fit::<false>(Plane {
            a: own,
            b: [0.0; LANES],
            c: [0.0; LANES],
        });
        self.fit::<true>(first).a
    }
}

impl Cells<'_> {
    #[inline(always)]
    fn own(&self) -> Lanes {
        let Planes { stride, radius, .. } = *self.planes;
        let centre = (self.y + radius) * stride + self.start + radius;
        load(&self.planes.dx, centre)
    }

    /// One weighted fit; with `ROBUST` by the residuals from `plane` too.
    #[inline(always)]
    fn fit<const ROBUST: bool>(&self, plane: Plane) -> Plane {
        let Planes { stride, radius, .. } = *self.planes;
        let side = 2 * radius + 1;
        let corner = self.y * stride + self.start;
        let own = self.own();
        let centre = corner + radius * stride + radius;
        let zero = [0.0f32; LANES];
        // Sums of w, w u, w v, w u u, w u v, w v v, w d, w d u, w d v, with d from the own shift.
        let (mut s, mut su, mut sv) = (zero, zero, zero);
        let (mut suu, mut suv, mut svv) = (zero, zero, zero);
        let (mut sd, mut sdu, mut sdv) = (zero, zero, zero);
        for row in (radius % STRIDE..side).step_by(STRIDE) {
            for column in (radius % STRIDE..side).step_by(STRIDE) {
                let there = corner + row * stride + column;
                let (u, v) = (column as f32 - radius as f32, row as f32 - radius as f32);
                let reach = NEAR_PX * (1.0 + SLANT * u.abs().max(v.abs()));
                let distance = self.distances[row * side + column];
                let mut colour = zero;
                for channel in &self.planes.channels {
                    let (here, there) = (load(channel, centre), load(channel, there));
                    for i in 0..LANES {
                        colour[i] = colour[i].max((here[i] - there[i]).abs());
                    }
                }
                let dx = load(&self.planes.dx, there);
                let trust = load(&self.planes.trust, there);
                for i in 0..LANES {
                    let d = dx[i] - own[i];
                    let mut weight = distance * trust[i] * faded(colour[i]);
                    if ROBUST {
                        let residual = dx[i] - (plane.a[i] + plane.b[i] * u + plane.c[i] * v);
                        let ratio = residual * (1.0 / RESIDUAL_PX);
                        weight /= 1.0 + ratio * ratio;
                    }
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
        }
        let mut fitted = Plane {
            a: zero,
            b: zero,
            c: zero,
        };
        for i in 0..LANES {
            // Eliminate a, then solve two by two about the weighted mean.
            let total = s[i].max(f32::MIN_POSITIVE);
            let (mu, mv, md) = (su[i] / total, sv[i] / total, sd[i] / total);
            let ridge = RIDGE * total;
            let cuu = suu[i] - su[i] * mu + ridge;
            let cuv = suv[i] - su[i] * mv;
            let cvv = svv[i] - sv[i] * mv + ridge;
            let cdu = sdu[i] - sd[i] * mu;
            let cdv = sdv[i] - sd[i] * mv;
            let determinant = (cuu * cvv - cuv * cuv).max(f32::MIN_POSITIVE);
            let b = (cdu * cvv - cdv * cuv) / determinant;
            let c = (cdv * cuu - cdu * cuv) / determinant;
            let a = own[i] + md - b * mu - c * mv;
            // Where nobody is trusted there is no plane.
            let found = s[i] > 1e-6;
            fitted.a[i] = if found { a } else { own[i] };
            fitted.b[i] = if found { b } else { 0.0 };
            fitted.c[i] = if found { c } else { 0.0 };
        }
        fitted
    }
}

#[inline(always)]
fn load(plane: &[f32], start: usize) -> Lanes {
    let mut lanes = [0.0; LANES];
    lanes.copy_from_slice(&plane[start..start + LANES]);
    lanes
}

/// `exp(-t)` for `t >= 0` to 0.02, without a call: `(1 - t / 16)^16`.
#[inline(always)]
fn faded(t: f32) -> f32 {
    let base = (1.0 - t * (1.0 / 16.0)).max(0.0);
    let square = base * base;
    let fourth = square * square;
    let eighth = fourth * fourth;
    eighth * eighth
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn fading_is_nearly_exponential(t in 0.0f32..40.0) {
            prop_assert!((faded(t) - (-t).exp()).abs() < 0.02);
        }
    }
}
