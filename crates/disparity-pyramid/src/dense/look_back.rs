use ndarray::{Array2, ArrayView1, ArrayView2, Zip};

use crate::dense::nearest::nearest;
use crate::{SearchRange, Validity};

/// Follows each shift to the other eye and asks what that eye's own shift there is (`other_dx`,
/// right minus left as well). Where the two differ by more than `tolerance_px`, the pixel is
/// inconsistent if some shift of the search would lead to a pixel that agrees with it, for then the
/// match may only have been missed, and occluded if there is none.
pub(crate) fn look_back(
    dx: ArrayView2<'_, f32>,
    other_dx: ArrayView2<'_, f32>,
    tolerance_px: f32,
    search: SearchRange,
) -> Array2<Validity> {
    let width = dx.ncols();
    let mut verdicts = Array2::from_elem(dx.dim(), Validity::Valid);
    Zip::from(verdicts.rows_mut())
        .and(dx.rows())
        .and(other_dx.rows())
        .par_for_each(|mut verdicts, dx, other_dx| {
            let claimed = claimed(other_dx, search);
            for (x, (verdict, &dx)) in verdicts.iter_mut().zip(dx).enumerate() {
                let seen = nearest(x as f32 + dx);
                *verdict = if !(seen >= 0.0 && seen < width as f32) {
                    Validity::OutOfView
                } else if (dx - other_dx[seen as usize]).abs() <= tolerance_px {
                    Validity::Valid
                } else if claimed[x] {
                    Validity::Inconsistent
                } else {
                    Validity::Occluded
                };
            }
        });
    verdicts
}

/// Which pixels of a row some pixel of the other eye says it sees.
fn claimed(other_dx: ArrayView1<'_, f32>, search: SearchRange) -> Vec<bool> {
    // Half a pixel of rounding, and a little.
    const AGREES_PX: f32 = 0.6;
    let (least, most) = (search.least_dx() as f32, search.most_dx() as f32);
    let mut claimed = vec![false; other_dx.len()];
    for (seen, dx) in other_dx.iter().enumerate() {
        // An eye that says nothing, NaN, claims nothing: no comparison below holds.
        let from = seen as f32 - dx;
        let (first, last) = (nearest(from - AGREES_PX), nearest(from + AGREES_PX));
        let mut x = first;
        while x <= last {
            let shift = seen as f32 - x;
            let tried = least <= shift && shift <= most;
            if tried
                && (shift - dx).abs() < AGREES_PX
                && x >= 0.0
                && let Some(claimed) = claimed.get_mut(x as usize)
            {
                *claimed = true;
            }
            x += 1.0;
        }
    }
    claimed
}
