use std::borrow::Borrow;

use disparity_pyramid::{
    FromVotes, MatchParams, Mismatch, VectorMatcher, estimate, estimate_from_votes,
    estimate_near_first,
};
use v1_gabor::{Binocular, LumaImage, V1Responses};

/// Where the vector pyramid searches.
///
/// For a range that is not given the bank should hold all scales that the images allow
/// ([`GaborParams::most_scales`]); no more of them are searched than it takes.
///
/// [`GaborParams::most_scales`]: v1_gabor::GaborParams::most_scales
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Range {
    /// About [`MatchParams::zero_disparity_px`], as far as the bank's scales reach: for eyes whose
    /// range is known, and for many looks at one place.
    #[default]
    Given,
    /// About [`MatchParams::zero_disparity_px`] with six scales, and where fewer than half of the
    /// pixels are valid from there, where a coarse look says ([`estimate_near_first`]).
    Auto,
    /// Where a coarse look says ([`estimate_from_votes`]): for a pair of which nothing is known.
    Wide,
}

impl Range {
    /// The vector disparity over this range, and where the search began; without starts if that was
    /// [`MatchParams::zero_disparity_px`].
    ///
    /// # Errors
    /// [`Mismatch`] if the eyes cannot be matched.
    pub fn disparity(
        self,
        eyes: &Binocular<V1Responses>,
        matching: MatchParams,
    ) -> Result<FromVotes, Mismatch> {
        match self {
            Self::Given => Ok(FromVotes {
                field: estimate(eyes, matching)?,
                starts: Vec::new(),
                scales: eyes.left.scales().len(),
            }),
            Self::Auto => estimate_near_first(eyes, matching),
            Self::Wide => estimate_from_votes(eyes, matching),
        }
    }

    /// The same from the images, by a matcher that is planned and written over what an earlier pair gave:
    /// the responses are made where they are needed and not held, and the bits are those of
    /// [`disparity`](Self::disparity).
    ///
    /// # Errors
    /// [`Mismatch`] if an image has another size than planned.
    pub fn disparity_into(
        self,
        eyes: &Binocular<impl Borrow<LumaImage>>,
        matcher: &mut VectorMatcher,
        found: &mut FromVotes,
    ) -> Result<(), Mismatch> {
        match self {
            Self::Given => {
                matcher.estimate_into(eyes, &mut found.field)?;
                found.starts.clear();
                found.scales = matcher.scales();
                Ok(())
            }
            Self::Auto => matcher.estimate_near_first_into(eyes, found),
            Self::Wide => matcher.estimate_from_votes_into(eyes, found),
        }
    }
}
