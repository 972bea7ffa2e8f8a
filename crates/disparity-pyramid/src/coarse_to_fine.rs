use ndarray::Array2;
use v1_gabor::Size;

use crate::MatchParams;
use crate::expand::expand;
use crate::fill::fill;
use crate::median::smooth_valid;
use crate::refine::Shifts;
use crate::shift_covariance::FitCovariance;

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
            // They also fill where there was no answer, as far as they reach; elsewhere the coarser
            // scale's shift stays.
            let planes = [&mut shifts.dx, &mut shifts.dy];
            smooth_valid(planes, &shifts.validity, medians, params.median_radius);
        }
    }
    fill(&mut shifts, params.fill_neighbours);
    shifts
}
