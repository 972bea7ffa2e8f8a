use crate::dense::pixel_cost::LANES;
use crate::dense::wide::Wide;

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
pub(crate) fn path_step<W: Wide>(
    wide: W,
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
    let (base, jump) = (wide.splat(least), wide.splat(least + large));
    let small = wide.splat(small);
    let mut lowest = wide.splat(FAR);
    let runs = below.iter().zip(same).zip(above).zip(costs).zip(next);
    for ((((below, same), above), costs), next) in runs {
        let beside = wide.add(wide.min(wide.load(below), wide.load(above)), small);
        let cheapest = wide.min(wide.min(wide.load(same), beside), jump);
        let cost = wide.add(wide.sub(cheapest, base), wide.load_bytes(costs));
        wide.store(cost, next);
        lowest = wide.min(lowest, cost);
    }
    now[shifts + 1..].fill(FAR);
    wide.least(lowest)
}
