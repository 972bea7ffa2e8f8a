use crate::MatchParams;

impl MatchParams {
    /// Parameters for who has little time: one warp a scale, and slopes followed at the finest scale
    /// alone. A quarter less time than the default's; what it costs stands in `docs/ablation.md`.
    #[must_use]
    pub fn one_warp() -> Self {
        Self {
            warps: 1,
            finest_warps: 1,
            slanted_scales: 1,
            ..Self::default()
        }
    }
}
