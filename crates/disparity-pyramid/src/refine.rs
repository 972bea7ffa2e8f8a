use ndarray::Array2;
use pulp::{Arch, NullaryFnOnce, Scalar};
use rayon::prelude::*;
use v1_gabor::{Responses, WaveVector};

#[cfg(target_arch = "x86_64")]
use crate::pair_read::ByPair;
use crate::shift_covariance::FitCovariance;
use crate::shifts::Shifts;
use crate::slopes::Slopes;
use crate::tile::{Along, ByPixel, Reader, TILE, Tile, whole};
use crate::warp::{Carriers, Warp};
use crate::{MatchParams, Validity};

/// The two eyes at one scale.
pub(crate) struct Eyes<'a> {
    pub(crate) left: &'a Responses,
    pub(crate) right: &'a Responses,
    pub(crate) waves: &'a [WaveVector],
    /// How far each pixel that is fitted is from the next, along rows and columns.
    pub(crate) step: usize,
}

/// One warp: reads the right responses at the present shifts, turns each orientation's phase
/// difference into a component disparity (equation 2), fits the remaining shift to all of them
/// (equation 3) and adds it (equation 4). Pixels without an answer keep their shift and get the
/// reason. `parent_dy` are the coarser scale's vertical shifts; none if the present ones still are those.
pub(crate) fn refine(
    eyes: &Eyes<'_>,
    shifts: &mut Shifts,
    parent_dy: Option<&Array2<f32>>,
    params: &MatchParams,
) {
    const CONTIGUOUS: &str = "planes are made in row-major order";
    let carriers = Carriers::new(eyes.waves, eyes.left.params().sigma_px());
    let warp = Warp::new(eyes.right, &carriers);
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
    let parent_dy = parent_dy.map(|plane| plane.as_slice().expect(CONTIGUOUS));
    let parent_of = |y: usize| parent_dy.map(|plane| &plane[y * width..][..width]);
    let params = &MatchParams {
        covariance: shifts.covariance.is_some(),
        ..*params
    };
    let slopes = &shifts.slopes;
    let run = |tile: &mut Tile, y, planes, covariance| {
        let (dx, dy, validity, residual) = planes;
        let parts = eyes.left.size().width * 2 * eyes.waves.len();
        let row = Row {
            left: &eyes.left.samples()[y * eyes.step * parts..][..parts],
            waves: eyes.waves,
            warp: &warp,
            params,
            tile,
            step: eyes.step,
            y: y * eyes.step,
            dx,
            dy,
            validity,
            residual,
            covariance,
            parent_dy: parent_of(y),
            slopes,
        };
        row.dispatch();
    };
    let rows = (dx, dy, validity, residual).into_par_iter().enumerate();
    match &mut shifts.covariance {
        None => rows.for_each_init(Tile::new, |tile, (y, planes)| run(tile, y, planes, None)),
        Some(plane) => {
            let plane = plane.as_slice_mut().expect(CONTIGUOUS);
            rows.zip(plane.par_chunks_mut(width)).for_each_init(
                Tile::new,
                |tile, ((y, planes), covariance)| {
                    run(tile, y, planes, Some(covariance));
                },
            );
        }
    }
}

/// One row's work.
pub(crate) struct Row<'a> {
    /// The left eye's samples of the row, of every pixel.
    pub(crate) left: &'a [f32],
    pub(crate) waves: &'a [WaveVector],
    /// The right eye's samples, of those rows at least that the shifts lead to.
    pub(crate) warp: &'a Warp<'a>,
    pub(crate) params: &'a MatchParams,
    pub(crate) tile: &'a mut Tile,
    /// How far each pixel that is fitted is from the next.
    pub(crate) step: usize,
    pub(crate) y: usize,
    pub(crate) dx: &'a mut [f32],
    pub(crate) dy: &'a mut [f32],
    pub(crate) validity: &'a mut [Validity],
    pub(crate) residual: &'a mut [f32],
    pub(crate) covariance: Option<&'a mut [FitCovariance]>,
    /// The coarser scale's vertical shifts, if they are not the present ones.
    pub(crate) parent_dy: Option<&'a [f32]>,
    /// How far the filters are stretched.
    pub(crate) slopes: &'a Slopes,
}

impl Row<'_> {
    /// Runs the row in the machine's vectors.
    pub(crate) fn dispatch(self) {
        let orientations = self.waves.len();
        // The paper's number of orientations is known to the compiler.
        match (Arch::new(), orientations) {
            #[cfg(target_arch = "x86_64")]
            (Arch::V4(v4), 8) => v4.vectorize(Compiled(self, ByPair(v4))),
            #[cfg(target_arch = "x86_64")]
            (Arch::V4(v4), _) => {
                (*v4).vectorize(Compiled(self, ByPixel::<0, _>(*v4, orientations)));
            }
            #[cfg(target_arch = "x86_64")]
            (Arch::V3(v3), 8) => v3.vectorize(Compiled(self, ByPixel::<8, _>(v3, 8))),
            #[cfg(target_arch = "x86_64")]
            (Arch::V3(v3), _) => v3.vectorize(Compiled(self, ByPixel::<0, _>(v3, orientations))),
            _ => Compiled(self, ByPixel::<0, _>(Scalar, orientations)).call(),
        }
    }
}

/// One row's work, compiled for one way to read.
struct Compiled<'a, R>(Row<'a>, R);

impl<R: Reader> NullaryFnOnce for Compiled<'_, R> {
    type Output = ();

    // Inlined into the function that is compiled for the vector unit; a call would leave it.
    #[inline(always)]
    fn call(self) {
        let Row {
            left,
            waves,
            warp,
            params,
            tile,
            step,
            y,
            dx,
            dy,
            validity,
            residual,
            mut covariance,
            parent_dy,
            slopes,
        } = self.0;
        let reader = self.1;
        let parts = 2 * waves.len();
        for start in (0..dx.len()).step_by(TILE) {
            let end = (start + TILE).min(dx.len());
            let here = start..end;
            let shifts = (&whole(&dx[here.clone()]), &whole(&dy[here.clone()]));
            let at = Along {
                x: start * step,
                y,
                step,
            };
            let left = &left[at.x * parts..];
            let slopes = slopes.of_tile(at);
            let (slopes, threshold) = (slopes.as_ref(), params.energy_threshold);
            reader.read(tile, (left, warp), at, (shifts, slopes), threshold);
            let parent_dy =
                parent_dy.map_or(*shifts.1, |parent_dy| whole(&parent_dy[here.clone()]));
            let fit = tile.fit(reader.simd(), waves, (&parent_dy, shifts.1), params);
            let verdicts = tile.verdicts(&fit, params, at, shifts, warp.size);
            validity[here.clone()].copy_from_slice(&verdicts[..end - start]);
            residual[here.clone()].copy_from_slice(&fit.residual_px[..end - start]);
            add(&mut dx[here.clone()], &fit.ux, &verdicts);
            add(&mut dy[here], &fit.uy, &verdicts);
            if let Some(covariance) = &mut covariance {
                for i in (0..end - start).filter(|&i| verdicts[i].is_valid()) {
                    let [xx, xy, yy] = fit.covariance.map(|entry| entry[i]);
                    let fits = 1.0;
                    covariance[start + i] = FitCovariance { xx, xy, yy, fits };
                }
            }
        }
    }
}

/// Adds the steps that are answers.
#[inline(always)]
fn add(shifts: &mut [f32], steps: &[f32; TILE], verdicts: &[Validity; TILE]) {
    for ((shift, step), verdict) in shifts.iter_mut().zip(steps).zip(verdicts) {
        *shift += if verdict.is_valid() { *step } else { 0.0 };
    }
}
