use ndarray::{Array2, s};
use rayon::prelude::*;
use v1_gabor::{Binocular, Responses, V1Responses};

use crate::between::between;

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
pub(crate) const LONGEST_SIDE: usize = 96;

/// Shifts are searched to so much of the longer side either way along x, and of the shorter along y.
const REACH_X: f32 = 0.5;
const REACH_Y: f32 = 0.1;

/// Scales that vote together.
const POOLED_SCALES: usize = 3;

/// Half-width of the windows that are compared, in coarse pixels.
const RADIUS: usize = 6;

/// Least mean cosine of the phase differences in a window for a match.
const LEAST_AGREEMENT: f32 = 0.6;

/// How much less than the best a window may agree and still vote: what half a coarse pixel between
/// the true shift and the nearest that is tried costs.
const SLACK: f32 = 0.15;

/// Starts that share the votes, at most.
const MOST_STARTS: usize = 6;

/// How far the votes lie that belong to one start, px: what five scales reach.
const NEAR_PX: f32 = 24.0;

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

    /// Looks for the start of a pair: the middle of the votes of [`CoarseVotes`]; `None` if hardly
    /// anything is found from both eyes.
    #[must_use]
    pub fn find(eyes: &Binocular<V1Responses>) -> Option<Self> {
        Some(CoarseVotes::count(eyes)?.middle())
    }
}

/// What a coarse look finds, shift by shift: every shift of a coarse scale is tried everywhere, and the
/// windows vote that choose each other from both eyes. Within a pattern that repeats several choose
/// each other as well as the best do; all of these vote.
///
/// A coarse-to-fine search finds what its coarsest scale can tell: a phase, half a period either way.
/// Here the cells of all positions vote instead (position shifts, where the pyramid has phase shifts):
/// the agreement of two windows is the mean cosine of the phase differences of all orientations of
/// three scales, each of one weight, so that no strong edge decides alone. Both components are
/// searched, x to half the width either way, y to a tenth of the height.
#[derive(Clone, Debug)]
pub struct CoarseVotes {
    /// The shifts that the coarse pixels vote for, in coarse pixels.
    votes: Vec<(i32, i32)>,
    /// The part of the coarse pixels that vote.
    mutual: f32,
    /// Pixels of the image to a coarse one.
    pixel: f32,
}

impl CoarseVotes {
    /// Counts the votes of a pair; `None` if the eyes differ in size or bank, or fewer than two in a
    /// hundred coarse pixels vote.
    #[must_use]
    pub fn count(eyes: &Binocular<V1Responses>) -> Option<Self> {
        Self::count_coarser(eyes, 0)
    }

    /// The same of responses whose first scale is not the image's finest but the one after so many
    /// `halvings`; that one must not be the scale that is searched.
    pub(crate) fn count_coarser(eyes: &Binocular<V1Responses>, halvings: usize) -> Option<Self> {
        let small = |scale: &Responses| scale.size().width.max(scale.size().height) <= LONGEST_SIDE;
        let scales = eyes.left.scales();
        let scale = scales.iter().position(small).unwrap_or(scales.len() - 1);
        if eyes.left.size() != eyes.right.size() || eyes.left.params() != eyes.right.params() {
            return None;
        }
        let eyes = eyes.as_ref().map(|eye| Phases::of(eye, scale));
        let (votes, voters) = mutual_matches(&eyes.left, &eyes.right);
        let mutual = voters as f32 / (eyes.left.width * eyes.left.height) as f32;
        let pixel = 2f32.powi((halvings + scale) as i32);
        (mutual >= LEAST_MUTUAL).then_some(Self {
            votes,
            mutual,
            pixel,
        })
    }

    /// The start in the middle of all votes, which reaches nine tenths of them.
    #[must_use]
    pub fn middle(&self) -> Start {
        let (dx, dy): (Vec<i32>, Vec<i32>) = self.votes.iter().copied().unzip();
        let ((dx, reach_x), (dy, reach_y)) = (middle(dx), middle(dy));
        Start {
            shift_px: (dx * self.pixel, dy * self.pixel),
            reach_px: (reach_x.max(reach_y) + 0.5) * self.pixel,
            mutual: self.mutual,
        }
    }

    /// Starts that share the votes among them: the shift with the most votes within 24 px, then the
    /// one with the most of those that are left, until all but a twentieth have a start; six at most.
    ///
    /// A start that reaches far needs coarse scales, and there a large step of depth, or a pattern that
    /// repeats, misleads a search. From each of these, five scales are enough, and
    /// [`most_consistent`](crate::most_consistent) takes each place's field.
    #[must_use]
    pub fn starts(&self) -> Vec<Start> {
        let near = (NEAR_PX / self.pixel).round() as i32;
        let mut left = self.votes.clone();
        let enough = left.len() / 20;
        let mut starts = Vec::new();
        while left.len() > enough && starts.len() < MOST_STARTS {
            let (dx, dy) = strongest(&left, near);
            left.retain(|&(x, y)| (x - dx).abs() > near || (y - dy).abs() > near);
            starts.push(Start {
                shift_px: (dx as f32 * self.pixel, dy as f32 * self.pixel),
                reach_px: NEAR_PX,
                mutual: self.mutual,
            });
        }
        starts
    }
}

/// The shift with the most votes within `near` coarse pixels in both components; the first one of
/// several.
fn strongest(votes: &[(i32, i32)], near: i32) -> (i32, i32) {
    let mut shifts = votes.to_vec();
    shifts.sort_unstable();
    shifts.dedup();
    let count = |&(dx, dy): &(i32, i32)| {
        let close = |&&(x, y): &&(i32, i32)| (x - dx).abs() <= near && (y - dy).abs() <= near;
        votes.iter().filter(close).count()
    };
    // The first of the largest: `max_by_key` would give the last.
    let best = shifts.iter().rev().max_by_key(|shift| count(shift));
    best.copied().unwrap_or_default()
}

/// The middle of the 5th and the 95th percentile, and how far they lie from it.
fn middle(mut shifts: Vec<i32>) -> (f32, f32) {
    shifts.sort_unstable();
    let last = shifts.len() - 1;
    let low = shifts[last / 20] as f32;
    let high = shifts[last - last / 20] as f32;
    (0.5 * (low + high), 0.5 * (high - low))
}

/// Responses of length one on the grid of one scale, by scale and orientation: that scale's and those
/// of coarser ones between their pixels. Zero where there is hardly any.
///
/// A pattern that repeats looks the same after a period at one scale, and not at the next: pooling
/// over scales is what tells the periods apart.
struct Phases {
    /// `[[y, x]]` of two numbers for each channel, even and odd, channels innermost.
    units: Vec<f32>,
    width: usize,
    height: usize,
    channels: usize,
}

impl Phases {
    fn of(eye: &V1Responses, scale: usize) -> Self {
        /// A twentieth of a grey level in 256, squared: below it, a phase is noise.
        const SILENCE: f32 = 4e-8;
        let waves = eye.params().wave_vectors();
        let size = eye.scales()[scale].size();
        let pooled = eye.scales().iter().skip(scale).take(POOLED_SCALES);
        let mut units = Vec::new();
        for y in 0..size.height {
            for x in 0..size.width {
                for (coarser, responses) in pooled.clone().enumerate() {
                    let shrink = 0.5f32.powi(coarser as i32);
                    let coarse = responses.size();
                    // The last fine pixel may lie half a pixel beyond the last coarse one.
                    let at =
                        |fine: usize, side: usize| (fine as f32 * shrink).min((side - 1) as f32);
                    let (u, v) = (at(x, coarse.width), at(y, coarse.height));
                    let read = between(responses, &waves, u, v);
                    units.extend(read.flat_map(|response| {
                        let unit = response / (response.norm_sqr() + SILENCE).sqrt();
                        [unit.re, unit.im]
                    }));
                }
            }
        }
        Self {
            channels: units.len() / (2 * size.area()),
            units,
            width: size.width,
            height: size.height,
        }
    }

    fn pixel(&self, x: usize, y: usize) -> &[f32] {
        let parts = 2 * self.channels;
        &self.units[(y * self.width + x) * parts..][..parts]
    }
}

/// The sum of products, eight at a time: strictly one after the other would not vectorise.
fn dot(left: &[f32], right: &[f32]) -> f32 {
    let (left, left_rest) = left.as_chunks::<8>();
    let (right, right_rest) = right.as_chunks::<8>();
    let mut sums = [0.0f32; 8];
    for (left, right) in left.iter().zip(right) {
        for i in 0..8 {
            sums[i] += left[i] * right[i];
        }
    }
    let rest: f32 = left_rest.iter().zip(right_rest).map(|(l, r)| l * r).sum();
    sums.iter().sum::<f32>() + rest
}

/// The shifts `(dx, dy)` of all windows that choose each other, and the number of left pixels that
/// choose any.
fn mutual_matches(left: &Phases, right: &Phases) -> (Vec<(i32, i32)>, usize) {
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
    let mut from_left = Array2::from_elem(dim, LEAST_AGREEMENT);
    let mut from_right = from_left.clone();
    for (&shift, plane) in shifts.iter().zip(&planes) {
        for ((y, x), &agreement) in plane.indexed_iter() {
            from_left[[y, x]] = agreement.max(from_left[[y, x]]);
            if let Some(there) = moved((y, x), shift)
                && let Some(best) = from_right.get_mut(there)
            {
                *best = agreement.max(*best);
            }
        }
    }
    let across = 2 * reach_x as usize + 1;
    let mut voted = Array2::from_elem(dim, false);
    let mut votes = Vec::new();
    for (tried, (&shift, plane)) in shifts.iter().zip(&planes).enumerate() {
        let column = tried % across;
        let beside = [
            (column > 0).then(|| tried - 1),
            (column + 1 < across).then(|| tried + 1),
            tried.checked_sub(across),
            Some(tried + across),
        ];
        for ((y, x), &agreement) in plane.indexed_iter() {
            let there = moved((y, x), shift).and_then(|there| from_right.get(there));
            let best = there.map(|&best| best.max(from_left[[y, x]]));
            if agreement <= LEAST_AGREEMENT || best.is_none_or(|best| agreement < best - SLACK) {
                continue;
            }
            // One vote to a peak: the shifts beside it agree nearly as well.
            let mut beside = beside
                .iter()
                .flatten()
                .filter_map(|&other| planes.get(other));
            if beside.all(|other| other[[y, x]] <= agreement) {
                votes.push(shift);
                voted[[y, x]] = true;
            }
        }
    }
    let voters = voted.iter().filter(|&&voted| voted).count();
    (votes, voters)
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
                row.0 += dot(left.pixel(x, y), there) / left.channels as f32;
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
    fn most_votes_win() {
        let votes = [(-9, 0), (-8, 1), (-8, 0), (-1, 0), (0, 0)];
        assert_eq!(strongest(&votes, 1), (-9, 0));
        assert_eq!(strongest(&votes, 0), (-9, 0));
        assert_eq!(strongest(&[(4, 2), (5, 2), (6, 2)], 1), (5, 2));
    }

    #[test]
    fn the_middle_leaves_the_outermost_out() {
        let mut shifts: Vec<i32> = (0..100).collect();
        shifts.extend([-5000, 7000]);
        assert_eq!(middle(shifts), (49.5, 45.5));
        assert_eq!(middle(vec![-7]), (-7.0, 0.0));
    }
}
