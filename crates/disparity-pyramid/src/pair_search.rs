use v1_gabor::{Binocular, V1Responses};

use crate::estimate::estimate_scales_into;
use crate::{CoarseVotes, DisparityField, MatchParams, MatchWorkspace, Mismatch};

/// A pair that can be searched more than once, each time with other parameters: what
/// [`estimate_near_first`](crate::estimate_near_first) and
/// [`estimate_from_votes`](crate::estimate_from_votes) ask, whether its responses are held or made on the
/// way ([`VectorMatcher`](crate::VectorMatcher)).
pub(crate) trait PairSearch {
    /// How many scales can be searched.
    fn held_scales(&self) -> usize;

    /// What a coarse look finds; `None` where hardly anything votes.
    fn votes(&mut self) -> Option<CoarseVotes>;

    /// One search over the finest `scales`.
    fn search(
        &mut self,
        params: &MatchParams,
        scales: usize,
        field: &mut DisparityField,
    ) -> Result<(), Mismatch>;
}

/// A pair whose responses are there.
pub(crate) struct HeldPair<'a> {
    pub(crate) eyes: &'a Binocular<V1Responses>,
    pub(crate) workspace: MatchWorkspace,
}

impl<'a> HeldPair<'a> {
    pub(crate) fn of(eyes: &'a Binocular<V1Responses>) -> Self {
        Self {
            eyes,
            workspace: MatchWorkspace::new(),
        }
    }
}

impl PairSearch for HeldPair<'_> {
    fn held_scales(&self) -> usize {
        self.eyes.left.scales().len()
    }

    fn votes(&mut self) -> Option<CoarseVotes> {
        CoarseVotes::count(self.eyes)
    }

    fn search(
        &mut self,
        params: &MatchParams,
        scales: usize,
        field: &mut DisparityField,
    ) -> Result<(), Mismatch> {
        estimate_scales_into(self.eyes, *params, scales, (&mut self.workspace, field))
    }
}
