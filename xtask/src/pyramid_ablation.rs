use disparity_pyramid::{MatchParams, MedianRadius};

/// The vector pyramid with one of its ingredients left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ablation {
    /// What is left out, in words.
    pub(crate) without: &'static str,
    /// The parameters that are left.
    pub(crate) params: MatchParams,
}

/// The default first, then each ingredient off in turn, then all of them: the paper's own steps. Last
/// what neither has: the test for singularities, the search along rows and stretched filters; and with a
/// quicker way back.
pub(crate) fn ablations() -> [Ablation; 21] {
    let all = MatchParams::default();
    let singularity_tau = Some(1.75);
    let without = |without, params| Ablation { without, params };
    [
        without("nothing (the default)", all),
        without(
            "further warps: one a scale",
            MatchParams {
                warps: 1,
                finest_warps: 1,
                ..all
            },
        ),
        without(
            "robust rounds: a plain fit",
            MatchParams {
                robust_rounds: 0,
                ..all
            },
        ),
        without(
            "sparse scales: every pixel fitted",
            MatchParams {
                sparse_scales: 0,
                ..all
            },
        ),
        without("medians", MatchParams { medians: 0, ..all }),
        without(
            "wide medians: 3 x 3 once",
            MatchParams {
                medians: 1,
                median_radius: MedianRadius::One,
                ..all
            },
        ),
        without(
            "coherence: every fit counts",
            MatchParams {
                least_coherence: -1.0,
                ..all
            },
        ),
        without(
            "the vertical prior",
            MatchParams {
                vertical_prior: 0.0,
                ..all
            },
        ),
        without(
            "the look back",
            MatchParams {
                left_right_px: None,
                ..all
            },
        ),
        without(
            "filling",
            MatchParams {
                fill_neighbours: None,
                ..all
            },
        ),
        without(
            "weak texture: energy 1e-6",
            MatchParams {
                energy_threshold: 1e-6,
                ..all
            },
        ),
        without("all of them (as published)", MatchParams::as_published()),
        without(
            "nothing, singularities tested",
            MatchParams {
                singularity_tau,
                ..all
            },
        ),
        without(
            "all of them, singularities tested",
            MatchParams {
                singularity_tau,
                ..MatchParams::as_published()
            },
        ),
        without(
            "nothing, along rows only",
            MatchParams {
                rows_only: true,
                ..all
            },
        ),
        without(
            "the test for lonely patches",
            MatchParams {
                least_patch: 0,
                ..all
            },
        ),
        without(
            "the coarser scale's contradictions",
            MatchParams {
                contradictions: None,
                ..all
            },
        ),
        without(
            "filters and medians along slopes",
            MatchParams {
                slanted_scales: 0,
                ..all
            },
        ),
        without(
            "them at the coarser scales",
            MatchParams {
                slanted_scales: 1,
                ..all
            },
        ),
        without("all that one warp leaves out", MatchParams::one_warp()),
        without(
            "nothing, one warp on the way back",
            MatchParams {
                look_back_warps: 1,
                ..all
            },
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_row_differs_from_the_default() {
        let [default, rest @ ..] = ablations();
        assert_eq!(default.params, MatchParams::default());
        assert!(rest.iter().all(|row| row.params != default.params));
    }
}
