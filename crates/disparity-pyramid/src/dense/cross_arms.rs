use std::ops::Range;

use ndarray::Array2;
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::dense::guide::Guide;

/// Longest arm of a cross, in pixels.
const LONGEST: usize = 17;

/// Colour step, in 8 bits, that still belongs to the surface of the centre, up to [`NEAR`] pixels
/// away and beyond.
const NEAR_STEP: u8 = 20;
const FAR_STEP: u8 = 10;

/// Up to here an arm takes the larger colour step, in pixels.
const NEAR: usize = 8;

/// How far the surfaces of pixels go on by their colour: the arms of crosses.
///
/// All horizontal arms of the pixels on the vertical arm of one pixel are the region that shares its
/// surface.
#[derive(Clone, Debug, Default)]
pub(crate) struct CrossArms {
    width: usize,
    /// Pixels to the left and right of each pixel, above and below it, row-major.
    left: Vec<u8>,
    right: Vec<u8>,
    up: Vec<u8>,
    down: Vec<u8>,
    /// In which blocks of [`LANES`] columns, row by row, somebody asks, and in which arms along the row
    /// are walked for that.
    asking: Vec<bool>,
    walked: Vec<bool>,
}

impl CrossArms {
    /// Takes in how far the surfaces of a guide go on, for the regions of the pixels that are not known
    /// (`known`, `[[y, x]]` of the guide's size): other pixels' regions mean nothing.
    pub(crate) fn take_in(&mut self, guide: &Guide, known: &Array2<bool>) {
        let (width, height) = (guide.width(), guide.height());
        self.width = width;
        let blocks = width.div_ceil(LANES);
        let Some(known) = known.as_slice() else {
            unreachable!("planes are made in row-major order")
        };
        self.asking.clear();
        for row in known.chunks_exact(width) {
            // Without a branch.
            let asks = |block: &[bool]| !block.iter().fold(true, |all, known| all & known);
            self.asking.extend(row.chunks(LANES).map(asks));
        }
        self.walked.clear();
        for y in 0..height {
            let about = y.saturating_sub(LONGEST)..(y + LONGEST + 1).min(height);
            for block in 0..blocks {
                let asks = |y: usize| self.asking[y * blocks + block];
                self.walked.push(about.clone().any(asks));
            }
        }
        arms(guide, Way::Left, &self.walked, &mut self.left);
        arms(guide, Way::Right, &self.walked, &mut self.right);
        arms(guide, Way::Up, &self.asking, &mut self.up);
        arms(guide, Way::Down, &self.asking, &mut self.down);
    }

    /// The runs of places, row by row, that share the surface of pixel `(x, y)`.
    pub(crate) fn region(&self, x: usize, y: usize) -> impl Iterator<Item = Range<usize>> {
        let here = y * self.width + x;
        let (up, down) = (usize::from(self.up[here]), usize::from(self.down[here]));
        (y - up..=y + down).map(move |row| {
            let place = row * self.width + x;
            let (left, right) = (self.left[place], self.right[place]);
            place - usize::from(left)..place + usize::from(right) + 1
        })
    }
}

/// Where an arm of a cross leads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Left,
    Right,
    Up,
    Down,
}

impl Way {
    /// The columns of a row that can take equally many steps.
    fn alike(self, width: usize) -> Range<usize> {
        match self {
            Self::Left => LONGEST.min(width)..width,
            Self::Right => 0..width.saturating_sub(LONGEST),
            Self::Up | Self::Down => 0..width,
        }
    }

    /// How many steps the arm of pixel `(x, y)` can take.
    fn most(self, guide: &Guide, (x, y): (usize, usize)) -> usize {
        let most = match self {
            Self::Left => x,
            Self::Right => guide.width() - 1 - x,
            Self::Up => y,
            Self::Down => guide.height() - 1 - y,
        };
        most.min(LONGEST)
    }

    /// Where `step` leads from pixel `(x, y)` in a plane, and how far the colour changes on the last pixel
    /// of the way and those to the right of it.
    #[inline(always)]
    fn step(self, guide: &Guide, (x, y): (usize, usize), step: usize) -> (usize, &[u8]) {
        let row = y * guide.width();
        match self {
            Self::Left => (row + x - step, &guide.beside(y)[x - step..]),
            Self::Right => (row + x + step, &guide.beside(y)[x + step - 1..]),
            Self::Up => (row - step * guide.width() + x, &guide.below(y - step)[x..]),
            Self::Down => (
                row + step * guide.width() + x,
                &guide.below(y + step - 1)[x..],
            ),
        }
    }
}

/// Pixels whose arms grow side by side.
const LANES: usize = 64;

/// The lengths of arms one way, row-major, in the blocks of [`LANES`] columns where they are `wanted`.
fn arms(guide: &Guide, way: Way, wanted: &[bool], plane: &mut Vec<u8>) {
    let (width, height) = (guide.width(), guide.height());
    plane.resize(width * height, 0);
    let alike = way.alike(width);
    plane
        .par_chunks_mut(width)
        .zip(wanted.par_chunks(width.div_ceil(LANES)))
        .enumerate()
        .for_each(|(y, (reach, wanted))| {
            for (block, _) in wanted.iter().enumerate().filter(|(_, wanted)| **wanted) {
                let columns = block * LANES..((block + 1) * LANES).min(width);
                let mut alone = columns.clone();
                if let Some(last) = alike.end.checked_sub(LANES)
                    && last >= alike.start
                {
                    // As many side by side as there are, some of which may be a neighbouring block's.
                    let x = columns.start.clamp(alike.start, last);
                    grow(guide, way, (x, y), &mut reach[x..x + LANES]);
                    alone = columns.start..x.min(columns.end);
                    for x in (x + LANES).max(columns.start)..columns.end {
                        reach[x] = arm(guide, way, (x, y));
                    }
                }
                for x in alone {
                    reach[x] = arm(guide, way, (x, y));
                }
            }
        });
}

/// The length of one arm.
fn arm(guide: &Guide, way: Way, (x, y): (usize, usize)) -> u8 {
    let here = y * guide.width() + x;
    let channels = guide.channels();
    let goes_on = |step: &usize| {
        let (there, between) = way.step(guide, (x, y), *step);
        let apart = |channel| {
            let plane = guide.plane(channel);
            u16::from(plane[here].abs_diff(plane[there]))
        };
        let sum: u16 = (0..channels).map(apart).sum();
        let limit = limit(*step);
        sum < u16::from(limit) * channels as u16 && between[0] < limit
    };
    (1..=way.most(guide, (x, y))).take_while(goes_on).count() as u8
}

/// The colour step that ends an arm at its step.
#[inline(always)]
const fn limit(step: usize) -> u8 {
    if step <= NEAR { NEAR_STEP } else { FAR_STEP }
}

/// The lengths of the arms of [`LANES`] pixels from `(x, y)` on, which can take equally many steps.
fn grow(guide: &Guide, way: Way, from: (usize, usize), reach: &mut [u8]) {
    if guide.channels() == 1 {
        Arch::new().dispatch(Grow::<1>(guide, way, from, reach));
    } else {
        Arch::new().dispatch(Grow::<3>(guide, way, from, reach));
    }
}

/// As many channels of a guide, a way, the first pixel, and what becomes of the arms.
struct Grow<'a, const CHANNELS: usize>(&'a Guide, Way, (usize, usize), &'a mut [u8]);

impl<const CHANNELS: usize> NullaryFnOnce for Grow<'_, CHANNELS> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self(guide, way, (x, y), reach) = self;
        let here = y * guide.width() + x;
        let mut goes_on = [1u8; LANES];
        let mut grown = [0u8; LANES];
        for step in 1..=way.most(guide, (x, y)) {
            let (there, between) = way.step(guide, (x, y), step);
            let limit = limit(step);
            let between = &between[..LANES];
            for i in 0..LANES {
                goes_on[i] &= u8::from(between[i] < limit);
            }
            if CHANNELS == 1 {
                let plane = guide.plane(0);
                let (own, other) = (&plane[here..][..LANES], &plane[there..][..LANES]);
                for i in 0..LANES {
                    goes_on[i] &= u8::from(own[i].abs_diff(other[i]) < limit);
                }
            } else {
                // The mean of the channels is below the limit where their sum is below as many limits.
                let mut sum = [0u16; LANES];
                for channel in 0..CHANNELS {
                    let plane = guide.plane(channel);
                    let (own, other) = (&plane[here..][..LANES], &plane[there..][..LANES]);
                    for i in 0..LANES {
                        sum[i] += u16::from(own[i].abs_diff(other[i]));
                    }
                }
                for i in 0..LANES {
                    goes_on[i] &= u8::from(sum[i] < u16::from(limit) * CHANNELS as u16);
                }
            }
            let mut any = 0;
            for i in 0..LANES {
                grown[i] += goes_on[i];
                any |= goes_on[i];
            }
            if any == 0 {
                break;
            }
        }
        reach.copy_from_slice(&grown);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use v1_gabor::LumaImage;

    use super::*;
    use crate::dense::eye_view::EyeView;

    /// How many steps an arm takes from `here`, of at most `most`, step by step.
    fn plainly(guide: &Guide, here: usize, most: usize, place: impl Fn(usize) -> usize) -> usize {
        (1..=most.min(17))
            .find(|&step| {
                let there = place(step);
                let limit = if step <= 8 { 20 } else { 10 };
                guide.step(here, there) >= limit || guide.step(place(step - 1), there) >= limit
            })
            .map_or(most.min(17), |step| step - 1)
    }

    proptest! {
        /// Arms side by side grow as single ones do, at the rim and within, wherever somebody asks.
        #[test]
        fn arms_agree(width in 1usize..160, height in 1usize..30, steps in 1u64..24, holes in 1u64..300, colour: bool, seed: u64) {
            let mut state = seed | 1;
            let mut random = |below: u64| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 20) % below
            };
            let luma = Array2::from_shape_simple_fn((height, width), || random(steps) as f32 / 255.0);
            let luma = LumaImage::new(luma).unwrap();
            let rgb = Array2::from_shape_simple_fn((height, width), || [(); 3].map(|()| random(steps) as u8));
            let view = EyeView { luma: &luma, rgb: Some(rgb.view()) };
            let mut guide = Guide::default();
            guide.take_in(&view, colour, 1.0);
            let mut arms = CrossArms::default();
            let known = Array2::from_shape_simple_fn((height, width), || random(holes) > 0);
            arms.take_in(&guide, &known);
            for y in 0..height {
                for x in 0..width {
                    let own = y * width + x;
                    if known[[y, x]] {
                        continue;
                    }
                    let up = plainly(&guide, own, y, |s| own - s * width);
                    prop_assert_eq!(usize::from(arms.up[own]), up);
                    let down = plainly(&guide, own, height - 1 - y, |s| own + s * width);
                    prop_assert_eq!(usize::from(arms.down[own]), down);
                    for here in (own - up * width..=own + down * width).step_by(width) {
                        let left = plainly(&guide, here, x, |s| here - s);
                        prop_assert_eq!(usize::from(arms.left[here]), left);
                        let right = plainly(&guide, here, width - 1 - x, |s| here + s);
                        prop_assert_eq!(usize::from(arms.right[here]), right);
                    }
                }
            }
        }
    }
}
