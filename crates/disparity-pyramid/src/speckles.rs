use std::ops::Range;

use ndarray::{Array2, ArrayView2};

use crate::Validity;
use crate::first_false::first_false;

/// The largest difference in shift of two neighbours of one patch, in pixels.
const STEP_PX: f32 = 1.0;

/// Patches of valid pixels whose shifts change by at most a pixel from neighbour to neighbour, put
/// together from runs along the rows, of which there are few. Kept from one field to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Patches {
    runs: Vec<Run>,
    /// Whether each pixel of a row is in the run of the one before it.
    same: Vec<bool>,
}

#[derive(Clone, Copy, Debug)]
struct Run {
    start: u32,
    length: u32,
    /// An earlier run of the patch, or itself if it is the first.
    earlier: u32,
    /// The pixels of the patch, at its first run.
    size: u32,
}

/// Patches that have fewer than `least` pixels are chance: they become inconsistent.
pub(crate) fn reject_speckles(
    dx: ArrayView2<'_, f32>,
    validity: &mut Array2<Validity>,
    least: usize,
    patches: &mut Patches,
) {
    if least < 2 {
        return;
    }
    let (height, width) = dx.dim();
    let (Some(dx), Some(validity)) = (dx.to_slice(), validity.as_slice_mut()) else {
        unreachable!("planes are made in row-major order")
    };
    // As many runs as there can be, so that the next field finds room whatever it holds.
    patches.runs.clear();
    patches.runs.reserve(height * width.div_ceil(2));
    patches.same.resize(width, false);
    let mut above = 0..0;
    for (y, (shifts, validity)) in dx.chunks(width).zip(validity.chunks(width)).enumerate() {
        continues(shifts, validity, &mut patches.same);
        let here = patches.runs.len();
        let mut next = 0;
        while next < width {
            let Some(skipped) = validity[next..].iter().position(|one| one.is_valid()) else {
                break;
            };
            let start = next + skipped;
            let length = first_false(&patches.same[start + 1..]);
            let length = 1 + length.unwrap_or(width - 1 - start);
            patches.begin(y * width + start, length);
            next = start + length;
        }
        let here = here..patches.runs.len();
        patches.join_rows(dx, width, above, here.clone());
        above = here;
    }
    patches.measure();
    for run in 0..patches.runs.len() {
        let first = patches.first(run);
        if (patches.runs[first].size as usize) < least {
            let (start, end) = patches.runs[run].ends();
            validity[start..end].fill(Validity::Inconsistent);
        }
    }
}

/// Whether each pixel of a row is in the run of the one before it.
fn continues(shifts: &[f32], validity: &[Validity], same: &mut [bool]) {
    let pairs = shifts.windows(2).zip(validity.windows(2));
    for (same, (shifts, validity)) in same[1..].iter_mut().zip(pairs) {
        let near = (shifts[1] - shifts[0]).abs() <= STEP_PX;
        *same = near & validity[0].is_valid() & validity[1].is_valid();
    }
}

impl Run {
    /// Its first place, and the one after its last.
    const fn ends(&self) -> (usize, usize) {
        (self.start as usize, (self.start + self.length) as usize)
    }
}

impl Patches {
    fn begin(&mut self, start: usize, length: usize) {
        self.runs.push(Run {
            start: start as u32,
            length: length as u32,
            earlier: self.runs.len() as u32,
            size: 0,
        });
    }

    /// Joins the runs of one row to those of the row above that lie over them, where some pixel's
    /// shift is near the one above it: mostly the first that both have.
    fn join_rows(&mut self, dx: &[f32], width: usize, above: Range<usize>, here: Range<usize>) {
        let mut over = above.start;
        for run in here {
            let (start, end) = self.runs[run].ends();
            while over < above.end && self.runs[over].ends().1 + width <= start {
                over += 1;
            }
            for other in over..above.end {
                let (first, last) = self.runs[other].ends();
                let both = start.max(first + width)..end.min(last + width);
                if both.is_empty() {
                    break;
                }
                let upper = &dx[both.start - width..both.end - width];
                let mut pairs = dx[both].iter().zip(upper);
                if pairs.any(|(one, other)| (one - other).abs() <= STEP_PX) {
                    self.join(run, other);
                }
            }
        }
    }

    /// The first run of a patch. What was looked up is nearer next time.
    fn first(&mut self, mut run: usize) -> usize {
        loop {
            let earlier = self.runs[run].earlier as usize;
            if earlier == run {
                return run;
            }
            self.runs[run].earlier = self.runs[earlier].earlier;
            run = earlier;
        }
    }

    fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.first(one), self.first(other));
        self.runs[one.max(other)].earlier = one.min(other) as u32;
    }

    /// Counts the pixels of each patch.
    fn measure(&mut self) {
        for run in 0..self.runs.len() {
            let (first, length) = (self.first(run), self.runs[run].length);
            self.runs[first].size += length;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The twin of [`reject_speckles`]: patches grow from pixel to pixel. It takes time, but is plain.
    fn reject_by_flood(dx: ArrayView2<'_, f32>, validity: &mut Array2<Validity>, least: usize) {
        if least < 2 {
            return;
        }
        let (height, width) = dx.dim();
        let (Some(dx), Some(validity)) = (dx.as_slice(), validity.as_slice_mut()) else {
            unreachable!("planes are made in row-major order")
        };
        let mut open: Vec<bool> = validity
            .iter()
            .map(|validity| validity.is_valid())
            .collect();
        let mut patch: Vec<usize> = Vec::new();
        for start in 0..width * height {
            if !open[start] {
                continue;
            }
            patch.clear();
            patch.push(start);
            open[start] = false;
            let mut next = 0;
            while let Some(&here) = patch.get(next) {
                next += 1;
                let x = here % width;
                let mut join = |there: usize| {
                    if open[there] && (dx[there] - dx[here]).abs() <= STEP_PX {
                        open[there] = false;
                        patch.push(there);
                    }
                };
                if x > 0 {
                    join(here - 1);
                }
                if x + 1 < width {
                    join(here + 1);
                }
                if here >= width {
                    join(here - width);
                }
                if here + width < width * height {
                    join(here + width);
                }
            }
            if patch.len() < least {
                for &place in &patch {
                    validity[place] = Validity::Inconsistent;
                }
            }
        }
    }

    proptest! {
        #[test]
        fn runs_and_floods_find_the_same_patches(
            width in 1usize..40, height in 1usize..20, least in 0usize..30, seed: u64,
        ) {
            let mut state = seed | 1;
            let mut random = |below: u64| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 20) % below
            };
            let dx = Array2::from_shape_simple_fn((height, width), || random(4) as f32);
            let validity = Array2::from_shape_simple_fn((height, width), || match random(4) {
                0 => Validity::Occluded,
                _ => Validity::Valid,
            });
            let (mut runs, mut floods) = (validity.clone(), validity);
            reject_speckles(dx.view(), &mut runs, least, &mut Patches::default());
            reject_by_flood(dx.view(), &mut floods, least);
            prop_assert_eq!(runs, floods);
        }
    }

    #[test]
    fn small_patches_go_and_large_ones_stay() {
        // A patch of 2 x 2 at another shift, on a surface that slants by half a pixel a column.
        let mut dx = Array2::from_shape_fn((8, 8), |(_, x)| -0.5 * x as f32);
        for place in [[2, 2], [2, 3], [3, 2], [3, 3]] {
            dx[place] -= 9.0;
        }
        let mut validity = Array2::from_elem((8, 8), Validity::Valid);
        validity[[7, 7]] = Validity::Occluded;
        reject_speckles(dx.view(), &mut validity, 5, &mut Patches::default());
        for ((y, x), found) in validity.indexed_iter() {
            let want = match (y, x) {
                (7, 7) => Validity::Occluded,
                (2..4, 2..4) => Validity::Inconsistent,
                _ => Validity::Valid,
            };
            assert_eq!(*found, want, "at ({x}, {y})");
        }
        reject_speckles(dx.view(), &mut validity, 0, &mut Patches::default());
        assert_eq!(validity[[0, 0]], Validity::Valid);
    }
}
