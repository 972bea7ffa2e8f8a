use crate::DenseParams;
use crate::dense::pixel_cost::COST_UNIT;

/// What a path pays for a change of shift, in the integers of a cost.
#[derive(Clone, Debug)]
pub(crate) struct StepPenalty {
    /// For one pixel of shift.
    pub(crate) small: i16,
    /// For more, by the step of the guide in 8 bits.
    large: [i16; 256],
}

impl StepPenalty {
    /// `P2(g) = 1.05 P1 + (P2 - 1.05 P1) exp(-g / softness)`: a little dearer than a small step at
    /// an edge of the picture, and the full price where it is smooth.
    pub(crate) fn new(params: &DenseParams) -> Self {
        let small = params.small_step * COST_UNIT;
        let full = params.large_step * COST_UNIT;
        let least = 1.05 * small;
        let large = std::array::from_fn(|step| {
            let step = step as f32 / 255.0;
            let faded = (-step / params.edge_softness).exp();
            (least + (full - least).max(0.0) * faded).round() as i16
        });
        Self {
            small: small.round() as i16,
            large,
        }
    }

    #[inline(always)]
    pub(crate) fn large(&self, guide_step: u8) -> i16 {
        self.large[usize::from(guide_step)]
    }
}
