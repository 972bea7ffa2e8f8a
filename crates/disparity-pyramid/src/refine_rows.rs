use ndarray::Array2;
use rayon::prelude::*;
use v1_gabor::machine::Samples;
use v1_gabor::{Binocular, FilterBank, LumaImage, RowWorkspace, Size, WaveVector};

use crate::refine::Row;
use crate::shift_covariance::FitCovariance;
use crate::shifts::Shifts;
use crate::slopes::Slopes;
use crate::tile::Tile;
use crate::warp::{Carriers, Warp};
use crate::{MatchParams, Validity};

/// Two eyes whose responses at the finest scale are computed row by row.
pub(crate) struct RowEyes<'a> {
    pub(crate) bank: &'a FilterBank,
    pub(crate) images: Binocular<&'a LumaImage>,
    pub(crate) waves: &'a [WaveVector],
    /// How far each pixel that is fitted is from the next, along rows and columns.
    pub(crate) step: usize,
}

/// What one thread keeps of the responses while it walks down its rows.
#[derive(Clone, Debug)]
pub(crate) struct Band {
    workspace: RowWorkspace,
    /// The left eye's row.
    left: Samples,
    /// The right eye's rows that shifts lead to, each in the place of its number modulo theirs, which
    /// is a power of two.
    right: Samples,
    reaches: Vec<Reach>,
    tile: Box<Tile>,
}

/// The first and last row of the right eye that a row's shifts lead to.
type Reach = (usize, usize);

/// The rows of one band in every plane.
struct Planes<'a> {
    dx: &'a mut [f32],
    dy: &'a mut [f32],
    validity: &'a mut [Validity],
    residual: &'a mut [f32],
    covariance: Option<&'a mut [FitCovariance]>,
    slopes: &'a Slopes,
}

/// One warp at the finest scale, as [`refine`](crate::refine::refine) makes it and with the same bits,
/// of shifts that still are the coarser scale's.
pub(crate) fn refine_rows(
    eyes: &RowEyes<'_>,
    shifts: &mut Shifts,
    params: &MatchParams,
    bands: &mut Vec<Band>,
) {
    const CONTIGUOUS: &str = "planes are made in row-major order";
    // Of the pixels that are fitted.
    let (height, width) = shifts.dx.dim();
    bands.resize_with(rayon::current_num_threads(), Band::new);
    let rows = height.div_ceil(bands.len());
    let carriers = Carriers::new(eyes.waves, eyes.bank.params().sigma_px());
    let params = &MatchParams {
        covariance: shifts.covariance.is_some(),
        ..*params
    };
    let numbers = |plane| <Array2<f32>>::as_slice_mut(plane).expect(CONTIGUOUS);
    let planes = (
        numbers(&mut shifts.dx).par_chunks_mut(rows * width),
        numbers(&mut shifts.dy).par_chunks_mut(rows * width),
        numbers(&mut shifts.residual).par_chunks_mut(rows * width),
    );
    let slopes = &shifts.slopes;
    let validity = shifts.validity.as_slice_mut().expect(CONTIGUOUS);
    let bands = planes
        .into_par_iter()
        .zip(validity.par_chunks_mut(rows * width))
        .zip(bands.par_iter_mut())
        .enumerate();
    let walk = |number, band: &mut Band, planes| {
        band.walk(eyes, &carriers, params, number * rows, planes);
    };
    match &mut shifts.covariance {
        None => bands.for_each(|(number, (((dx, dy, residual), validity), band))| {
            let covariance = None;
            let planes = Planes {
                dx,
                dy,
                validity,
                residual,
                covariance,
                slopes,
            };
            walk(number, band, planes);
        }),
        Some(plane) => {
            let plane = plane.as_slice_mut().expect(CONTIGUOUS);
            let bands = bands.zip(plane.par_chunks_mut(rows * width));
            bands.for_each(|((number, (((dx, dy, residual), validity), band)), fits)| {
                let covariance = Some(fits);
                let planes = Planes {
                    dx,
                    dy,
                    validity,
                    residual,
                    covariance,
                    slopes,
                };
                walk(number, band, planes);
            });
        }
    }
}

impl Band {
    fn new() -> Self {
        Self {
            workspace: RowWorkspace::new(),
            left: Samples::zeros(0),
            right: Samples::zeros(0),
            reaches: Vec::new(),
            tile: Box::new(Tile::new()),
        }
    }

    /// Walks down the band's rows of pixels that are fitted, the first one being `from`.
    fn walk(
        &mut self,
        eyes: &RowEyes<'_>,
        carriers: &Carriers,
        params: &MatchParams,
        from: usize,
        planes: Planes<'_>,
    ) {
        let Size { width, height } = eyes.bank.size();
        let stride = width * 2 * eyes.waves.len();
        let samples = width.div_ceil(eyes.step);
        let (mut next, held) = self.survey((planes.dy, samples), (from, eyes.step), height);
        for (samples, rows) in [(&mut self.left, 1), (&mut self.right, held)] {
            if samples.as_slice().len() != rows * stride {
                *samples = Samples::zeros(rows * stride);
            }
        }
        let mut fits = planes.covariance.map(|plane| plane.chunks_mut(samples));
        let shifts = planes
            .dx
            .chunks_mut(samples)
            .zip(planes.dy.chunks_mut(samples));
        let residuals = planes.residual.chunks_mut(samples);
        let answers = planes.validity.chunks_mut(samples).zip(residuals);
        for (i, ((dx, dy), (validity, residual))) in shifts.zip(answers).enumerate() {
            let y = (from + i) * eyes.step;
            while next <= self.reaches[i].1 {
                let place = next & (held - 1);
                let row = &mut self.right.as_mut_slice()[place * stride..][..stride];
                respond(eyes.bank, eyes.images.right, next, &mut self.workspace, row);
                next += 1;
            }
            let row = self.left.as_mut_slice();
            respond(eyes.bank, eyes.images.left, y, &mut self.workspace, row);
            let warp = Warp {
                samples: self.right.as_slice(),
                row_mask: held as u32 - 1,
                size: eyes.bank.size(),
                carriers,
            };
            let row = Row {
                left: self.left.as_slice(),
                waves: eyes.waves,
                warp: &warp,
                params,
                tile: &mut self.tile,
                step: eyes.step,
                y,
                dx,
                dy,
                validity,
                residual,
                covariance: fits.as_mut().and_then(Iterator::next),
                parent_dy: None,
                slopes: planes.slopes,
            };
            row.dispatch();
        }
    }

    /// Finds which rows of the right eye each of the band's rows needs to be there: up to which one,
    /// and, over all rows that follow too, from which one. Gives the first of all, and how many must be
    /// held at once, rounded up to a power of two.
    fn survey(
        &mut self,
        (dy, samples): (&[f32], usize),
        (from, step): (usize, usize),
        height: usize,
    ) -> Reach {
        self.reaches.clear();
        let mut last = 0;
        for (i, dy) in dy.chunks(samples).enumerate() {
            let (least, most) = reach(dy, (from + i) * step, height);
            last = last.max(most);
            self.reaches.push((least, last));
        }
        let (mut first, mut most_held) = (height, 1);
        for reach in self.reaches.iter_mut().rev() {
            first = first.min(reach.0);
            reach.0 = first;
            most_held = most_held.max(reach.1 + 1 - first);
        }
        (first, most_held.next_power_of_two())
    }
}

/// The rows of the right eye, of `height`, that one reads between from row `y` at these shifts.
fn reach(dy: &[f32], y: usize, height: usize) -> Reach {
    let (mut least, mut most) = (f32::INFINITY, f32::NEG_INFINITY);
    for &dy in dy {
        least = if dy < least { dy } else { least };
        most = if dy > most { dy } else { most };
    }
    // The casts saturate: what lies outside is not read.
    let row = |at: f32| (at as usize).min(height - 1);
    (row(y as f32 + least), row((y as f32 + most).floor() + 1.0))
}

/// The responses of one row.
fn respond(
    bank: &FilterBank,
    image: &LumaImage,
    y: usize,
    workspace: &mut RowWorkspace,
    row: &mut [f32],
) {
    let answered = bank.respond_rows_into(image, y, workspace, row);
    debug_assert_eq!(answered, Ok(true), "the matcher's plan saw to that");
}
