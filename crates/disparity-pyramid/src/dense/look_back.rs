use ndarray::{Array2, ArrayView2, Zip};

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
    // Half a pixel of rounding, and a little.
    const AGREES_PX: f32 = 0.6;
    let width = dx.ncols();
    let mut verdicts = Array2::from_elem(dx.dim(), Validity::Valid);
    Zip::from(verdicts.rows_mut())
        .and(dx.rows())
        .and(other_dx.rows())
        .par_for_each(|mut verdicts, dx, other_dx| {
            for (x, (verdict, &dx)) in verdicts.iter_mut().zip(dx).enumerate() {
                let seen = (x as f32 + dx).round();
                if !(seen >= 0.0 && seen < width as f32) {
                    *verdict = Validity::OutOfView;
                    continue;
                }
                if (dx - other_dx[seen as usize]).abs() <= tolerance_px {
                    continue;
                }
                let least = (x as i64 + i64::from(search.least_dx())).max(0);
                let most = (x as i64 + i64::from(search.most_dx())).min(width as i64 - 1);
                let missed = (least..=most).any(|seen| {
                    let dx = (seen - x as i64) as f32;
                    (other_dx[seen as usize] - dx).abs() < AGREES_PX
                });
                *verdict = if missed {
                    Validity::Inconsistent
                } else {
                    Validity::Occluded
                };
            }
        });
    verdicts
}
