use crate::dense::pixel_cost::LANES;
use crate::dense::search_windows::Window;
use crate::dense::wide::Wide;

/// What stands beside the first and the last shift of a path: no path is dearer.
pub(crate) const FAR: u8 = u8::MAX;

/// The largest penalty, in units of cost, that leaves a cost some steps of a byte.
pub(crate) const MOST_PENALTY: f32 = 50.0;

/// The costs of a path before its first pixel, where nothing has been paid, between two places that
/// cost [`FAR`].
#[inline(always)]
pub(crate) fn unpaid(run: &mut [u8]) {
    run.fill(0);
    guard(run);
}

/// Sets both ends of a run to [`FAR`].
#[inline(always)]
pub(crate) fn guard(run: &mut [u8]) {
    if let [first, .., last] = run {
        (*first, *last) = (FAR, FAR);
    }
}

/// Tells a run of another window of shifts what the one before has found: what only the one before
/// had is forgotten but for its least, what only this one has costs [`FAR`]. `spare` is overwritten.
#[inline(always)]
pub(crate) fn moved(run: &mut [u8], from: Window, to: Window, spare: &mut [u8]) {
    let moved = &mut spare[..to.places + 2];
    moved.fill(FAR);
    let start = from.first.max(to.first);
    let end = (from.first + from.places).min(to.first + to.places);
    if start < end {
        let kept = &run[1 + start - from.first..1 + end - from.first];
        moved[1 + start - to.first..1 + end - to.first].copy_from_slice(kept);
    }
    run[..to.places + 2].copy_from_slice(moved);
}

/// One step of a path to its next pixel:
/// `L(d) = C(d) + min(L'(d), L'(d - 1) + P1, L'(d + 1) + P1, min L' + P2) - min L'`.
///
/// `before` and `now` hold the runs at the two pixels, each between two places that cost [`FAR`];
/// `least` is the least cost of `before`. `each` gets every vector of the new costs with its number.
/// Returns the least of `now`. A place that costs 255 is no shift, and stays as dear.
#[inline(always)]
pub(crate) fn path_step<W: Wide>(
    wide: W,
    before: &[u8],
    least: u8,
    (small, large): (u8, u8),
    costs: &[[u8; LANES]],
    now: &mut [u8],
    mut each: impl FnMut(usize, W::Bytes),
) -> u8 {
    let places = costs.len() * LANES;
    let below = before[..places].as_chunks::<LANES>().0;
    let same = before[1..places + 1].as_chunks::<LANES>().0;
    let above = before[2..places + 2].as_chunks::<LANES>().0;
    let next = now[1..places + 1].as_chunks_mut::<LANES>().0;
    let (base, jump) = (wide.splat(least), wide.splat(least.saturating_add(large)));
    let small = wide.splat(small);
    let mut lowest = wide.splat(FAR);
    let runs = below.iter().zip(same).zip(above).zip(costs).zip(next);
    for (i, ((((below, same), above), costs), next)) in runs.enumerate() {
        let beside = wide.add(wide.min(wide.load(below), wide.load(above)), small);
        let cheapest = wide.min(wide.min(wide.load(same), beside), jump);
        let cost = wide.add(wide.sub(cheapest, base), wide.load(costs));
        wide.store(cost, next);
        lowest = wide.min(lowest, cost);
        each(i, cost);
    }
    wide.least(lowest)
}
