use ndarray::{Array2, ArrayView2, Zip};

use crate::Validity;

/// What is known of each pixel's answer besides the answer. All planes are `[[y, x]]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Evidence<'a> {
    pub(crate) validity: ArrayView2<'a, Validity>,
    /// Agreement of the phases, from -1 to 1.
    pub(crate) coherence: ArrayView2<'a, f32>,
    /// How much more the second shift costs.
    pub(crate) margin: ArrayView2<'a, i16>,
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
    let mut confidence = Array2::zeros(evidence.margin.dim());
    Zip::indexed(&mut confidence).par_for_each(|place, confidence| {
        let found = f32::from(u8::from(evidence.validity[place].is_valid()));
        let margin = (f32::from(evidence.margin[place]) / usual).min(1.0);
        let edge = (0.5 * (evidence.range[place] - 1.0)).clamp(0.0, 1.0);
        let torn = f32::from(u8::from(evidence.moved[place] > 1.0));
        let coherence = evidence.coherence[place].clamp(0.0, 1.0);
        let sum = found + 0.5 * coherence + 0.5 * margin - 0.25 * edge - 0.3 * torn;
        *confidence = ((sum - LEAST) / SPAN).clamp(0.0, 1.0);
    });
    confidence
}

/// The median margin of the image, at least 1.
fn median_margin(margin: ArrayView2<'_, i16>) -> f32 {
    let mut margins: Vec<i16> = margin.iter().copied().collect();
    let middle = margins.len() / 2;
    let (_, median, _) = margins.select_nth_unstable(middle);
    f32::from(*median).max(1.0)
}
