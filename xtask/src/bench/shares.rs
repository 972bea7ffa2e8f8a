use disparity_pyramid::MatchParams;
use serde::Serialize;
use v1_gabor::{GaborParams, Size};

use super::ceilings::Ceilings;
use super::contestants::{NO_LOOK_BACK, ONE_WARP, VECTOR};
use super::flops::vector_flops;
use super::report::AtSize;

/// How near a setting of the vector pyramid comes to what a core can do. It is bound by arithmetic where
/// the first part is near 1, and by memory where the second is.
#[derive(Debug, Serialize)]
pub(crate) struct Share {
    pub(crate) name: &'static str,
    /// Operations that its loops ask for (`flops.rs`).
    pub(crate) flops_a_pixel: f64,
    /// What these are a second of CPU time, over the ceiling of fused multiplication.
    pub(crate) of_fma: f64,
    /// Bytes that a frame cannot do without: the images read once, the workspace written and read once.
    pub(crate) least_bytes_a_pixel: f64,
    /// What these are a second of CPU time, over the ceiling of copying.
    pub(crate) of_copy: f64,
}

/// The share that has to be reached.
pub(crate) const MARK: f64 = 0.35;

/// Those at one size.
pub(super) fn shares(at: &AtSize, ceilings: &Ceilings) -> Vec<Share> {
    let size = Size {
        width: at.width,
        height: at.height,
    };
    let bank = GaborParams::default().fitted_to(size);
    let params = MatchParams::default();
    let one_way = MatchParams {
        left_right_px: None,
        ..params
    };
    let settings = [
        (VECTOR, params),
        (NO_LOOK_BACK, one_way),
        (ONE_WARP, MatchParams::one_warp()),
    ];
    let share = |(name, params): (&'static str, MatchParams)| {
        let cpu_ns = at.contestants.iter().find(|one| one.name == name)?;
        let memory = at.memory.iter().find(|one| one.name == name)?;
        let flops_a_pixel = vector_flops(size, &bank, &params) / size.area() as f64;
        let images = (2 * size_of::<f32>()) as f64;
        let least_bytes_a_pixel = images + 2.0 * memory.bytes_a_pixel;
        // Operations a nanosecond are 10^9 a second.
        let a_nanosecond = |amount: f64| amount / cpu_ns.cpu_ns_a_pixel;
        Some(Share {
            name,
            flops_a_pixel,
            of_fma: a_nanosecond(flops_a_pixel) / ceilings.fma_gflops,
            least_bytes_a_pixel,
            of_copy: a_nanosecond(least_bytes_a_pixel) / ceilings.copy_gb_s,
        })
    };
    settings.into_iter().filter_map(share).collect()
}
