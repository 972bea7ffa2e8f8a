use ndarray::{Array2, Zip};
use pulp::{Arch, NullaryFnOnce};
use rayon::prelude::*;
use v1_gabor::{Responses, WaveVector};

use crate::tile::{MOST_ORIENTATIONS, TILE, Tile};
use crate::warp::Warp;
use crate::{MatchParams, Validity};

/// Shifts of one scale, and what the last warp thought of each.
#[derive(Debug)]
pub(crate) struct Shifts {
    pub(crate) dx: Array2<f32>,
    pub(crate) dy: Array2<f32>,
    pub(crate) validity: Array2<Validity>,
    /// Root mean square of what the orientations leave unexplained, in pixels of this scale.
    pub(crate) residual: Array2<f32>,
}

/// The two eyes at one scale.
pub(crate) struct Eyes<'a> {
    pub(crate) left: &'a Responses,
    pub(crate) right: &'a Responses,
    pub(crate) waves: &'a [WaveVector],
}

/// One warp: reads the right responses at the present shifts, turns each orientation's phase
/// difference into a component disparity (equation 2), fits the remaining shift to all of them
/// (equation 3) and adds it (equation 4). Pixels without an answer keep their shift and get the
/// reason.
pub(crate) fn refine(
    eyes: &Eyes<'_>,
    shifts: &mut Shifts,
    parent_dy: &Array2<f32>,
    params: &MatchParams,
) {
    const CONTIGUOUS: &str = "planes are made in row-major order";
    let warp = Warp::new(eyes.right, eyes.waves);
    let width = shifts.dx.dim().1;
    let dx = shifts
        .dx
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width);
    let dy = shifts
        .dy
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width);
    let validity = shifts
        .validity
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width);
    let residual = shifts
        .residual
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width);
    let parent_dy = parent_dy.as_slice().expect(CONTIGUOUS).par_chunks(width);
    (dx, dy, validity, residual, parent_dy)
        .into_par_iter()
        .enumerate()
        .for_each_init(
            Tile::new,
            |tile, (y, (dx, dy, validity, residual, parent_dy))| {
                let row = Row {
                    eyes,
                    warp: &warp,
                    params,
                    tile,
                    y,
                    dx,
                    dy,
                    validity,
                    residual,
                    parent_dy,
                };
                // Loops over orientations have a known length: the paper's number, or the most.
                if eyes.waves.len() <= 8 {
                    Arch::new().dispatch(InLanes::<8>(row));
                } else {
                    Arch::new().dispatch(InLanes::<MOST_ORIENTATIONS>(row));
                }
            },
        );
}

/// One row's work.
struct Row<'a> {
    eyes: &'a Eyes<'a>,
    warp: &'a Warp<'a>,
    params: &'a MatchParams,
    tile: &'a mut Tile,
    y: usize,
    dx: &'a mut [f32],
    dy: &'a mut [f32],
    validity: &'a mut [Validity],
    residual: &'a mut [f32],
    parent_dy: &'a [f32],
}

/// One row's work with the orientations in `LANES` lanes.
///
/// It is compiled once for each vector width and run at the machine's widest. Products and sums
/// stay separate at every width, so that this level adds no difference between machines.
struct InLanes<'a, const LANES: usize>(Row<'a>);

impl<const LANES: usize> NullaryFnOnce for InLanes<'_, LANES> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Row {
            eyes,
            warp,
            params,
            tile,
            y,
            dx,
            dy,
            validity,
            residual,
            parent_dy,
        } = self.0;
        for start in (0..dx.len()).step_by(TILE) {
            let end = (start + TILE).min(dx.len());
            let (dx, dy) = (&mut dx[start..end], &mut dy[start..end]);
            tile.read::<LANES>(eyes, warp, (start, y), (dx, dy), params.energy_threshold);
            let fit = tile.fit(eyes.waves, &parent_dy[start..end], dy, params);
            for i in 0..end - start {
                let verdict = tile.verdict(i, &fit, params, (start + i, y), (dx[i], dy[i]), warp);
                validity[start + i] = verdict;
                residual[start + i] = fit.residual_px[i];
                if verdict.is_valid() {
                    dx[i] += fit.ux[i];
                    dy[i] += fit.uy[i];
                }
            }
        }
    }
}

impl Shifts {
    /// The shifts known at this scale: NaN where no answer was found.
    pub(crate) fn known(&self, plane: &Array2<f32>) -> Array2<f32> {
        Zip::from(plane)
            .and(&self.validity)
            .map_collect(|&shift, validity| if validity.is_valid() { shift } else { f32::NAN })
    }
}
