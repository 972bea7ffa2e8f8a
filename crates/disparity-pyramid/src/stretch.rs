use ndarray::Array2;
use v1_gabor::{Responses, Size};

use crate::tile::TILE;
use crate::warp::Warp;

/// Half the length over which a slope is measured, in pixels: about a filter's sigma, as what a
/// filter sees is what must be stretched.
const REACH: usize = 2;

/// Steepest slope that is a surface's, in pixels a pixel; beyond it lies a step, which stretches
/// nothing.
const STEEPEST: f32 = 0.3;

/// Slopes below this are let be: they move a shift by less than 0.003 px.
const LEAST_SLOPE: f32 = 0.005;

/// The left eye's responses as filters stretched by the slope of the shifts give them.
///
/// Where the shift grows by `A_ij = d d_i / d x_j`, the right image is the left one stretched by
/// `I + A` around the place that is read, so the same filter sees a different piece of the
/// surface there: one whose middle lies where the texture is strongest, not at the pixel. The phase
/// difference then errs by the slope times the distance between them, half a pixel on the
/// mean. A filter that is stretched likewise sees the same piece. For a Gabor filter of the wave vector
/// `k`, to the first order in `A`, its response follows from those that are there:
///
/// `G - sigma^2 sum_ij A_ij d_i (d_j - j k_j) G = e - sigma^2 sum_ij A_ij (d_i + j k_i) d_j e`
///
/// with the demodulated response `e` on the right, whose derivatives are taken between neighbours, as it is
/// slow. (`t_j d_i h` of a filter `h` has this response, as `t_j h` has `sigma^2 (d_j - j k_j) G`.)
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

    /// The responses of up to a tile's pixels from `(x, y)` on, into `samples`, which has room for
    /// `pixels` of them. `None` if the surface is level there. `warp` knows the carriers, which are those of both
    /// eyes.
    #[inline(always)]
    pub(crate) fn respond<'b>(
        &self,
        samples: &'b mut [f32],
        warp: &Warp<'_>,
        (x, y): (usize, usize),
        pixels: usize,
    ) -> Option<&'b [f32]> {
        let slopes = self.slopes((x, y), pixels);
        if slopes.iter().all(|slope| slope.is_none()) {
            return None;
        }
        let orientations = self.left.orientations();
        let parts = 2 * orientations;
        for (i, samples) in samples.chunks_exact_mut(parts).enumerate().take(pixels) {
            let at = (x + i, y);
            match slopes[i] {
                None => samples.copy_from_slice(self.pixel(at)),
                // The paper's number of orientations is known to the compiler.
                Some(slope) if orientations == 8 => self.stretch::<8>(samples, warp, at, slope),
                Some(slope) => self.stretch::<1>(samples, warp, at, slope),
            }
        }
        Some(samples)
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
        for (i, slope) in slopes.iter_mut().enumerate().take(pixels) {
            let x = x + i;
            if x == 0 || x + 1 >= width {
                continue;
            }
            let (before, after) = (x.saturating_sub(REACH), (x + REACH).min(width - 1));
            let gradient = |shifts: &Array2<f32>| {
                [
                    (shifts[[y, after]] - shifts[[y, before]]) / (after - before) as f32,
                    (shifts[[below, x]] - shifts[[above, x]]) / (below - above) as f32,
                ]
            };
            let both = [gradient(&self.dx), gradient(&self.dy)];
            let steepest = both
                .as_flattened()
                .iter()
                .fold(0.0f32, |most, slope| most.max(slope.abs()));
            if (LEAST_SLOPE..STEEPEST).contains(&steepest) {
                *slope = Some(both);
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

    /// The responses at a pixel that is not at the border, `LANES` orientations at a time.
    #[inline(always)]
    fn stretch<const LANES: usize>(
        &self,
        out: &mut [f32],
        warp: &Warp<'_>,
        (x, y): (usize, usize),
        slope: [Gradient; 2],
    ) {
        let orientations = self.left.orientations();
        let here = self.pixel((x, y));
        let (right, left) = (self.pixel((x + 1, y)), self.pixel((x - 1, y)));
        let (below, above) = (self.pixel((x, y + 1)), self.pixel((x, y - 1)));
        let (ahead, behind) = (self.pixel((x + 1, y + 1)), self.pixel((x - 1, y - 1)));
        let [[xx, xy], [yx, yy]] =
            slope.map(|gradient| gradient.map(|slope| slope * self.sigma_squared));
        for q in (0..orientations).step_by(LANES) {
            let lanes = |numbers: &[f32]| lanes::<LANES>(numbers, q);
            let parts = |pixel: &[f32]| (lanes(pixel), lanes(&pixel[orientations..]));
            let turns = [0, 1, 2].map(|i| (lanes(&warp.turns[i].cos), lanes(&warp.turns[i].sin)));
            let (wave_x, wave_y) = (lanes(&warp.wave_x), lanes(&warp.wave_y));
            let here = parts(here);
            let (right, left) = (parts(right), parts(left));
            let (below, above) = (parts(below), parts(above));
            let (ahead, behind) = (parts(ahead), parts(behind));
            let (mut even, mut odd) = ([0.0; LANES], [0.0; LANES]);
            for i in 0..LANES {
                let at = |(even, odd): ([f32; LANES], [f32; LANES])| (even[i], odd[i]);
                let centre = at(here);
                // Demodulated neighbours on either side: their sum, less the centre, and their difference.
                let pair = |after, before, turn: ([f32; LANES], [f32; LANES])| {
                    let (cos, sin) = at(turn);
                    let (after, before): ((f32, f32), (f32, f32)) = (at(after), at(before));
                    let after = (after.0 * cos - after.1 * sin, after.1 * cos + after.0 * sin);
                    let before = (
                        before.0 * cos + before.1 * sin,
                        before.1 * cos - before.0 * sin,
                    );
                    let first = (0.5 * (after.0 - before.0), 0.5 * (after.1 - before.1));
                    let second = (
                        after.0 + before.0 - 2.0 * centre.0,
                        after.1 + before.1 - 2.0 * centre.1,
                    );
                    (first, second)
                };
                let (along_x, twice_x) = pair(right, left, turns[0]);
                let (along_y, twice_y) = pair(below, above, turns[1]);
                let (_, twice_diagonal) = pair(ahead, behind, turns[2]);
                // How fast the phase grows.
                let phase_x = xx * wave_x[i] + yx * wave_y[i];
                let phase_y = xy * wave_x[i] + yy * wave_y[i];
                // Along the diagonal both second derivatives and twice the mixed one add up.
                let mixed = 0.5 * (xy + yx);
                even[i] = centre.0 + phase_x * along_x.1 + phase_y * along_y.1
                    - ((xx - mixed) * twice_x.0
                        + (yy - mixed) * twice_y.0
                        + mixed * twice_diagonal.0);
                odd[i] = centre.1
                    - phase_x * along_x.0
                    - phase_y * along_y.0
                    - ((xx - mixed) * twice_x.1
                        + (yy - mixed) * twice_y.1
                        + mixed * twice_diagonal.1);
            }
            out[q..q + LANES].copy_from_slice(&even);
            out[orientations + q..][..LANES].copy_from_slice(&odd);
        }
    }
}

/// The numbers from `q` on.
#[inline(always)]
fn lanes<const LANES: usize>(numbers: &[f32], q: usize) -> [f32; LANES] {
    *numbers[q..]
        .first_chunk()
        .expect("whole groups of orientations")
}
