use ndarray::{Array2, ArrayView2};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;

use crate::Validity;
use crate::dense::fitted::numbers;

/// What is known of each pixel's answer besides the answer. All planes are `[[y, x]]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Evidence<'a> {
    pub(crate) validity: ArrayView2<'a, Validity>,
    /// Agreement of the phases, from -1 to 1.
    pub(crate) coherence: ArrayView2<'a, f32>,
    /// How much more the second shift costs.
    pub(crate) margin: ArrayView2<'a, u8>,
    /// Largest difference of shifts around, in pixels.
    pub(crate) range: ArrayView2<'a, f32>,
    /// How far the surface cells moved the shift, in pixels, if there are any.
    pub(crate) moved: Option<ArrayView2<'a, f32>>,
}

/// How `sure` each answer is, from 0 to 1: the look back says most, then how well the phases agree and
/// how clearly the shift won; at the ends of surfaces and where the plane disagreed it is less.
pub(crate) fn confidence(evidence: Evidence<'_>, sure: &mut Array2<f32>) {
    let usual = 1.0 / median_margin(evidence.margin);
    let width = sure.ncols();
    // Five planes and what is made of them: one row at a time stays in the cache.
    numbers(sure)
        .par_chunks_mut(width)
        .enumerate()
        .for_each(|(y, sure)| {
            Arch::new().dispatch(Row {
                validity: row(&evidence.validity, y),
                coherence: row(&evidence.coherence, y),
                margin: row(&evidence.margin, y),
                range: row(&evidence.range, y),
                moved: evidence.moved.as_ref().map(|moved| row(moved, y)),
                usual,
                sure,
            });
        });
}

/// One row of a plane.
fn row<'a, T>(plane: &ArrayView2<'a, T>, y: usize) -> &'a [T] {
    let Some(numbers) = plane.to_slice() else {
        unreachable!("planes are made in row-major order")
    };
    &numbers[y * plane.ncols()..][..plane.ncols()]
}

/// One row of the [`Evidence`], with the margin that is usual.
struct Row<'a> {
    validity: &'a [Validity],
    coherence: &'a [f32],
    margin: &'a [u8],
    range: &'a [f32],
    moved: Option<&'a [f32]>,
    /// One over it.
    usual: f32,
    sure: &'a mut [f32],
}

impl NullaryFnOnce for Row<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        /// The sum of everything that speaks against, and of everything together.
        const LEAST: f32 = -0.55;
        const SPAN: f32 = 2.0 - LEAST;
        let width = self.sure.len();
        let (validity, coherence) = (&self.validity[..width], &self.coherence[..width]);
        let (margin, range) = (&self.margin[..width], &self.range[..width]);
        for x in 0..width {
            let found = f32::from(u8::from(validity[x].is_valid()));
            let margin = (f32::from(margin[x]) * self.usual).min(1.0);
            let sum = found + 0.5 * coherence[x].clamp(0.0, 1.0) + 0.5 * margin;
            let edge = (0.5 * (range[x] - 1.0)).clamp(0.0, 1.0);
            self.sure[x] = sum - 0.25 * edge;
        }
        if let Some(moved) = self.moved {
            for (sure, moved) in self.sure.iter_mut().zip(moved) {
                *sure -= 0.3 * f32::from(u8::from(*moved > 1.0));
            }
        }
        for sure in &mut *self.sure {
            *sure = ((*sure - LEAST) * (1.0 / SPAN)).clamp(0.0, 1.0);
        }
    }
}

/// The median margin of the image, at least 1.
fn median_margin(margin: ArrayView2<'_, u8>) -> f32 {
    // Neighbours mostly have the same: the second of them need not wait for the first to be counted.
    let mut counts = [[0; 256]; 2];
    for y in 0..margin.nrows() {
        for pair in row(&margin, y).chunks(2) {
            for (counts, margin) in counts.iter_mut().zip(pair) {
                counts[usize::from(*margin)] += 1;
            }
        }
    }
    let half = margin.len() / 2;
    let mut below = 0;
    let median = (0..256usize).position(|margin| {
        below += counts[0][margin] + counts[1][margin];
        below > half
    });
    median.map_or(1.0, |median| median.max(1) as f32)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Rows in vectors and single pixels are equally sure.
        #[test]
        fn fast_and_plain_agree(
            width in 1usize..40, height in 1usize..12, wins in 1u64..200, surfaces: bool, seed: u64,
        ) {
            let mut state = seed | 1;
            let mut random = |below: u64| {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 20) % below
            };
            let dim = (height, width);
            let validity = Array2::from_shape_simple_fn(dim, || match random(3) {
                0 => Validity::Occluded,
                _ => Validity::Valid,
            });
            let coherence = Array2::from_shape_simple_fn(dim, || random(200) as f32 / 100.0 - 1.0);
            let margin = Array2::from_shape_simple_fn(dim, || random(wins) as u8);
            let range = Array2::from_shape_simple_fn(dim, || random(50) as f32 / 10.0);
            let moved = Array2::from_shape_simple_fn(dim, || random(30) as f32 / 16.0);
            let evidence = Evidence {
                validity: validity.view(),
                coherence: coherence.view(),
                margin: margin.view(),
                range: range.view(),
                moved: surfaces.then(|| moved.view()),
            };
            let mut sure = Array2::zeros(dim);
            confidence(evidence, &mut sure);
            let mut margins: Vec<u8> = margin.iter().copied().collect();
            margins.sort_unstable();
            let usual = f64::from(margins[margins.len() / 2].max(1));
            for (at, sure) in sure.indexed_iter() {
                let found = if validity[at].is_valid() { 1.0 } else { 0.0 };
                let agrees = f64::from(coherence[at]).clamp(0.0, 1.0);
                let clear = (f64::from(margin[at]) / usual).min(1.0);
                let edge = ((f64::from(range[at]) - 1.0) / 2.0).clamp(0.0, 1.0);
                let disagreed = if surfaces && moved[at] > 1.0 { 1.0 } else { 0.0 };
                let sum = found + 0.5 * agrees + 0.5 * clear - 0.25 * edge - 0.3 * disagreed;
                let want = (sum + 0.55) / 2.55;
                prop_assert!((f64::from(*sure) - want).abs() < 1e-5, "{sure}, {want}");
            }
        }
    }
}
