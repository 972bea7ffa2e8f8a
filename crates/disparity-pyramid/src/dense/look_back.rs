use ndarray::{Array2, ArrayView2};
use rayon::prelude::*;

use crate::dense::fitted::numbers;
use crate::dense::nearest::{nearest, place};
use crate::{SearchRange, Validity};

/// How far a claim may lie from the pixel that it is for: half a pixel of rounding, and a little.
const AGREES_PX: f32 = 0.6;

/// Follows each shift to the other eye and asks what that eye's own shift there is (`other_dx`,
/// right minus left as well). Where the two differ by more than `tolerance_px`, the pixel is
/// inconsistent if some shift of the search would lead to a pixel that agrees with it, for then the
/// match may only have been missed, and occluded if there is none.
pub(crate) fn look_back(
    dx: ArrayView2<'_, f32>,
    other_dx: ArrayView2<'_, f32>,
    tolerance_px: f32,
    search: SearchRange,
    verdicts: &mut Array2<Validity>,
) {
    let width = dx.ncols();
    let (Some(dx), Some(other_dx)) = (dx.to_slice(), other_dx.to_slice()) else {
        unreachable!("planes are made in row-major order")
    };
    numbers(verdicts)
        .par_chunks_exact_mut(width)
        .zip(dx.par_chunks_exact(width))
        .zip(other_dx.par_chunks_exact(width))
        .for_each_init(Vec::new, |claimed, ((verdicts, dx), other_dx)| {
            if judge_row(verdicts, dx, other_dx, tolerance_px) {
                claim(other_dx, search, claimed);
                for (verdict, claimed) in verdicts.iter_mut().zip(claimed) {
                    if *claimed && *verdict == Validity::Occluded {
                        *verdict = Validity::Inconsistent;
                    }
                }
            }
        });
}

/// Which pixels of a row the other eye confirms; what it does not is called occluded. Whether there
/// is any such pixel.
fn judge_row(verdicts: &mut [Validity], dx: &[f32], other_dx: &[f32], tolerance_px: f32) -> bool {
    let mut some = false;
    for (x, (verdict, &dx)) in verdicts.iter_mut().zip(dx).enumerate() {
        let seen = place(x as f32 + dx);
        let in_view = seen < other_dx.len();
        // Asked of every pixel, so that nothing hangs on a guess of what the last one was.
        let other_dx = other_dx[if in_view { seen } else { 0 }];
        let agrees = (dx - other_dx).abs() <= tolerance_px;
        some |= in_view & !agrees;
        let there = if agrees {
            Validity::Valid
        } else {
            Validity::Occluded
        };
        *verdict = if in_view { there } else { Validity::OutOfView };
    }
    some
}

/// Which pixels of a row some pixel of the other eye says it sees.
fn claim(other_dx: &[f32], search: SearchRange, claimed: &mut Vec<bool>) {
    let (least, most) = (search.least_dx() as f32, search.most_dx() as f32);
    let width = other_dx.len();
    claimed.clear();
    // The last is claimed by those that see nothing of the row.
    claimed.resize(width + 1, false);
    for (seen, dx) in other_dx.iter().enumerate() {
        let seen = seen as f32;
        let from = seen - dx;
        let x = nearest(from);
        // Halfway between two pixels both are seen, elsewhere one twice.
        let beyond = from - x;
        let second = if beyond.abs() > 1.0 - AGREES_PX {
            x + beyond.signum()
        } else {
            x
        };
        for x in [x, second] {
            let shift = seen - x;
            // An eye that says nothing, NaN, claims nothing: no comparison holds.
            let searched = (least <= shift) & (shift <= most);
            claimed[if searched { place(x).min(width) } else { width }] = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Claims from the other eye's side are what each missed pixel finds if it tries every shift.
        #[test]
        fn claims_and_trials_agree(
            width in 1usize..40, least in -20i32..5, more in 0i32..20, tolerance_px in 0.0f32..2.0, seed: u64,
        ) {
            let search = SearchRange::new(least, least + more).unwrap();
            let mut state = seed | 1;
            let mut random = || {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                least as f32 - 0.5 + (state >> 20) as f32 % (8.0 * (more as f32 + 1.0)) / 8.0
            };
            let dx = Array2::from_shape_simple_fn((1, width), &mut random);
            let other_dx = Array2::from_shape_simple_fn((1, width), || {
                let dx = random();
                if dx > least as f32 + 8.0 { f32::NAN } else { dx }
            });
            let mut verdicts = Array2::from_elem((1, width), Validity::NoEnergy);
            look_back(dx.view(), other_dx.view(), tolerance_px, search, &mut verdicts);
            for (x, verdict) in verdicts.iter().enumerate() {
                let dx = dx[[0, x]];
                let there = |dx: i32| {
                    let seen = usize::try_from(x as i32 + dx).ok()?;
                    other_dx.get([0, seen]).copied()
                };
                // Halves are rounded as the machine does.
                let seen = there((x as f32 + dx).round_ties_even() as i32 - x as i32);
                let claimed = (least..=least + more)
                    .any(|dx| there(dx).is_some_and(|other| (other - dx as f32).abs() < AGREES_PX));
                let want = match seen {
                    None => Validity::OutOfView,
                    Some(other) if (dx - other).abs() <= tolerance_px => Validity::Valid,
                    Some(_) if claimed => Validity::Inconsistent,
                    Some(_) => Validity::Occluded,
                };
                prop_assert_eq!(*verdict, want, "at {}", x);
            }
        }
    }
}
