use ndarray::{Array2, Zip};
use pulp::{Arch, NullaryFnOnce, Scalar, Simd};
use rayon::prelude::*;
use v1_gabor::machine::Machine;
use v1_gabor::{Responses, WaveVector};

use crate::shift_covariance::FitCovariance;
use crate::tile::{TILE, Tile};
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
    /// The covariance of each fit, unknown where there is no answer; a plane that is there is
    /// written by the warp, and it is there at the last one alone.
    pub(crate) covariance: Option<Array2<FitCovariance>>,
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
    let covariance: Vec<Option<&mut [FitCovariance]>> = match &mut shifts.covariance {
        None => (0..parent_dy.dim().0).map(|_| None).collect(),
        Some(plane) => {
            let plane = plane.as_slice_mut().expect(CONTIGUOUS);
            plane.chunks_mut(width).map(Some).collect()
        }
    };
    let params = &MatchParams {
        covariance: covariance.first().is_some_and(Option::is_some),
        ..*params
    };
    let parent_dy = parent_dy.as_slice().expect(CONTIGUOUS).par_chunks(width);
    (dx, dy, validity, residual, covariance, parent_dy)
        .into_par_iter()
        .enumerate()
        .for_each_init(
            Tile::new,
            |tile, (y, (dx, dy, validity, residual, covariance, parent_dy))| {
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
                    covariance,
                    parent_dy,
                };
                // The paper's number of orientations is known to the compiler.
                if eyes.waves.len() == 8 {
                    row.dispatch::<8>();
                } else {
                    row.dispatch::<0>();
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
    covariance: Option<&'a mut [FitCovariance]>,
    parent_dy: &'a [f32],
}

impl Row<'_> {
    /// Runs the row in the machine's vectors of eight lanes, which hold a tile.
    fn dispatch<const ORIENTATIONS: usize>(self) {
        match Arch::new() {
            #[cfg(target_arch = "x86_64")]
            Arch::V4(v4) => (*v4).vectorize(Compiled::<ORIENTATIONS, _>(self, *v4)),
            #[cfg(target_arch = "x86_64")]
            Arch::V3(v3) => v3.vectorize(Compiled::<ORIENTATIONS, _>(self, v3)),
            _ => Compiled::<ORIENTATIONS, _>(self, Scalar).call(),
        }
    }
}

/// One row's work, compiled for one kind of vectors and one number of orientations (0 for any).
struct Compiled<'a, const ORIENTATIONS: usize, S>(Row<'a>, S);

impl<const ORIENTATIONS: usize, S: Simd + Machine<TILE>> NullaryFnOnce
    for Compiled<'_, ORIENTATIONS, S>
{
    type Output = ();

    // Inlined into the function that is compiled for the vector unit; a call would leave it.
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
            mut covariance,
            parent_dy,
        } = self.0;
        let simd = self.1;
        let parts = 2 * eyes.waves.len();
        let left = &eyes.left.samples()[y * dx.len() * parts..][..dx.len() * parts];
        for start in (0..dx.len()).step_by(TILE) {
            let end = (start + TILE).min(dx.len());
            let (dx, dy) = (&mut dx[start..end], &mut dy[start..end]);
            tile.read::<ORIENTATIONS, S>(
                simd,
                (&left[start * parts..], warp),
                eyes.waves.len(),
                (start, y),
                (dx, dy),
                params.energy_threshold,
            );
            let fit = tile.fit(simd, eyes.waves, &parent_dy[start..end], dy, params);
            for i in 0..end - start {
                let verdict = tile.verdict(i, &fit, params, (start + i, y), (dx[i], dy[i]), warp);
                validity[start + i] = verdict;
                residual[start + i] = fit.residual_px[i];
                if let Some(covariance) = &mut covariance
                    && verdict.is_valid()
                {
                    let [xx, xy, yy] = fit.covariance.map(|entry| entry[i]);
                    let fits = 1.0;
                    covariance[start + i] = FitCovariance { xx, xy, yy, fits };
                }
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
