use rayon::prelude::*;

use crate::SearchRange;
use crate::dense::cross_arms::CrossArms;
use crate::dense::nearest::nearest;
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
    let bins = bins(field, search);
    let elected: Vec<Vec<Option<f32>>> = (0..height)
        .into_par_iter()
        .map_init(
            || vec![(0u32, 0.0f32); search.shifts()],
            |counts, y| {
                if field.known.row(y).iter().all(|known| *known) {
                    return vec![None; width];
                }
                let behind = field.backgrounds(y);
                let elected = (0..width).map(|x| {
                    if field.known[[y, x]] {
                        return None;
                    }
                    let winner = elect(field, arms, &bins, counts, (x, y))?;
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

/// Stands for the bin of a pixel that knows nothing.
const NO_BIN: u16 = u16::MAX;

/// The whole-pixel bin of every known shift, row-major: told once, as each has many voters.
fn bins(field: &PartialField, search: SearchRange) -> Vec<u16> {
    let most = (search.shifts() - 1) as f32;
    let shifts = field.dx.iter().zip(&field.known);
    let bin = |(dx, known): (&f32, &bool)| {
        if *known {
            (nearest(*dx) - search.least_dx() as f32).clamp(0.0, most) as u16
        } else {
            NO_BIN
        }
    };
    shifts.map(bin).collect()
}

/// The shift that carries the election among the known pixels of a surface. `counts` are the votes
/// and the sum of the shifts of each bin.
fn elect(
    field: &PartialField,
    arms: &CrossArms<'_>,
    bins: &[u16],
    counts: &mut [(u32, f32)],
    (x, y): (usize, usize),
) -> Option<f32> {
    let dx = field.dx.as_slice()?;
    counts.fill((0, 0.0));
    let (mut votes, mut most, mut fullest) = (0, 0, 0);
    for run in arms.region(x, y).step_by(ROWS) {
        for (dx, bin) in dx[run.clone()].iter().zip(&bins[run]) {
            if *bin != NO_BIN {
                let bin = usize::from(*bin);
                let (count, sum) = &mut counts[bin];
                *count += 1;
                *sum += dx;
                votes += 1;
                // Of equally full bins the farthest.
                if *count > most || (*count == most && bin > fullest) {
                    (most, fullest) = (*count, bin);
                }
            }
        }
    }
    let carried = most > LEAST_VOTES && most as f32 > LEAST_SHARE * votes as f32;
    carried.then(|| counts[fullest].1 / most as f32)
}
