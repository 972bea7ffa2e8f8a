use crate::dense::pixel_cost::LANES;

/// More than any path costs, and little enough that four paths and a penalty add up.
pub(crate) const FAR: i16 = i16::MAX / 8;

/// The largest penalty, in units of cost, that keeps every path below [`FAR`].
pub(crate) const MOST_PENALTY: f32 = 50.0;

/// One step of a path to its next pixel:
/// `L(d) = C(d) + min(L'(d), L'(d - 1) + P1, L'(d + 1) + P1, min L' + P2) - min L'`.
///
/// `before` and `now` hold the runs at the two pixels, each between two places that cost [`FAR`];
/// `least` is the least cost of `before`. Returns the least of `now`. Places from `shifts` on are
/// no shifts, and stay far.
#[inline(always)]
pub(crate) fn path_step(
    before: &[i16],
    least: i16,
    (small, large): (i16, i16),
    costs: &[u8],
    shifts: usize,
    now: &mut [i16],
) -> i16 {
    let places = costs.len();
    let below = before[..places].as_chunks::<LANES>().0;
    let same = before[1..places + 1].as_chunks::<LANES>().0;
    let above = before[2..places + 2].as_chunks::<LANES>().0;
    let costs = costs.as_chunks::<LANES>().0;
    let next = now[1..places + 1].as_chunks_mut::<LANES>().0;
    let jump = least + large;
    let mut lowest = [FAR; LANES];
    let runs = below.iter().zip(same).zip(above).zip(costs).zip(next);
    for ((((below, same), above), costs), next) in runs {
        for lane in 0..LANES {
            let beside = below[lane].min(above[lane]) + small;
            let cheapest = same[lane].min(beside).min(jump);
            let cost = cheapest - least + i16::from(costs[lane]);
            next[lane] = cost;
            lowest[lane] = lowest[lane].min(cost);
        }
    }
    now[shifts + 1..].fill(FAR);
    lowest.into_iter().fold(FAR, i16::min)
}
