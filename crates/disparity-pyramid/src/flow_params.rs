use crate::MatchParams;

impl MatchParams {
    /// Parameters for optic flow: [`estimate`](crate::estimate) between two moments of one eye, the
    /// earlier in the left eye's place, so that a point at `(x, y)` goes to `(x + dx, y + dy)`.
    ///
    /// Motion has no baseline, so nothing pulls the vertical component to its parent; and a scene
    /// must be answered in its weak texture too, so the energy threshold is lower. Motion is smoother
    /// than depth, so more medians take noise away before they take detail.
    #[must_use]
    pub fn for_flow() -> Self {
        Self {
            energy_threshold: 1e-7,
            vertical_prior: 0.0,
            medians: 6,
            ..Self::default()
        }
    }
}
