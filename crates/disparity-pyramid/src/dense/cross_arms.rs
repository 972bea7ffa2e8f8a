use std::ops::Range;

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

/// How far the surface of each pixel goes on by its colour: the arms of a cross.
///
/// All horizontal arms of the pixels on the vertical arm of one pixel are the region that shares its
/// surface.
#[derive(Debug)]
pub(crate) struct CrossArms {
    width: usize,
    /// Pixels to the left and right of each pixel, above and below it, row-major.
    left: Vec<u8>,
    right: Vec<u8>,
    up: Vec<u8>,
    down: Vec<u8>,
}

impl CrossArms {
    pub(crate) fn of(guide: &Guide) -> Self {
        Self {
            width: guide.width(),
            left: arms(guide, Way::Left),
            right: arms(guide, Way::Right),
            up: arms(guide, Way::Up),
            down: arms(guide, Way::Down),
        }
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

/// The length of every pixel's arm one way, row-major.
fn arms(guide: &Guide, way: Way) -> Vec<u8> {
    let (width, height) = (guide.width(), guide.height());
    let mut plane = vec![0; width * height];
    plane.par_chunks_mut(width).enumerate().for_each_init(
        || vec![1; width],
        |goes_on, (y, reach)| {
            goes_on.fill(1);
            let row = y * width;
            for step in 1..=LONGEST {
                // The first pixel that takes this step, where it leads, and the steps from there
                // back towards it.
                let (first, there, between) = match way {
                    Way::Left if step < width => (step, row, guide.beside(y)),
                    Way::Right if step < width => (0, row + step, &guide.beside(y)[step - 1..]),
                    Way::Up if step <= y => (0, row - step * width, guide.below(y - step)),
                    Way::Down if y + step < height => {
                        (0, row + step * width, guide.below(y + step - 1))
                    }
                    _ => break,
                };
                let length = match way {
                    Way::Left | Way::Right => width - step,
                    Way::Up | Way::Down => width,
                };
                let taken = first..first + length;
                let colours = |channel: usize| {
                    let plane = guide.plane(channel);
                    (&plane[row + first..][..length], &plane[there..][..length])
                };
                let limit = if step <= NEAR { NEAR_STEP } else { FAR_STEP };
                let longer = Longer {
                    between: &between[..length],
                    limit,
                    goes_on: &mut goes_on[taken.clone()],
                    reach: &mut reach[taken],
                };
                if guide.channels() == 1 {
                    Arch::new().dispatch(Step(longer, [colours(0)]));
                } else {
                    Arch::new().dispatch(Step(longer, [0, 1, 2].map(colours)));
                }
            }
        },
    );
    plane
}

/// A row of arms that are to become longer by a pixel, as far as the surface goes on.
struct Longer<'a> {
    /// How far the colours there lie from those of the pixels before, in 8 bits.
    between: &'a [u8],
    /// Colour steps from here on end an arm.
    limit: u8,
    /// 1 for each arm that has not ended.
    goes_on: &'a mut [u8],
    reach: &'a mut [u8],
}

/// With the colours of each pixel and of the one that its arm would reach, channel by channel.
struct Step<'a, const CHANNELS: usize>(Longer<'a>, [(&'a [u8], &'a [u8]); CHANNELS]);

impl<const CHANNELS: usize> NullaryFnOnce for Step<'_, CHANNELS> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Self(longer, colours) = self;
        let length = longer.reach.len();
        let (between, reach) = (&longer.between[..length], &mut longer.reach[..length]);
        let goes_on = &mut longer.goes_on[..length];
        // The mean of the channels is below the limit where their sum is below as many limits.
        let most = u16::from(longer.limit) * CHANNELS as u16;
        for i in 0..length {
            let mut sum = 0;
            for (here, there) in colours {
                sum += u16::from(here[i].abs_diff(there[i]));
            }
            let same = u8::from(sum < most) & u8::from(between[i] < longer.limit);
            goes_on[i] &= same;
            reach[i] += goes_on[i];
        }
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;
    use proptest::prelude::*;
    use v1_gabor::LumaImage;

    use super::*;
    use crate::dense::eye_view::EyeView;

    /// How many steps an arm takes from `here`, of at most `most`, step by step.
    fn arm(guide: &Guide, here: usize, most: usize, place: impl Fn(usize) -> usize) -> usize {
        (1..=most.min(LONGEST))
            .find(|&step| {
                let there = place(step);
                let limit = if step <= NEAR { NEAR_STEP } else { FAR_STEP };
                guide.step(here, there) >= limit || guide.step(place(step - 1), there) >= limit
            })
            .map_or(most.min(LONGEST), |step| step - 1)
    }

    proptest! {
        /// Rows of arms grow as single ones do.
        #[test]
        fn arms_agree(width in 1usize..50, height in 1usize..30, colour: bool, seed: u64) {
            let mut state = seed | 1;
            let mut random = |below: u64| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 20) % below
            };
            let luma = Array2::from_shape_simple_fn((height, width), || random(23) as f32 / 255.0);
            let luma = LumaImage::new(luma).unwrap();
            let rgb = Array2::from_shape_simple_fn((height, width), || [(); 3].map(|()| random(23) as u8));
            let view = EyeView { luma: &luma, rgb: Some(rgb.view()) };
            let mut guide = Guide::default();
            guide.take_in(&view, colour, 1.0);
            let arms = CrossArms::of(&guide);
            for y in 0..height {
                for x in 0..width {
                    let here = y * width + x;
                    prop_assert_eq!(usize::from(arms.left[here]), arm(&guide, here, x, |s| here - s));
                    let most = width - 1 - x;
                    prop_assert_eq!(usize::from(arms.right[here]), arm(&guide, here, most, |s| here + s));
                    let up = arm(&guide, here, y, |s| here - s * width);
                    prop_assert_eq!(usize::from(arms.up[here]), up);
                    let down = arm(&guide, here, height - 1 - y, |s| here + s * width);
                    prop_assert_eq!(usize::from(arms.down[here]), down);
                }
            }
        }
    }
}
