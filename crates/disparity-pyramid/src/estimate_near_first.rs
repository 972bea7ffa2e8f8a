use v1_gabor::{Binocular, GaborParams, V1Responses};

use crate::estimate::estimate_over;
use crate::{FromVotes, MatchParams, Mismatch, estimate_from_votes};

/// The part of the pixels that are valid where a search reaches what is seen. Of the pairs measured,
/// those that it reaches have three fifths and more, those that it misses little more than a third at most.
const ENOUGH: f64 = 0.5;

/// The vector disparity of a pair of whose range little is known: searched first about
/// [`MatchParams::zero_disparity_px`] with six scales (fewer if `eyes` hold fewer), which reach 48 px,
/// and only if fewer than half of the pixels are valid from there as [`estimate_from_votes`] does. Of
/// the two fields the one with more valid pixels is kept.
///
/// Who knows that a pattern repeats, and lies far, should ask [`estimate_from_votes`] at once: from
/// near it may be found valid a period or more away.
///
/// A coarse look takes one to ten times as long as the search itself, and most pairs need none: this
/// costs them nothing. What [`estimate_from_votes`] asks of `eyes` holds here too.
///
/// # Errors
/// [`Mismatch`] as [`estimate`](crate::estimate).
pub fn estimate_near_first(
    eyes: &Binocular<V1Responses>,
    params: MatchParams,
) -> Result<FromVotes, Mismatch> {
    let scales = GaborParams::default().scales.min(eyes.left.scales().len());
    let near = FromVotes {
        field: estimate_over(eyes, params, scales)?,
        starts: Vec::new(),
        scales,
    };
    if near.field.density() >= ENOUGH {
        return Ok(near);
    }
    let found = estimate_from_votes(eyes, params)?;
    Ok(if found.field.density() > near.field.density() {
        found
    } else {
        near
    })
}
