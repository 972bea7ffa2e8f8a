use ndarray::{Array2, s};
use num_complex::Complex32;
use rayon::prelude::*;
use v1_gabor::{Binocular, Responses, V1Responses};

/// Where to start a search of which nothing is known: the middle of the shifts that a coarse look
/// finds, and how far they reach about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// For [`MatchParams::zero_disparity_px`](crate::MatchParams::zero_disparity_px): `(dx, dy)` in
    /// pixels of the image.
    pub shift_px: (f32, f32),
    /// How far from it nine tenths of the shifts lie, px, along the axis where that is farther, with
    /// half a coarse pixel for rounding. N scales find shifts up to about `0.75 * 2^N` px away.
    pub reach_px: f32,
    /// The part of the coarse pixels that found each other from both eyes, from 0 to 1.
    pub mutual: f32,
}

/// The scale that is searched is the finest whose longer side has at most so many pixels.
const LONGEST_SIDE: usize = 96;

/// Shifts are searched to so much of the longer side either way along x, and of the shorter along y.
const REACH_X: f32 = 0.5;
const REACH_Y: f32 = 0.1;

/// Half-width of the windows that are compared, in coarse pixels.
const RADIUS: usize = 4;

/// Least mean cosine of the phase differences in a window for a match.
const LEAST_AGREEMENT: f32 = 0.6;

/// Below this part of mutual pixels there is no start.
const LEAST_MUTUAL: f32 = 0.02;

impl Start {
    /// The fewest scales that reach the shifts about the start.
    #[must_use]
    pub fn scales(&self) -> usize {
        (1..16)
            .find(|&scales| 0.75 * 2f32.powi(scales) >= self.reach_px)
            .unwrap_or(16) as usize
    }

    /// Looks for the start of a pair: every shift of a coarse scale is tried everywhere, and the
    /// windows count that choose each other from both eyes.
    ///
    /// A coarse-to-fine search finds what its coarsest scale can tell: a phase, half a period either
    /// way. Here the cells of all positions vote instead (position shifts, where the pyramid has phase
    /// shifts): the agreement of two windows is the mean cosine of the phase differences of all
    /// orientations, each of one weight, so that no strong edge decides alone. Both components are
    /// searched, x to half the width either way, y to a tenth of the height.
    ///
    /// `None` if the eyes differ in size, or hardly anything is found from both eyes.
    #[must_use]
    pub fn find(eyes: &Binocular<V1Responses>) -> Option<Self> {
        let small = |scale: &Responses| scale.size().width.max(scale.size().height) <= LONGEST_SIDE;
        let scales = eyes.left.scales();
        let scale = scales.iter().position(small).unwrap_or(scales.len() - 1);
        let (left, right) = (&scales[scale], eyes.right.scales().get(scale)?);
        if left.size() != right.size() || left.orientations() != right.orientations() {
            return None;
        }
        let matches = mutual_matches(&Phases::of(left), &Phases::of(right));
        let mutual = matches.len() as f32 / left.size().area() as f32;
        if mutual < LEAST_MUTUAL {
            return None;
        }
        let (dx, dy): (Vec<i32>, Vec<i32>) = matches.into_iter().unzip();
        let ((dx, reach_x), (dy, reach_y)) = (middle(dx), middle(dy));
        let pixel = 2f32.powi(scale as i32);
        Some(Self {
            shift_px: (dx * pixel, dy * pixel),
            reach_px: (reach_x.max(reach_y) + 0.5) * pixel,
            mutual,
        })
    }
}

/// The middle of the 5th and the 95th percentile, and how far they lie from it.
fn middle(mut shifts: Vec<i32>) -> (f32, f32) {
    shifts.sort_unstable();
    let last = shifts.len() - 1;
    let low = shifts[last / 20] as f32;
    let high = shifts[last - last / 20] as f32;
    (0.5 * (low + high), 0.5 * (high - low))
}

/// Responses of length one by orientation, zero where there is hardly any.
struct Phases {
    /// `[[y, x]]` of one number for each orientation, orientations innermost.
    units: Vec<Complex32>,
    width: usize,
    height: usize,
    orientations: usize,
}

impl Phases {
    fn of(responses: &Responses) -> Self {
        /// A twentieth of a grey level in 256, squared: below it, a phase is noise.
        const SILENCE: f32 = 4e-8;
        let size = responses.size();
        let orientations = responses.orientations();
        let mut units = Vec::with_capacity(size.area() * orientations);
        for y in 0..size.height {
            for x in 0..size.width {
                let pixel = responses.pixel(x, y);
                units.extend(pixel.even.iter().zip(pixel.odd).map(|(&even, &odd)| {
                    let response = Complex32::new(even, odd);
                    response / (response.norm_sqr() + SILENCE).sqrt()
                }));
            }
        }
        Self {
            units,
            width: size.width,
            height: size.height,
            orientations,
        }
    }

    fn pixel(&self, x: usize, y: usize) -> &[Complex32] {
        let start = (y * self.width + x) * self.orientations;
        &self.units[start..start + self.orientations]
    }
}

/// The best shift of a window so far.
#[derive(Clone, Copy)]
struct Best {
    agreement: f32,
    shift: Option<(i32, i32)>,
}

impl Best {
    const NONE: Self = Self {
        agreement: LEAST_AGREEMENT,
        shift: None,
    };

    fn hear(&mut self, agreement: f32, shift: (i32, i32)) {
        if agreement > self.agreement {
            *self = Self {
                agreement,
                shift: Some(shift),
            };
        }
    }
}

/// The shifts `(dx, dy)` of all coarse pixels whose windows choose each other from both eyes.
fn mutual_matches(left: &Phases, right: &Phases) -> Vec<(i32, i32)> {
    let reach_x = (REACH_X * left.width.max(left.height) as f32) as i32;
    let reach_y = ((REACH_Y * left.width.min(left.height) as f32) as i32).max(1);
    let shifts: Vec<(i32, i32)> = (-reach_y..=reach_y)
        .flat_map(|dy| (-reach_x..=reach_x).map(move |dx| (dx, dy)))
        .collect();
    let planes: Vec<Array2<f32>> = shifts
        .par_iter()
        .map(|&shift| agreement(left, right, shift))
        .collect();
    let dim = (left.height, left.width);
    let mut from_left = Array2::from_elem(dim, Best::NONE);
    let mut from_right = from_left.clone();
    for (&shift, plane) in shifts.iter().zip(&planes) {
        for ((y, x), &agreement) in plane.indexed_iter() {
            from_left[[y, x]].hear(agreement, shift);
            if let Some(there) = moved((y, x), shift)
                && let Some(best) = from_right.get_mut(there)
            {
                best.hear(agreement, shift);
            }
        }
    }
    from_left
        .indexed_iter()
        .filter_map(|(here, best)| {
            let there = moved(here, best.shift?)?;
            (from_right.get(there)?.shift == best.shift).then_some(best.shift?)
        })
        .collect()
}

/// The pixel `[y, x]` moved by `(dx, dy)`; `None` left of or above the image.
fn moved((y, x): (usize, usize), (dx, dy): (i32, i32)) -> Option<[usize; 2]> {
    Some([
        y.checked_add_signed(dy as isize)?,
        x.checked_add_signed(dx as isize)?,
    ])
}

/// The agreement of the windows about every left pixel with those shifted in the right eye, from -1
/// to 1; -1 where less than half of the window is in view.
fn agreement(left: &Phases, right: &Phases, (dx, dy): (i32, i32)) -> Array2<f32> {
    let (width, height) = (left.width, left.height);
    // Sums over the rectangle above and left of each corner: agreement, and pixels in view.
    let mut sums = Array2::from_elem((height + 1, width + 1), (0.0f32, 0.0f32));
    for y in 0..height {
        let mut row = (0.0, 0.0);
        for x in 0..width {
            let (u, v) = (x as i32 + dx, y as i32 + dy);
            if (0..width as i32).contains(&u) && (0..height as i32).contains(&v) {
                let there = right.pixel(u as usize, v as usize);
                let cosines = left.pixel(x, y).iter().zip(there);
                let sum: f32 = cosines.map(|(l, r)| l.re * r.re + l.im * r.im).sum();
                row.0 += sum / left.orientations as f32;
                row.1 += 1.0;
            }
            let above = sums[[y, x + 1]];
            sums[[y + 1, x + 1]] = (above.0 + row.0, above.1 + row.1);
        }
    }
    Array2::from_shape_fn((height, width), |(y, x)| {
        let (top, bottom) = (y.saturating_sub(RADIUS), (y + RADIUS + 1).min(height));
        let (near, far) = (x.saturating_sub(RADIUS), (x + RADIUS + 1).min(width));
        let corners = sums.slice(s![top..=bottom, near..=far]);
        let (rows, columns) = corners.dim();
        let corner = |y: usize, x: usize| corners[[y, x]];
        let (a, b) = (corner(rows - 1, columns - 1), corner(0, columns - 1));
        let (c, d) = (corner(rows - 1, 0), corner(0, 0));
        let in_view = a.1 - b.1 - c.1 + d.1;
        let window = ((bottom - top) * (far - near)) as f32;
        if in_view * 2.0 < window {
            return -1.0;
        }
        (a.0 - b.0 - c.0 + d.0) / in_view
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_reach_what_was_found() {
        let start = |reach_px| Start {
            shift_px: (0.0, 0.0),
            reach_px,
            mutual: 1.0,
        };
        assert_eq!(start(1.0).scales(), 1);
        assert_eq!(start(48.0).scales(), 6);
        assert_eq!(start(48.1).scales(), 7);
    }

    #[test]
    fn the_middle_leaves_the_outermost_out() {
        let mut shifts: Vec<i32> = (0..100).collect();
        shifts.extend([-5000, 7000]);
        assert_eq!(middle(shifts), (49.5, 45.5));
        assert_eq!(middle(vec![-7]), (-7.0, 0.0));
    }
}
