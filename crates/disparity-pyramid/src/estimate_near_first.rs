use v1_gabor::{Binocular, GaborParams, V1Responses};

use crate::estimate_from_votes::search_from_votes;
use crate::pair_search::{HeldPair, PairSearch};
use crate::{FromVotes, MatchParams, Mismatch};

/// The part of the pixels that are valid where a search reaches what is seen. Of the pairs measured,
/// those that it reaches have three fifths and more, those that it misses little more than a third at most.
const ENOUGH: f64 = 0.5;

/// The vector disparity of a pair of whose range little is known: searched first about
/// [`MatchParams::zero_disparity_px`] with six scales (fewer if `eyes` hold fewer), which reach 48 px,
/// and only if fewer than half of the pixels are valid from there as [`estimate_from_votes`](crate::estimate_from_votes) does. Of
/// the two fields the one with more valid pixels is kept.
///
/// Who knows that a pattern repeats, and lies far, should ask [`estimate_from_votes`](crate::estimate_from_votes) at once: from
/// near it may be found valid a period or more away.
///
/// A coarse look takes one to ten times as long as the search itself, and most pairs need none: this
/// costs them nothing. What [`estimate_from_votes`](crate::estimate_from_votes) asks of `eyes` holds here too.
///
/// # Errors
/// [`Mismatch`] as [`estimate`](crate::estimate).
pub fn estimate_near_first(
    eyes: &Binocular<V1Responses>,
    params: MatchParams,
) -> Result<FromVotes, Mismatch> {
    let mut found = FromVotes::default();
    search_near_first(&mut HeldPair::of(eyes), params, &mut found)?;
    Ok(found)
}

/// The same of any pair, written over what an earlier one gave.
pub(crate) fn search_near_first(
    pair: &mut impl PairSearch,
    params: MatchParams,
    found: &mut FromVotes,
) -> Result<(), Mismatch> {
    let scales = GaborParams::default().scales.min(pair.held_scales());
    pair.search(&params, scales, &mut found.field)?;
    found.starts.clear();
    found.scales = scales;
    if found.field.density() >= ENOUGH {
        return Ok(());
    }
    let mut voted = FromVotes::default();
    search_from_votes(pair, params, &mut voted)?;
    if voted.field.density() > found.field.density() {
        *found = voted;
    }
    Ok(())
}
