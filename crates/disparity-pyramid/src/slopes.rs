use ndarray::Array2;
use rayon::prelude::*;

use crate::tile::{Along, TILE};

/// Steepest slope that is a surface's, in pixels a pixel; what is steeper is a step, along which
/// nothing is stretched.
const STEEPEST: f32 = 0.7;

/// How far the two neighbours are, in pixels of the coarser grid, that a slope is measured against.
const REACH: usize = 2;

/// Slopes below this are let be, as they move a shift by less than 0.003 px.
const LEAST: f32 = 0.005;

/// How fast the shifts of the coarser scale grow from pixel to pixel, by which filters are stretched
/// and which medians follow.
///
/// A slope is the smaller one of those to the two sides, and 0 where these differ in sign: beside a
/// step the surface's own, and seldom that of the step.
///
/// Where the shift grows by `A_ij = d d_i / d x_j`, the right image is the left one stretched by
/// `I + A` about the place that is read, and one filter sees two different pieces of the surface.
/// What it says belongs to the place within it where the texture is strongest, a pixel or so beside
/// its middle, so the phase difference errs by the slope times that distance: not on the mean, but
/// over every few pixels by another amount. A right filter `h((I - A) t)` sees the same piece as the
/// left one. To the first order in `A` a Gabor filter of the wave vector `k` becomes
/// `h - sum_ij A_ij t_j d_i h`, and as `t_j h` answers with `sigma^2 (d_j - j k_j) G`, the gain apart
/// its response is, with the demodulated response `e`, which is `G` at the place itself and slow
/// around it,
///
/// `e + sigma^2 sum_ij A_ij (d_i + j k_i) d_j e`.
///
/// The second derivatives are left out: they are the smaller part, and what is read between four
/// pixels has none. The first ones are those of that interpolation itself.
#[derive(Clone, Debug, Default)]
pub(crate) struct Slopes {
    /// `[A_xx, A_xy, A_yx, A_yy]` at the pixels of the coarser grid; zeros where nothing is
    /// stretched. Empty if nothing is stretched anywhere.
    gradients: Vec<[f32; 4]>,
    width: usize,
    /// By how much a number of the grid is to be halved to get one of the coarser grid: its
    /// logarithm.
    halvings: u32,
}

/// The slopes at the pixels of a tile, in the order of [`Slopes`].
#[repr(align(64))]
pub(crate) struct TileSlopes(pub(crate) [[f32; TILE]; 4]);

impl Slopes {
    /// Nothing is stretched.
    pub(crate) fn clear(&mut self) {
        self.gradients.clear();
    }

    /// Takes the slopes from the coarser scale's shifts, whose pixels are `step` apart, for a grid
    /// that has `1 << halvings` times as many pixels a side.
    pub(crate) fn measure(
        &mut self,
        (dx, dy): (&Array2<f32>, &Array2<f32>),
        step: usize,
        halvings: u32,
    ) {
        const CONTIGUOUS: &str = "planes are made in row-major order";
        let (height, width) = dx.dim();
        (self.width, self.halvings) = (width, halvings);
        self.gradients.resize(width * height, [0.0; 4]);
        let planes = [dx, dy].map(|plane| plane.as_slice().expect(CONTIGUOUS));
        self.gradients
            .par_chunks_mut(width)
            .enumerate()
            .for_each(|(y, out)| {
                let (above, below) = around(y, height);
                let rows =
                    planes.map(|plane| [above, y, below].map(|row| &plane[row * width..][..width]));
                for (x, out) in out.iter_mut().enumerate() {
                    let (before, after) = around(x, width);
                    let along_x = |[_, row, _]: [&[f32]; 3]| {
                        slope([before, x, after], [before, x, after].map(|x| row[x]))
                    };
                    let along_y =
                        |rows: [&[f32]; 3]| slope([above, y, below], rows.map(|row| row[x]));
                    let [of_x, of_y] = rows;
                    let slopes = [along_x(of_x), along_y(of_x), along_x(of_y), along_y(of_y)];
                    let slopes = slopes.map(|slope| slope / step as f32);
                    let steepest = slopes
                        .iter()
                        .fold(0.0f32, |most, slope| most.max(slope.abs()));
                    let surface = (LEAST..STEEPEST).contains(&steepest);
                    *out = if surface { slopes } else { [0.0; 4] };
                }
            });
    }

    /// Those of a row of the grid they were measured for, and by how much a column's number is to be
    /// shifted to index them; `None` if there are none.
    #[inline(always)]
    pub(crate) fn of_row(&self, y: usize) -> Option<(&[[f32; 4]], u32)> {
        if self.gradients.is_empty() {
            return None;
        }
        let height = self.gradients.len() / self.width;
        let row = (y >> self.halvings).min(height - 1);
        Some((
            &self.gradients[row * self.width..][..self.width],
            self.halvings,
        ))
    }

    /// Those of a tile; `None` if nothing is stretched there.
    #[inline(always)]
    pub(crate) fn of_tile(&self, at: Along) -> Option<TileSlopes> {
        let (row, halvings) = self.of_row(at.y / at.step)?;
        let first = at.x / at.step;
        let mut slopes = TileSlopes([[0.0; TILE]; 4]);
        let mut steepest = 0.0f32;
        for i in 0..TILE {
            let gradient = row[((first + i) >> halvings).min(row.len() - 1)];
            for n in 0..4 {
                slopes.0[n][i] = gradient[n];
                steepest = steepest.max(gradient[n].abs());
            }
        }
        (steepest > 0.0).then_some(slopes)
    }
}

/// The places of a line of `length` pixels that a slope at one of them is measured against.
#[inline(always)]
fn around(at: usize, length: usize) -> (usize, usize) {
    (at.saturating_sub(REACH), (at + REACH).min(length - 1))
}

/// How fast values grow about the middle one of three places, of which one or both of the outer ones
/// may be the middle one itself, at the end of a line.
#[inline(always)]
fn slope([before, here, after]: [usize; 3], values: [f32; 3]) -> f32 {
    let behind = (values[1] - values[0]) / (here - before).max(1) as f32;
    let ahead = (values[2] - values[1]) / (after - here).max(1) as f32;
    if before == here {
        ahead
    } else if after == here {
        behind
    } else if behind * ahead <= 0.0 {
        0.0
    } else if behind.abs() < ahead.abs() {
        behind
    } else {
        ahead
    }
}
