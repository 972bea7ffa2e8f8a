use serde::Serialize;

use super::contestants::OURS;
use super::median::median;
use super::report::AtSize;

/// How much the CPU time a pixel of one contestant varies over the sizes.
#[derive(Debug, Serialize)]
pub(crate) struct Spread {
    pub(crate) name: &'static str,
    /// The median time at each size, least and most, in ns a pixel.
    pub(crate) least_ns: f64,
    pub(crate) most_ns: f64,
    /// How far the farthest size is from the median of all, as a part of it.
    pub(crate) beyond_median: f64,
}

/// The most that any size may be from the median.
pub(crate) const MARK: f64 = 0.12;

/// That of every contestant of ours; none of a single size.
pub(super) fn spreads(sizes: &[AtSize]) -> Vec<Spread> {
    if sizes.len() < 2 {
        return Vec::new();
    }
    let spread = |name: &'static str| {
        let found = sizes
            .iter()
            .filter_map(|at| at.contestants.iter().find(|one| one.name == name));
        let times: Vec<f64> = found.map(|one| one.cpu_ns_a_pixel).collect();
        let least_ns = times.iter().copied().fold(f64::INFINITY, f64::min);
        let most_ns = times.iter().copied().fold(0.0, f64::max);
        let middle = middle(times);
        Spread {
            name,
            least_ns,
            most_ns,
            beyond_median: (most_ns - middle).max(middle - least_ns) / middle,
        }
    };
    OURS.map(spread).into()
}

/// The median, of an even number the mean of the two in the middle.
fn middle(mut numbers: Vec<f64>) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let upper = median(numbers.clone());
    if numbers.len().is_multiple_of(2) {
        0.5 * (upper + numbers[numbers.len() / 2 - 1])
    } else {
        upper
    }
}
