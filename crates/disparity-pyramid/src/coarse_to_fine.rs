use ndarray::{Array2, Zip};
use v1_gabor::{Responses, WaveVector};

use crate::expand::expand;
use crate::median::median_of_known;
use crate::refine::{Eyes, Shifts, refine};
use crate::{MatchParams, MedianRadius, Validity};

/// The shifts that take one eye's image to the other's, from the coarsest scale to the finest
/// (equation 4). `scales` are the two eyes' responses, finest first.
pub(crate) fn coarse_to_fine(
    from: &[Responses],
    to: &[Responses],
    waves: &[WaveVector],
    start_px: (f32, f32),
    params: &MatchParams,
) -> Shifts {
    let coarsest = from.len() - 1;
    let shrink = 0.5f32.powi(coarsest as i32);
    let dim = from[coarsest].size().dim();
    let mut shifts = Shifts {
        dx: Array2::from_elem(dim, start_px.0 * shrink),
        dy: Array2::from_elem(dim, start_px.1 * shrink),
        validity: Array2::from_elem(dim, Validity::NoEnergy),
        residual: Array2::zeros(dim),
    };
    for (scale, (left, right)) in from.iter().zip(to).enumerate().rev() {
        if scale < coarsest {
            let size = left.size();
            shifts = Shifts {
                dx: expand(shifts.dx.view(), size),
                dy: expand(shifts.dy.view(), size),
                validity: Array2::from_elem(size.dim(), Validity::NoEnergy),
                residual: Array2::zeros(size.dim()),
            };
        }
        let eyes = Eyes { left, right, waves };
        let parent_dy = shifts.dy.clone();
        let warps = if scale == 0 {
            params.finest_warps
        } else {
            params.warps
        };
        for warp in 1..=warps {
            refine(&eyes, &mut shifts, &parent_dy, params);
            let medians = if warp < warps {
                params.medians.min(1)
            } else {
                params.medians
            };
            smooth(&mut shifts, medians, params.median_radius);
        }
    }
    shifts
}

/// Medians over valid neighbours; they also fill where there was no answer, as far as they reach.
/// Elsewhere the coarser scale's shift stays.
pub(crate) fn smooth(shifts: &mut Shifts, medians: usize, radius: MedianRadius) {
    let mut dx = shifts.known(&shifts.dx);
    let mut dy = shifts.known(&shifts.dy);
    for _ in 0..medians {
        dx = median_of_known(dx.view(), radius);
        dy = median_of_known(dy.view(), radius);
    }
    let take = |kept: &mut Array2<f32>, smoothed: &Array2<f32>| {
        Zip::from(kept).and(smoothed).for_each(|kept, &smoothed| {
            if !smoothed.is_nan() {
                *kept = smoothed;
            }
        });
    };
    take(&mut shifts.dx, &dx);
    take(&mut shifts.dy, &dy);
}
