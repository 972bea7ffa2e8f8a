use std::collections::BTreeMap;

use super::contestants::{DENSE_BEST, DENSE_FAST, LOOK, NO_LOOK_BACK, ONE_WARP, VECTOR};
use super::report::AtSize;

/// How many times faster than SGBM ours are, and how often a second a whole look is done.
pub(super) fn ratios(sizes: &[AtSize]) -> BTreeMap<&'static str, f64> {
    let nearest = sizes.iter().min_by_key(|at| {
        let area = at.width * at.height;
        area.abs_diff(1024 * 768)
    });
    let cpu = |name: &str| {
        let found = nearest?.contestants.iter().find(|one| one.name == name)?;
        Some(found.cpu_ms)
    };
    let names = [
        ("vector_vs_sgbm", NO_LOOK_BACK),
        ("vector_default_vs_sgbm", VECTOR),
        ("vector_one_warp_vs_sgbm", ONE_WARP),
        ("dense_fast_vs_sgbm", DENSE_FAST),
        ("dense_best_vs_sgbm", DENSE_BEST),
    ];
    let ratio = |(key, name)| Some((key, cpu("SGBM")? / cpu(name)?));
    let looks = nearest.and_then(|at| at.two_threads.iter().find(|one| one.name == LOOK));
    let looks = looks.map(|look| ("looks_per_second", 1e3 / look.wall_ms));
    names.into_iter().filter_map(ratio).chain(looks).collect()
}
