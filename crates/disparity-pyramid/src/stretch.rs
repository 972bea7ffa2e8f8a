use ndarray::Array2;
use pulp::Simd;
use v1_gabor::{Responses, Size};

use crate::tile::TILE;
use crate::vector::vector;
use crate::warp::Warp;

/// Half the length over which a slope is measured, in pixels. What a filter sees is stretched as a
/// whole, so the slope is that over a filter's width, and the noise of single pixels is not in it.
const REACH: usize = 3;

/// Steepest slope that is a surface's, in pixels a pixel; what is steeper is a step, which stretches
/// nothing.
const STEEPEST: f32 = 0.3;

/// Slopes below this are let be, as they move a shift by less than 0.003 px.
const LEAST_SLOPE: f32 = 0.005;

/// The left eye's responses as filters that are stretched by the slope of the shifts give them.
///
/// Where the shift grows by `A_ij = d d_i / d x_j`, the right image is the left one stretched by
/// `I + A` about the place that is read, and one filter sees two different pieces of the surface.
/// What it says belongs to the place within it where the texture is strongest, a pixel or so beside
/// its middle, so the phase difference errs by the slope times that distance: not on the mean, but
/// over every few pixels by another amount. A left filter `h((I + A) t)` sees the same piece as the
/// right one. To the first order in `A` a Gabor filter of the wave vector `k` becomes
/// `h + sum_ij A_ij t_j d_i h`, and as `t_j h` answers with `sigma^2 (d_j - j k_j) G`, the gain apart
/// its response is
///
/// `G - sigma^2 sum_ij A_ij d_i (d_j - j k_j) G = e - sigma^2 sum_ij A_ij (d_i + j k_i) d_j e`,
///
/// the last with the demodulated response `e`, which is `G` at the pixel itself and slow around it,
/// so that its derivatives are differences between neighbours.
pub(crate) struct Stretch<'a> {
    left: &'a Responses,
    /// The shifts whose slope it is: those before the warp.
    dx: Array2<f32>,
    dy: Array2<f32>,
    sigma_squared: f32,
}

/// How fast a shift grows along x and along y, in pixels a pixel.
type Gradient = [f32; 2];

impl<'a> Stretch<'a> {
    pub(crate) fn new(left: &'a Responses, dx: &Array2<f32>, dy: &Array2<f32>) -> Self {
        Self {
            left,
            dx: dx.clone(),
            dy: dy.clone(),
            sigma_squared: left.params().sigma_px().powi(2),
        }
    }

    /// The samples of the pixels from `(x, y)` on, at most a tile's; they are written to `samples`,
    /// which has room for a tile's. False, and nothing written, if
    /// nothing is stretched there. `warp` knows the
    /// carriers, which are those of both eyes.
    #[inline(always)]
    pub(crate) fn respond<S: Simd>(
        &self,
        simd: S,
        samples: &mut [f32],
        warp: &Warp<'_>,
        (x, y): (usize, usize),
        pixels: usize,
    ) -> bool {
        let slopes = self.slopes((x, y), pixels);
        let mut level = true;
        for slope in &slopes {
            level &= slope.is_none();
        }
        if level {
            return false;
        }
        let orientations = self.left.orientations();
        let parts = 2 * orientations;
        for i in 0..pixels {
            let samples = &mut samples[i * parts..][..parts];
            let at = (x + i, y);
            match slopes[i] {
                None => samples.copy_from_slice(self.pixel(at)),
                Some(slope) => self.stretch(simd, samples, warp, at, slope),
            }
        }
        true
    }

    /// The gradients of both components at each pixel of a tile, where there is a slope.
    #[inline(always)]
    fn slopes(&self, (x, y): (usize, usize), pixels: usize) -> [Option<[Gradient; 2]>; TILE] {
        let Size { width, height } = self.left.size();
        let mut slopes = [None; TILE];
        // At the border there is no neighbour on one side.
        if y == 0 || y + 1 >= height {
            return slopes;
        }
        let (above, below) = (y.saturating_sub(REACH), (y + REACH).min(height - 1));
        for i in 0..pixels {
            let x = x + i;
            if x == 0 || x + 1 >= width {
                continue;
            }
            let (before, after) = (x.saturating_sub(REACH), (x + REACH).min(width - 1));
            let per_x = 1.0 / (after - before) as f32;
            let per_y = 1.0 / (below - above) as f32;
            let mut gradients = [[0.0; 2]; 2];
            let mut steepest = 0.0f32;
            for (gradient, shifts) in gradients.iter_mut().zip([&self.dx, &self.dy]) {
                let along_x = (shifts[[y, after]] - shifts[[y, before]]) * per_x;
                let along_y = (shifts[[below, x]] - shifts[[above, x]]) * per_y;
                *gradient = [along_x, along_y];
                steepest = steepest.max(along_x.abs()).max(along_y.abs());
            }
            if (LEAST_SLOPE..STEEPEST).contains(&steepest) {
                slopes[i] = Some(gradients);
            }
        }
        slopes
    }

    /// The samples of a pixel.
    #[inline(always)]
    fn pixel(&self, (x, y): (usize, usize)) -> &'a [f32] {
        let parts = 2 * self.left.orientations();
        &self.left.samples()[(y * self.left.size().width + x) * parts..][..parts]
    }

    /// The responses at a pixel that is not at the border.
    #[inline(always)]
    fn stretch<S: Simd>(
        &self,
        simd: S,
        out: &mut [f32],
        warp: &Warp<'_>,
        (x, y): (usize, usize),
        slope: [Gradient; 2],
    ) {
        let orientations = self.left.orientations();
        let here = self.pixel((x, y));
        let pairs = [
            (self.pixel((x + 1, y)), self.pixel((x - 1, y))),
            (self.pixel((x, y + 1)), self.pixel((x, y - 1))),
            (self.pixel((x + 1, y + 1)), self.pixel((x - 1, y - 1))),
        ];
        let [[xx, xy], [yx, yy]] = slope;
        // Along the diagonal both second derivatives and twice the mixed one add up.
        let mixed = 0.5 * (xy + yx);
        let second = [xx - mixed, yy - mixed, mixed];
        let first = [(0.5 * xx, 0.5 * yx), (0.5 * xy, 0.5 * yy), (0.0, 0.0)];
        let unchanged = 1.0 + 2.0 * self.sigma_squared * (second[0] + second[1] + second[2]);
        for q in (0..orientations).step_by(S::F32_LANES) {
            let end = (q + S::F32_LANES).min(orientations);
            let (even, odd) = (q..end, orientations + q..orientations + end);
            let share = simd.splat_f32s(unchanged);
            let mut re = simd.mul_f32s(share, simd.partial_load_f32s(&here[even.clone()]));
            let mut im = simd.mul_f32s(share, simd.partial_load_f32s(&here[odd.clone()]));
            for i in 0..3 {
                let (after, before) = pairs[i];
                let after_re = simd.partial_load_f32s(&after[even.clone()]);
                let after_im = simd.partial_load_f32s(&after[odd.clone()]);
                let before_re = simd.partial_load_f32s(&before[even.clone()]);
                let before_im = simd.partial_load_f32s(&before[odd.clone()]);
                let cos = vector(simd, &warp.carriers.turns[i].cos, q);
                let sin = vector(simd, &warp.carriers.turns[i].sin, q);
                // The neighbours are turned by opposite angles, so that one turn takes the sums to
                // the differences and back.
                let sum_re = simd.add_f32s(after_re, before_re);
                let sum_im = simd.add_f32s(after_im, before_im);
                let less_re = simd.sub_f32s(after_re, before_re);
                let less_im = simd.sub_f32s(after_im, before_im);
                let both_re =
                    simd.sub_f32s(simd.mul_f32s(cos, sum_re), simd.mul_f32s(sin, less_im));
                let both_im = simd.mul_add_e_f32s(cos, sum_im, simd.mul_f32s(sin, less_re));
                let curved = simd.splat_f32s(-self.sigma_squared * second[i]);
                re = simd.mul_add_e_f32s(curved, both_re, re);
                im = simd.mul_add_e_f32s(curved, both_im, im);
                if i == 2 {
                    continue;
                }
                let rise_re =
                    simd.sub_f32s(simd.mul_f32s(cos, less_re), simd.mul_f32s(sin, sum_im));
                let rise_im = simd.mul_add_e_f32s(cos, less_im, simd.mul_f32s(sin, sum_re));
                // How fast the carrier's phase grows along the pair.
                let (along_x, along_y) = first[i];
                let along_x = simd.splat_f32s(self.sigma_squared * along_x);
                let along_y = simd.splat_f32s(self.sigma_squared * along_y);
                let grows = simd.mul_add_e_f32s(
                    along_x,
                    vector(simd, &warp.carriers.wave_x, q),
                    simd.mul_f32s(along_y, vector(simd, &warp.carriers.wave_y, q)),
                );
                re = simd.mul_add_e_f32s(grows, rise_im, re);
                im = simd.sub_f32s(im, simd.mul_f32s(grows, rise_re));
            }
            simd.partial_store_f32s(&mut out[even], re);
            simd.partial_store_f32s(&mut out[odd], im);
        }
    }
}
