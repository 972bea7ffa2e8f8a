use v1_gabor::{Binocular, GaborParams, V1Responses};

use crate::pair_search::{HeldPair, PairSearch};
use crate::{DisparityField, MatchParams, Mismatch, Start, most_consistent};

/// What a search of which nothing was known found, and where it began. The default is
/// what nothing gave, to be written over.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FromVotes {
    /// The vector disparity of every pixel of the left image.
    pub field: DisparityField,
    /// The starts that the coarse look found, by the number of their votes; none if hardly anything
    /// voted or none was needed, and the search began at [`MatchParams::zero_disparity_px`].
    pub starts: Vec<Start>,
    /// Scales of the pyramid that were searched.
    pub scales: usize,
}

/// Scales that a search from near needs: they reach 24 px.
const NEAR_SCALES: usize = 5;

/// Coherence enough for a field that competes. With 0.8 the fields of a chessboard's wrong squares lose too
/// few pixels against the right one: 36 to 48 of 54 corners in place of all.
const COMPETING_COHERENCE: f32 = 0.7;

/// The vector disparity of a pair of which nothing is known: neither how far its shifts lie from
/// zero, nor how far apart, nor whether a pattern repeats.
///
/// A coarse look finds the starts ([`CoarseVotes`](crate::CoarseVotes)): the middle of the votes if five scales reach
/// them all, else up to six. From each the pyramid is run over no more scales than it takes
/// ([`estimate`](crate::estimate)), and of the fields [`most_consistent`] takes at each place the one
/// that both eyes can agree upon. `eyes` should hold all scales that their size allows
/// ([`GaborParams::most_scales`]): the coarse look reads those of less than a hundred pixels. Along
/// rows only ([`MatchParams::rows_only`]) every start has the vertical shift of
/// [`MatchParams::zero_disparity_px`].
///
/// Fields that compete are fitted at every pixel ([`MatchParams::sparse_scales`] counts as 0), and with
/// [`MatchParams::least_coherence`] at most 0.7: what decides between them is how many pixels each explains,
/// and on a repeating pattern that is a matter of a few. For the same reason their filters are not stretched and
/// small patches count ([`MatchParams::slanted_scales`] and [`MatchParams::least_patch`] are 0 then,
/// [`MatchParams::contradictions`] is `None`).
///
/// # Errors
/// [`Mismatch`] as `estimate`.
pub fn estimate_from_votes(
    eyes: &Binocular<V1Responses>,
    params: MatchParams,
) -> Result<FromVotes, Mismatch> {
    let mut found = FromVotes::default();
    search_from_votes(&mut HeldPair::of(eyes), params, &mut found)?;
    Ok(found)
}

/// The same of any pair, written over what an earlier one gave.
pub(crate) fn search_from_votes(
    pair: &mut impl PairSearch,
    mut params: MatchParams,
    found: &mut FromVotes,
) -> Result<(), Mismatch> {
    let held = pair.held_scales();
    let mut starts = pair.votes().map_or_else(Vec::new, |votes| {
        let middle = votes.middle();
        if middle.scales() <= NEAR_SCALES {
            vec![middle]
        } else {
            votes.starts()
        }
    });
    if params.rows_only {
        for start in &mut starts {
            start.shift_px.1 = params.zero_disparity_px.1;
        }
        // Starts that differed along y alone are now one.
        starts.dedup_by_key(|start| start.shift_px);
    }
    if starts.len() > 1 {
        params.sparse_scales = 0;
        params.slanted_scales = 0;
        // A wrong start is known by how few pixels it explains, and those are among them.
        params.least_patch = 0;
        params.contradictions = None;
        params.least_coherence = params.least_coherence.min(COMPETING_COHERENCE);
    }
    let mut from = |start: Option<Start>, field: &mut DisparityField| {
        let wanted = start.map_or(GaborParams::default().scales, |start| start.scales());
        let scales = wanted.min(held);
        let params = MatchParams {
            zero_disparity_px: start.map_or(params.zero_disparity_px, |start| start.shift_px),
            ..params
        };
        pair.search(&params, scales, field)?;
        Ok::<_, Mismatch>(scales)
    };
    found.scales = match starts.as_slice() {
        [] => from(None, &mut found.field)?,
        [only] => from(Some(*only), &mut found.field)?,
        several => {
            let mut fields = vec![DisparityField::default(); several.len()];
            let mut scales = 0;
            for (&start, field) in several.iter().zip(&mut fields) {
                scales = scales.max(from(Some(start), field)?);
            }
            if let Some(field) = most_consistent(&fields) {
                found.field = field;
            }
            scales
        }
    };
    found.starts = starts;
    Ok(())
}
