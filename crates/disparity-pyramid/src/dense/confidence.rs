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
