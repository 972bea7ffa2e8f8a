use ndarray::{Array2, ArrayView2, Zip};

use crate::Validity;

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
    /// How far the surface cells moved the shift, in pixels.
    pub(crate) moved: ArrayView2<'a, f32>,
}

/// How sure each answer is, from 0 to 1: the look back says most, then how well the phases agree and
/// how clearly the shift won; at the ends of surfaces and where the plane disagreed it is less.
pub(crate) fn confidence(evidence: Evidence<'_>) -> Array2<f32> {
    /// The sum of everything that speaks against, and of everything together.
    const LEAST: f32 = -0.55;
    const SPAN: f32 = 2.0 - LEAST;
    let usual = 1.0 / median_margin(evidence.margin);
    let Evidence {
        validity,
        coherence,
        margin,
        range,
        moved,
    } = evidence;
    // Five planes and what is made of them: one row at a time stays in the cache.
    let mut sure = Array2::zeros(validity.dim());
    let rows = validity.rows().into_iter().zip(coherence.rows());
    let rows = rows
        .zip(margin.rows())
        .zip(range.rows().into_iter().zip(moved.rows()));
    for (mut sure, (((validity, coherence), margin), (range, moved))) in
        sure.rows_mut().into_iter().zip(rows)
    {
        Zip::from(&mut sure)
            .and(validity)
            .and(coherence)
            .and(margin)
            .for_each(|sure, validity, coherence, margin| {
                let found = f32::from(u8::from(validity.is_valid()));
                let margin = (f32::from(*margin) * usual).min(1.0);
                *sure = found + 0.5 * coherence.clamp(0.0, 1.0) + 0.5 * margin;
            });
        Zip::from(&mut sure)
            .and(range)
            .and(moved)
            .for_each(|sure, range, moved| {
                let edge = (0.5 * (range - 1.0)).clamp(0.0, 1.0);
                let torn = f32::from(u8::from(*moved > 1.0));
                let sum = *sure - 0.25 * edge - 0.3 * torn;
                *sure = ((sum - LEAST) * (1.0 / SPAN)).clamp(0.0, 1.0);
            });
    }
    sure
}

/// The median margin of the image, at least 1.
fn median_margin(margin: ArrayView2<'_, u8>) -> f32 {
    let mut counts = [0; 256];
    for margin in margin {
        counts[usize::from(*margin)] += 1;
    }
    let mut below = 0;
    let median = counts.iter().position(|count| {
        below += count;
        below > margin.len() / 2
    });
    median.map_or(1.0, |median| median.max(1) as f32)
}
