use ndarray::{Array2, Zip};
use v1_gabor::Size;

use crate::expand::expand;
use crate::fill::fill;
use crate::median::median_of_known;
use crate::refine::Shifts;
use crate::shift_covariance::FitCovariance;
use crate::{MatchParams, MedianRadius};

/// The shifts that take one eye's image to the other's, from the coarsest scale down to the scale
/// `last` (equation 4), 0 being the finest. `sizes` are the scales', finest first; `start_px` is in
/// pixels of the finest.
///
/// `refine` is one warp at one scale: it improves the shifts where the phases tell it to, and says
/// at each pixel whether they did. It is also given the coarser scale's vertical shifts.
pub(crate) fn coarse_to_fine(
    sizes: &[Size],
    last: usize,
    start_px: (f32, f32),
    params: &MatchParams,
    refine: impl Fn(usize, &mut Shifts, &Array2<f32>),
) -> Shifts {
    let coarsest = sizes.len() - 1;
    let shrink = 0.5f32.powi(coarsest as i32);
    let dim = sizes[coarsest].dim();
    let mut shifts = Shifts::silent(
        Array2::from_elem(dim, start_px.0 * shrink),
        Array2::from_elem(dim, start_px.1 * shrink),
    );
    for (scale, &size) in sizes.iter().enumerate().skip(last).rev() {
        if scale < coarsest {
            shifts = Shifts::silent(
                expand(shifts.dx.view(), size),
                expand(shifts.dy.view(), size),
            );
        }
        let parent_dy = shifts.dy.clone();
        let warps = if scale == 0 {
            params.finest_warps
        } else {
            params.warps
        };
        for warp in 1..=warps {
            if params.covariance && (scale, warp) == (0, warps) {
                shifts.covariance = Some(Array2::from_elem(size.dim(), FitCovariance::UNKNOWN));
            }
            refine(scale, &mut shifts, &parent_dy);
            let medians = if warp < warps {
                params.medians.min(1)
            } else {
                params.medians
            };
            smooth(&mut shifts, medians, params.median_radius);
        }
    }
    fill(&mut shifts, params.fill_neighbours);
    shifts
}

/// Medians over valid neighbours; they also fill where there was no answer, as far as they reach.
/// Elsewhere the coarser scale's shift stays.
fn smooth(shifts: &mut Shifts, medians: usize, radius: MedianRadius) {
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
