use ndarray::{Array2, ArrayView2};

use crate::Validity;

/// The largest difference in shift of two neighbours of one patch, in pixels.
const STEP_PX: f32 = 1.0;

/// Patches of valid pixels whose shifts change by at most a pixel from neighbour to neighbour and
/// that have fewer than `least` pixels are chance: they become inconsistent.
///
/// Patches are put together from runs along the rows, of which there are few.
pub(crate) fn reject_speckles(
    dx: ArrayView2<'_, f32>,
    validity: &mut Array2<Validity>,
    least: usize,
) {
    if least < 2 {
        return;
    }
    let width = dx.ncols();
    let (Some(dx), Some(validity)) = (dx.to_slice(), validity.as_slice_mut()) else {
        unreachable!("planes are made in row-major order")
    };
    let mut patches = Patches::default();
    // The run of each pixel of this row and the one above.
    let mut above = vec![NO_RUN; width];
    let mut here = vec![NO_RUN; width];
    let rows = dx.chunks(width).zip(validity.chunks(width));
    let mut shifts_above: &[f32] = &[];
    for (y, (shifts, validity)) in rows.enumerate() {
        let mut run = NO_RUN;
        for (x, place) in here.iter_mut().enumerate() {
            if !validity[x].is_valid() {
                run = NO_RUN;
            } else if run != NO_RUN && (shifts[x] - shifts[x - 1]).abs() <= STEP_PX {
                patches.runs[run].length += 1;
            } else {
                run = patches.begin(y * width + x);
            }
            *place = run;
        }
        // Neighbours mostly join what is joined already.
        let mut joined = (NO_RUN, NO_RUN);
        for (x, above_shift) in shifts_above.iter().enumerate() {
            let pair = (above[x], here[x]);
            if pair.0 != NO_RUN
                && pair.1 != NO_RUN
                && pair != joined
                && (above_shift - shifts[x]).abs() <= STEP_PX
            {
                patches.join(pair.0, pair.1);
                joined = pair;
            }
        }
        std::mem::swap(&mut above, &mut here);
        shifts_above = shifts;
    }
    let sizes = patches.sizes();
    for (run, size) in patches.runs.iter().zip(sizes) {
        if size < least {
            validity[run.start..run.start + run.length].fill(Validity::Inconsistent);
        }
    }
}

/// Stands for the run of a pixel that is in none.
const NO_RUN: usize = usize::MAX;

/// Runs along rows, joined to patches.
#[derive(Debug, Default)]
struct Patches {
    runs: Vec<Run>,
}

#[derive(Debug)]
struct Run {
    start: usize,
    length: usize,
    /// An earlier run of the patch, or itself if it is the first.
    earlier: usize,
}

impl Patches {
    fn begin(&mut self, start: usize) -> usize {
        let earlier = self.runs.len();
        self.runs.push(Run {
            start,
            length: 1,
            earlier,
        });
        earlier
    }

    /// The first run of a patch. What was looked up is nearer next time.
    fn first(&mut self, mut run: usize) -> usize {
        while self.runs[run].earlier != run {
            let earlier = self.runs[run].earlier;
            self.runs[run].earlier = self.runs[earlier].earlier;
            run = earlier;
        }
        run
    }

    fn join(&mut self, one: usize, other: usize) {
        let (one, other) = (self.first(one), self.first(other));
        self.runs[one.max(other)].earlier = one.min(other);
    }

    /// The pixels of each run's patch.
    fn sizes(&mut self) -> Vec<usize> {
        let mut sizes = vec![0; self.runs.len()];
        for run in 0..self.runs.len() {
            let first = self.first(run);
            sizes[first] += self.runs[run].length;
        }
        (0..self.runs.len())
            .map(|run| sizes[self.first(run)])
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The twin of [`reject_speckles`]: patches grow from pixel to pixel. Patches of valid pixels whose shifts change by at most a pixel from neighbour to neighbour and
    /// that have fewer than `least` pixels are chance: they become inconsistent.
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
            reject_speckles(dx.view(), &mut runs, least);
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
        reject_speckles(dx.view(), &mut validity, 5);
        for ((y, x), found) in validity.indexed_iter() {
            let want = match (y, x) {
                (7, 7) => Validity::Occluded,
                (2..4, 2..4) => Validity::Inconsistent,
                _ => Validity::Valid,
            };
            assert_eq!(*found, want, "at ({x}, {y})");
        }
        reject_speckles(dx.view(), &mut validity, 0);
        assert_eq!(validity[[0, 0]], Validity::Valid);
    }
}
