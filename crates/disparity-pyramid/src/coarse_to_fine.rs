use crate::MatchParams;
use crate::expand::{double_into, expand_into};
use crate::grid::Grid;
use crate::median::Windows;
use crate::shift_covariance::FitCovariance;
use crate::shifts::Shifts;
use crate::track::Track;
use ndarray::Array2;

/// The shifts that take one eye's image to the other's, from the coarsest scale down to the scale
/// `last` (equation 4), 0 being the finest; they are left in that level of the track. `grids` are the
/// scales', finest first; `start_px` is in pixels of the finest.
///
/// `refine` is one warp at one scale: it improves the shifts where the phases tell it to, and says
/// at each pixel whether they did. From the second warp on it is also given the coarser scale's
/// vertical shifts; at the first these are the shifts themselves.
pub(crate) fn coarse_to_fine(
    track: &mut Track,
    (grids, last): (&[Grid], usize),
    start_px: (f32, f32),
    params: &MatchParams,
    mut refine: impl FnMut(usize, &mut Shifts, Option<&Array2<f32>>),
) {
    track.fit(grids, last);
    let coarsest = grids.len() - 1;
    for scale in (last..=coarsest).rev() {
        let (finer, coarser) = track.levels.split_at_mut(scale + 1);
        let level = &mut finer[scale];
        let shifts = &mut level.shifts;
        if let Some(coarser) = coarser.first() {
            // Every second pixel of a scale is a pixel of the next coarser one.
            let step = grids[scale + 1].step;
            let same_grid = grids[scale].step > step;
            let finer = if same_grid { double_into } else { expand_into };
            finer(coarser.shifts.dx.view(), &mut shifts.dx);
            finer(coarser.shifts.dy.view(), &mut shifts.dy);
            if scale < params.slanted_scales {
                let planes = (&coarser.shifts.dx, &coarser.shifts.dy);
                shifts
                    .slopes
                    .measure(planes, step, (scale, u32::from(!same_grid)));
            } else {
                shifts.slopes.clear();
            }
        } else {
            let shrink = 0.5f32.powi(coarsest as i32);
            shifts.dx.fill(start_px.0 * shrink);
            shifts.dy.fill(start_px.1 * shrink);
            shifts.slopes.clear();
        }
        let warps = if scale == 0 {
            params.finest_warps
        } else {
            params.warps
        };
        if warps > 1 {
            level.parent_dy.clone_from(&shifts.dy);
        }
        for warp in 1..=warps {
            if (scale, warp) == (0, warps) {
                shifts.covariance = params
                    .covariance
                    .then(|| Array2::from_elem(grids[0].size.dim(), FitCovariance::UNKNOWN));
            }
            refine(scale, shifts, (warp > 1).then_some(&level.parent_dy));
            let medians = if warp < warps {
                params.medians.min(1)
            } else {
                params.medians
            };
            // They also fill where there was no answer, as far as they reach; elsewhere the coarser
            // scale's shift stays.
            let planes = [&mut shifts.dx, &mut shifts.dy];
            let medians_of = &mut level.medians;
            let windows = Windows {
                radius: params.median_radius,
                step: grids[scale].step,
                slopes: &shifts.slopes,
            };
            medians_of.smooth_valid(planes, &shifts.validity, medians, windows);
        }
    }
}
