use ndarray::Array2;
use rayon::prelude::*;

use crate::tile::{Along, TILE};

/// Steepest slope that is a surface's, in pixels a pixel; what is steeper is a step, which stretches
/// nothing.
const STEEPEST: f32 = 0.3;

/// Slopes below this are let be, as they move a shift by less than 0.003 px.
const LEAST: f32 = 0.005;

/// How fast the shifts of the coarser scale grow from pixel to pixel, by which filters are stretched.
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
                let (above, below) = (y.saturating_sub(1), (y + 1).min(height - 1));
                let per_y = 1.0 / ((below - above).max(1) * step) as f32;
                let rows =
                    planes.map(|plane| [above, y, below].map(|row| &plane[row * width..][..width]));
                for (x, out) in out.iter_mut().enumerate() {
                    let (before, after) = (x.saturating_sub(1), (x + 1).min(width - 1));
                    let per_x = 1.0 / ((after - before).max(1) * step) as f32;
                    let [[x_above, x_here, x_below], [y_above, y_here, y_below]] = rows;
                    let slopes = [
                        (x_here[after] - x_here[before]) * per_x,
                        (x_below[x] - x_above[x]) * per_y,
                        (y_here[after] - y_here[before]) * per_x,
                        (y_below[x] - y_above[x]) * per_y,
                    ];
                    let steepest = slopes
                        .iter()
                        .fold(0.0f32, |most, slope| most.max(slope.abs()));
                    let surface = (LEAST..STEEPEST).contains(&steepest);
                    *out = if surface { slopes } else { [0.0; 4] };
                }
            });
    }

    /// Those of a tile; `None` if nothing is stretched there.
    #[inline(always)]
    pub(crate) fn of_tile(&self, at: Along) -> Option<TileSlopes> {
        if self.gradients.is_empty() {
            return None;
        }
        let row = (at.y / at.step) >> self.halvings;
        let first = at.x / at.step;
        let height = self.gradients.len() / self.width;
        let row = &self.gradients[row.min(height - 1) * self.width..][..self.width];
        let mut slopes = TileSlopes([[0.0; TILE]; 4]);
        let mut steepest = 0.0f32;
        for i in 0..TILE {
            let gradient = row[((first + i) >> self.halvings).min(self.width - 1)];
            for n in 0..4 {
                slopes.0[n][i] = gradient[n];
                steepest = steepest.max(gradient[n].abs());
            }
        }
        (steepest > 0.0).then_some(slopes)
    }
}
