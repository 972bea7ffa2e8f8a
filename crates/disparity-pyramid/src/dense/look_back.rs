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
        *verdict = match other_dx.get(place(x as f32 + dx)) {
            None => Validity::OutOfView,
            Some(other_dx) if (dx - other_dx).abs() <= tolerance_px => Validity::Valid,
            Some(_) => {
                some = true;
                Validity::Occluded
            }
        };
    }
    some
}

/// Which pixels of a row some pixel of the other eye says it sees.
fn claim(other_dx: &[f32], search: SearchRange, claimed: &mut Vec<bool>) {
    let (least, most) = (search.least_dx() as f32, search.most_dx() as f32);
    claimed.clear();
    claimed.resize(other_dx.len(), false);
    for (seen, dx) in other_dx.iter().enumerate() {
        // An eye that says nothing, NaN, claims nothing: no comparison below holds.
        let from = seen as f32 - dx;
        let x = nearest(from);
        let mut mark = |x: f32| {
            let shift = seen as f32 - x;
            if least <= shift
                && shift <= most
                && let Some(claimed) = claimed.get_mut(place(x))
            {
                *claimed = true;
            }
        };
        mark(x);
        // Halfway between two pixels both are seen.
        if from - x > 1.0 - AGREES_PX {
            mark(x + 1.0);
        } else if x - from > 1.0 - AGREES_PX {
            mark(x - 1.0);
        }
    }
}
