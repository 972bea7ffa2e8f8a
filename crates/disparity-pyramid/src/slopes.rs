use ndarray::Array2;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::tile::{Along, TILE};

/// Steepest slope that is a surface's, in pixels a pixel; what is steeper is a step, along which
/// nothing is stretched.
pub(crate) const STEEPEST: f32 = 0.7;

/// How far the two neighbours are, in pixels of the coarser grid, that a slope is measured against.
const REACH: usize = 2;

/// Slopes below this are let be at the finest scale, as they move a shift by less than 0.01 px.
const LEAST_AT_FINEST: f32 = 0.02;

/// Slopes below this are let be at the other scales: what they move there the next scale mends, and
/// following what is seen of them at once takes density from surfaces that are nearly level
/// (`docs/level-2.md`).
const LEAST_ELSEWHERE: f32 = 0.15;

/// Pixels of the coarser grid of which is known together whether any is followed.
const BLOCK: usize = 16;

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
    /// `A_xx, A_xy, A_yx, A_yy` at the pixels of the coarser grid, a plane each; zeros where nothing is
    /// followed. Empty if nothing is followed anywhere.
    planes: [Vec<f32>; 4],
    /// Whether something is followed within each block of [`BLOCK`] pixels of a row of that grid.
    followed: Vec<bool>,
    width: usize,
    height: usize,
    /// By how much a number of the grid is to be halved to get one of the coarser grid: its
    /// logarithm.
    halvings: u32,
}

/// The slopes at the pixels of a tile, in the order of [`Slopes`].
#[repr(align(64))]
pub(crate) struct TileSlopes(pub(crate) [[f32; TILE]; 4]);

/// The slopes of one row.
#[derive(Clone, Copy)]
pub(crate) struct RowSlopes<'a> {
    planes: [&'a [f32]; 4],
    followed: &'a [bool],
    halvings: u32,
}

impl Slopes {
    /// Nothing is followed.
    pub(crate) fn clear(&mut self) {
        self.followed.clear();
    }

    /// Takes the slopes from the coarser scale's shifts, whose pixels are `step` apart, for a grid of
    /// `scale` that has `1 << halvings` times as many pixels a side.
    pub(crate) fn measure(
        &mut self,
        (dx, dy): (&Array2<f32>, &Array2<f32>),
        step: usize,
        (scale, halvings): (usize, u32),
    ) {
        const CONTIGUOUS: &str = "planes are made in row-major order";
        let (height, width) = dx.dim();
        (self.width, self.height, self.halvings) = (width, height, halvings);
        for plane in &mut self.planes {
            plane.resize(width * height, 0.0);
        }
        let blocks = width.div_ceil(BLOCK);
        self.followed.resize(blocks * height, false);
        let shifts = [dx, dy].map(|plane| plane.as_slice().expect(CONTIGUOUS));
        let least = if scale == 0 {
            LEAST_AT_FINEST
        } else {
            LEAST_ELSEWHERE
        };
        let [xx, xy, yx, yy] = &mut self.planes;
        let of_x = xx.par_chunks_mut(width).zip(xy.par_chunks_mut(width));
        let of_y = yx.par_chunks_mut(width).zip(yy.par_chunks_mut(width));
        of_x.zip(of_y)
            .zip(self.followed.par_chunks_mut(blocks))
            .enumerate()
            .for_each(|(y, (((xx, xy), (yx, yy)), followed))| {
                Arch::new().dispatch(Row {
                    shifts,
                    y,
                    size: (width, height),
                    step: step as f32,
                    least,
                    slopes: [xx, xy, yx, yy],
                    followed,
                });
            });
    }

    /// Those of a row of the grid they were measured for; `None` if there are none.
    #[inline(always)]
    pub(crate) fn of_row(&self, y: usize) -> Option<RowSlopes<'_>> {
        if self.followed.is_empty() {
            return None;
        }
        let (width, row) = (self.width, (y >> self.halvings).min(self.height - 1));
        let blocks = self.followed.len() / self.height;
        Some(RowSlopes {
            planes: [0, 1, 2, 3].map(|n| &self.planes[n][row * width..(row + 1) * width]),
            followed: &self.followed[row * blocks..(row + 1) * blocks],
            halvings: self.halvings,
        })
    }

    /// Those of a tile; `None` if nothing is followed there.
    #[inline(always)]
    pub(crate) fn of_tile(&self, at: Along) -> Option<TileSlopes> {
        let row = self.of_row(at.y / at.step)?;
        let first = at.x / at.step;
        if !row.are_followed(first, TILE) {
            return None;
        }
        let mut slopes = TileSlopes([[0.0; TILE]; 4]);
        for (plane, slopes) in slopes.0.iter_mut().enumerate() {
            row.copy(plane, first, slopes);
        }
        Some(slopes)
    }
}

impl RowSlopes<'_> {
    /// Whether something is followed in the blocks that hold so many pixels of the grid from `x` on.
    #[inline(always)]
    pub(crate) fn are_followed(self, x: usize, pixels: usize) -> bool {
        let last = self.followed.len() - 1;
        let block = |x: usize| ((x >> self.halvings) / BLOCK).min(last);
        self.followed[block(x)..=block(x + pixels - 1)].contains(&true)
    }

    /// The slopes of a plane, in the order of [`Slopes`], at the pixels of the grid from `x` on.
    #[inline(always)]
    pub(crate) fn copy(self, plane: usize, x: usize, out: &mut [f32]) {
        let slopes = self.planes[plane];
        // Whole tiles and vectors begin at even numbers, and most grids have twice the pixels of the coarser one.
        if self.halvings == 1
            && x.is_multiple_of(2)
            && let Some(slopes) = slopes.get(x / 2..(x + out.len()).div_ceil(2))
        {
            let (pairs, rest) = out.as_chunks_mut::<2>();
            for (pair, slope) in pairs.iter_mut().zip(slopes) {
                *pair = [*slope; 2];
            }
            if let ([out], Some(slope)) = (rest, slopes.last()) {
                *out = *slope;
            }
            return;
        }
        let last = slopes.len() - 1;
        for (i, out) in out.iter_mut().enumerate() {
            *out = slopes[((x + i) >> self.halvings).min(last)];
        }
    }
}

/// One row's slopes, while they are measured.
struct Row<'a> {
    /// Every pixel's `dx` and `dy`.
    shifts: [&'a [f32]; 2],
    y: usize,
    /// How many columns and rows of them there are.
    size: (usize, usize),
    /// How far one of them is from the next.
    step: f32,
    least: f32,
    slopes: [&'a mut [f32]; 4],
    followed: &'a mut [bool],
}

impl WithSimd for Row<'_> {
    type Output = ();

    // The loops are compiled for the machine's vectors.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Self {
            shifts,
            y,
            size: (width, height),
            step,
            least,
            slopes: [xx, xy, yx, yy],
            followed,
        } = self;
        let inner = REACH.min(width)..width.saturating_sub(REACH).max(REACH.min(width));
        let per_pixel = 1.0 / (REACH as f32 * step);
        let rows = sides(y, height).map(|side| side.map(|y| y * width..(y + 1) * width));
        let per_row = sides(y, height).map(|side| per_step(side, step));
        for (plane, along_x, along_y) in [
            (shifts[0], &mut *xx, &mut *xy),
            (shifts[1], &mut *yx, &mut *yy),
        ] {
            let row = &plane[y * width..(y + 1) * width];
            for x in inner.clone() {
                let behind = (row[x] - row[x - REACH]) * per_pixel;
                let ahead = (row[x + REACH] - row[x]) * per_pixel;
                along_x[x] = smaller(behind, ahead);
            }
            for x in (0..inner.start).chain(inner.end..width) {
                let [behind, ahead] = sides(x, width)
                    .map(|[from, to]| (row[to] - row[from]) * per_step([from, to], step));
                along_x[x] = smaller(behind, ahead);
            }
            let [behind, ahead] = rows.clone().map(|side| side.map(|row| &plane[row]));
            for x in 0..width {
                let behind = (behind[1][x] - behind[0][x]) * per_row[0];
                let ahead = (ahead[1][x] - ahead[0][x]) * per_row[1];
                along_y[x] = smaller(behind, ahead);
            }
        }
        let blocks = xx
            .chunks_mut(BLOCK)
            .zip(xy.chunks_mut(BLOCK))
            .zip(yx.chunks_mut(BLOCK).zip(yy.chunks_mut(BLOCK)));
        for (((xx, xy), (yx, yy)), followed) in blocks.zip(followed) {
            let mut most = 0.0f32;
            for i in 0..xx.len() {
                let steepest = xx[i]
                    .abs()
                    .max(xy[i].abs())
                    .max(yx[i].abs().max(yy[i].abs()));
                let surface = (steepest >= least) & (steepest < STEEPEST);
                let kept = if surface { 1.0 } else { 0.0 };
                xx[i] *= kept;
                xy[i] *= kept;
                yx[i] *= kept;
                yy[i] *= kept;
                most = most.max(steepest * kept);
            }
            *followed = most > 0.0;
        }
    }
}

/// The smaller one of two slopes, and 0 where they differ in sign.
#[inline(always)]
fn smaller(behind: f32, ahead: f32) -> f32 {
    let nearer = if behind.abs() < ahead.abs() {
        behind
    } else {
        ahead
    };
    if behind * ahead > 0.0 { nearer } else { 0.0 }
}

/// Where the slopes behind and ahead of a place on a line of so many pixels begin and end; at an end of
/// the line both are the one there is.
#[inline(always)]
fn sides(at: usize, length: usize) -> [[usize; 2]; 2] {
    let behind = [at.saturating_sub(REACH), at];
    let ahead = [at, (at + REACH).min(length - 1)];
    if at == 0 {
        [ahead, ahead]
    } else if at + 1 == length {
        [behind, behind]
    } else {
        [behind, ahead]
    }
}

/// What makes a slope of a difference between two places; there is none where they are one.
#[inline(always)]
fn per_step([from, to]: [usize; 2], step: f32) -> f32 {
    1.0 / ((to - from).max(1) as f32 * step)
}
