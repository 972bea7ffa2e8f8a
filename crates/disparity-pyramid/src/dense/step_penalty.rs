use crate::DenseParams;

/// What a path pays for a change of shift, in the integers of a cost.
#[derive(Clone, Debug)]
pub(crate) struct StepPenalty {
    /// What one unit of cost (see [`DenseParams`]) is.
    pub(crate) unit: u8,
    /// For one pixel of shift.
    pub(crate) small: u8,
    /// For more, by the step of the guide in 8 bits.
    large: [u8; 256],
}

impl StepPenalty {
    /// The most that a pixel costs, in units: opposed in all phases, and a little for rounding.
    pub(crate) const MOST_COST: f32 = 2.1;

    /// `P2(g) = 1.05 P1 + (P2 - 1.05 P1) exp(-g / softness)`: a little dearer than a small step at
    /// an edge of the picture, and the full price where it is smooth.
    ///
    /// The unit is the largest that keeps the dearest step with the dearest cost in a byte, so that
    /// paths are exact in bytes, and no larger than 30: products of bytes hold no more of a cost.
    pub(crate) fn new(params: &DenseParams) -> Self {
        let least = 1.05 * params.small_step;
        let full = params.large_step.max(least);
        let unit = (f32::from(u8::MAX) / (full + Self::MOST_COST))
            .floor()
            .min(30.0);
        let large = std::array::from_fn(|step| {
            let step = step as f32 / 255.0;
            let faded = (-step / params.edge_softness).exp();
            ((least + (full - least) * faded) * unit) as u8
        });
        Self {
            unit: unit as u8,
            small: (params.small_step * unit).round() as u8,
            large,
        }
    }

    #[inline(always)]
    pub(crate) fn large(&self, guide_step: u8) -> u8 {
        self.large[usize::from(guide_step)]
    }
}
