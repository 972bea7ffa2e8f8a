use rayon::prelude::*;

use crate::SearchRange;
use crate::dense::cross_arms::CrossArms;
use crate::dense::partial_field::{PartialField, is_hidden};

/// Votes that carry an election: more than so many, and more than this part of all.
const LEAST_VOTES: u32 = 10;
const LEAST_SHARE: f32 = 0.4;

/// Every so many rows of a surface vote: half the time, and rows know what their neighbours know.
const ROWS: usize = 2;

/// How much nearer than what lies behind a hidden pixel may come to lie, in pixels.
const HIDDEN_NEARER_PX: f32 = 1.0;

/// One round in which every pixel without an answer takes the shift that most of its surface has:
/// the mean of the shifts in the fullest whole-pixel bin. A hidden pixel takes none that is nearer
/// than what lies behind it.
pub(crate) fn vote(field: &mut PartialField, arms: &CrossArms<'_>, search: SearchRange) {
    let (height, width) = field.dx.dim();
    let elected: Vec<Vec<Option<f32>>> = (0..height)
        .into_par_iter()
        .map_init(
            || vec![(0u32, 0.0f32); search.shifts()],
            |bins, y| {
                let behind = field.backgrounds(y);
                let elected = (0..width).map(|x| {
                    if field.known[[y, x]] {
                        return None;
                    }
                    let winner = elect(field, arms, search, bins, (x, y))?;
                    let seen_by_both = !is_hidden(field.validity[[y, x]]);
                    let fits = seen_by_both || winner >= behind[x] - HIDDEN_NEARER_PX;
                    fits.then_some(winner)
                });
                elected.collect()
            },
        )
        .collect();
    let elected = elected.into_iter().flatten();
    let kept = field.dx.iter_mut().zip(&mut field.known);
    for ((dx, known), elected) in kept.zip(elected) {
        if let Some(elected) = elected {
            (*dx, *known) = (elected, true);
        }
    }
}

/// The shift that carries the election among the known pixels of a surface. `bins` are one a shift.
fn elect(
    field: &PartialField,
    arms: &CrossArms<'_>,
    search: SearchRange,
    bins: &mut [(u32, f32)],
    (x, y): (usize, usize),
) -> Option<f32> {
    let dx = field.dx.as_slice()?;
    let known = field.known.as_slice()?;
    bins.fill((0, 0.0));
    let mut votes = 0;
    for run in arms.region(x, y).step_by(ROWS) {
        for (dx, known) in dx[run.clone()].iter().zip(&known[run]) {
            if *known {
                let bin = (dx.round() as i32 - search.least_dx()).max(0) as usize;
                let bin = &mut bins[bin.min(search.shifts() - 1)];
                *bin = (bin.0 + 1, bin.1 + dx);
                votes += 1;
            }
        }
    }
    // Of equally full bins the farthest.
    let (most, sum) = bins.iter().copied().max_by_key(|bin| bin.0)?;
    let carried = most > LEAST_VOTES && most as f32 > LEAST_SHARE * votes as f32;
    carried.then(|| sum / most as f32)
}
