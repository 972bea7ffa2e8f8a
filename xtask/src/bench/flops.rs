use disparity_pyramid::MatchParams;
use v1_gabor::{GaborParams, Size};

/// Floating-point operations of one frame of the vector pyramid, counted from its loops: an addition, a
/// multiplication, a quotient and a root are one each, a fused pair two. Comparisons and choices, thus all
/// medians, and what is done at some pixels only (filters that are stretched along slopes, filling)
/// are left out, so that this is a lower bound.
pub(super) fn vector_flops(size: Size, bank: &GaborParams, params: &MatchParams) -> f64 {
    let sizes = std::iter::successors(Some(size), |size| Some(size.halved())).take(bank.scales);
    let sizes: Vec<Size> = sizes.collect();
    let per_response = response_flops(bank);
    let per_fit = fit_flops(bank.orientations, params);
    // Those of the left eye at the finest scale are asked for in the rows that are fitted alone, if
    // they are needed once (`VectorMatcher::plan`).
    let two_ways = params.left_right_px.is_some();
    let once = params.finest_warps == 1
        && !(two_ways && params.look_back_scale == 0)
        && params.singularity_tau.is_none()
        && bank.scales > 1;
    let mut flops = 0.0;
    for (scale, size) in sizes.iter().enumerate() {
        let area = size.area() as f64;
        let sparse = scale < params.sparse_scales;
        let left = if scale == 0 && once && sparse {
            size.halved().height as f64 / size.height as f64
        } else {
            1.0
        };
        flops += (1.0 + left) * area * per_response;
        if scale > 0 {
            flops += 2.0 * area * REDUCE;
        }
        let fitted = if sparse {
            size.halved().area()
        } else {
            size.area()
        } as f64;
        let there = if scale == 0 {
            params.finest_warps
        } else {
            params.warps
        };
        let back = if two_ways && scale >= params.look_back_scale.min(bank.scales - 1) {
            there.min(params.look_back_warps)
        } else {
            0
        };
        flops += fitted * (there + back) as f64 * per_fit;
    }
    flops
}

/// A pixel of the next coarser scale: five taps down two columns, and five along the row.
const REDUCE: f64 = 2.0 * 10.0 + 10.0;

/// All parts at one pixel. A kernel of `2 r + 1` taps takes the sums and differences of the values at
/// equal distance, `2 r` in all, then `2 r + 1` operations if it is even and `2 r - 1` if it is odd.
/// Of `n` orientations `n / 2 + 1` have an even vertical kernel of their own and `n / 2` an odd one.
/// Across, the wave along x has one row with both kernels, that along y two rows with the even one, and
/// each of the `n / 2 - 1` oblique ones, which serve their mirror images too, two rows with both and four additions.
fn response_flops(bank: &GaborParams) -> f64 {
    let (n, r) = (bank.orientations as f64, bank.radius as f64);
    let (even, odd) = (2.0 * r + 1.0, 2.0 * r - 1.0);
    let down = 2.0 * r + (n / 2.0 + 1.0) * even + n / 2.0 * odd;
    let both = 2.0 * r + even + odd;
    let across = both + 2.0 * (r + even) + (n / 2.0 - 1.0) * (2.0 * both + 4.0);
    down + across
}

/// One warp at one pixel.
fn fit_flops(orientations: usize, params: &MatchParams) -> f64 {
    // Place and shares 10, the pull 1, the verdict and the step 10.
    const PIXEL: f64 = 21.0;
    // Read between four responses 32, the turn 3, the products 12, the angle 13 and its turn 1, the weight
    // 6, wrapped 5.
    const ORIENTATION: f64 = 72.0;
    // A round's normal equations 12 an orientation, and 22 to solve them; 9 to weigh again.
    const EQUATIONS: f64 = 12.0;
    const SOLUTION: f64 = 22.0;
    const WEIGHING: f64 = 9.0;
    // What is left over 4, its cosine 18, three sums 7; and 5 in the end.
    const AGREEMENT: f64 = 29.0;
    const END: f64 = 5.0;
    let n = orientations as f64;
    let again = params.robust_rounds as f64;
    let rounds = (again + 1.0) * (n * EQUATIONS + SOLUTION) + again * n * WEIGHING;
    PIXEL + n * ORIENTATION + rounds + n * AGREEMENT + END
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 10 + 5 * 11 + 4 * 9 down, 30 + 32 + 3 * 64 across; and a warp's 1142.
    #[test]
    fn the_paper_bank_is_counted() {
        assert_eq!(response_flops(&GaborParams::default()), 355.0);
        assert_eq!(fit_flops(8, &MatchParams::default()), 1142.0);
    }

    /// One scale, every pixel, one warp, both eyes.
    #[test]
    fn one_scale_is_counted() {
        let size = Size {
            width: 64,
            height: 48,
        };
        let bank = GaborParams {
            scales: 1,
            ..GaborParams::default()
        };
        let params = MatchParams {
            sparse_scales: 0,
            left_right_px: None,
            ..MatchParams::default()
        };
        let flops = vector_flops(size, &bank, &params) / size.area() as f64;
        assert_eq!(flops, 2.0 * 355.0 + 1142.0);
    }
}
