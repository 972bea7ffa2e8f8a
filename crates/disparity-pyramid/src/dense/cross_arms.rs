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

/// How far the surface of each pixel goes on by its colour: the arms of a cross to the left and the
/// right. The arms up and down are measured when they are asked for.
///
/// All horizontal arms of the pixels on the vertical arm of one pixel are the region that shares its
/// surface.
#[derive(Debug)]
pub(crate) struct CrossArms<'a> {
    guide: &'a Guide,
    /// Pixels to the left and to the right of each pixel.
    beside: Vec<(u8, u8)>,
}

impl<'a> CrossArms<'a> {
    pub(crate) fn of(guide: &'a Guide) -> Self {
        let (width, height) = (guide.width(), guide.height());
        let mut beside = vec![(0, 0); width * height];
        beside
            .par_chunks_mut(width)
            .enumerate()
            .for_each(|(y, row)| {
                for (x, arms) in row.iter_mut().enumerate() {
                    let here = y * width + x;
                    let left = arm(guide, here, x, |step| here - step);
                    let right = arm(guide, here, width - 1 - x, |step| here + step);
                    *arms = (left as u8, right as u8);
                }
            });
        Self { guide, beside }
    }

    /// The runs of places, row by row, that share the surface of pixel `(x, y)`.
    pub(crate) fn region(
        &self,
        x: usize,
        y: usize,
    ) -> impl Iterator<Item = std::ops::RangeInclusive<usize>> {
        let width = self.guide.width();
        let here = y * width + x;
        let up = arm(self.guide, here, y, |step| here - step * width);
        let most = self.guide.height() - 1 - y;
        let down = arm(self.guide, here, most, |step| here + step * width);
        (y - up..=y + down).map(move |row| {
            let place = row * width + x;
            let (left, right) = self.beside[place];
            place - usize::from(left)..=place + usize::from(right)
        })
    }
}

/// How many steps an arm takes from `here`, of at most `most`.
fn arm(guide: &Guide, here: usize, most: usize, place: impl Fn(usize) -> usize) -> usize {
    (1..=most.min(LONGEST))
        .find(|&step| {
            let there = place(step);
            let limit = if step <= NEAR { NEAR_STEP } else { FAR_STEP };
            guide.step(here, there) >= limit || guide.step(place(step - 1), there) >= limit
        })
        .map_or(most.min(LONGEST), |step| step - 1)
}
