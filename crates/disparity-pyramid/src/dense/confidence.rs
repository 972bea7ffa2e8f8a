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
    let usual = median_margin(evidence.margin);
    let surely = Zip::from(evidence.validity)
        .and(evidence.coherence)
        .and(evidence.margin)
        .map_collect(|validity, coherence, margin| {
            let found = f32::from(u8::from(validity.is_valid()));
            let margin = (f32::from(*margin) / usual).min(1.0);
            found + 0.5 * coherence.clamp(0.0, 1.0) + 0.5 * margin
        });
    Zip::from(&surely)
        .and(evidence.range)
        .and(evidence.moved)
        .map_collect(|surely, range, moved| {
            let edge = (0.5 * (range - 1.0)).clamp(0.0, 1.0);
            let torn = f32::from(u8::from(*moved > 1.0));
            let sum = surely - 0.25 * edge - 0.3 * torn;
            ((sum - LEAST) / SPAN).clamp(0.0, 1.0)
        })
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
