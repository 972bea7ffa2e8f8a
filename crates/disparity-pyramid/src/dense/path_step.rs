use crate::dense::pixel_cost::LANES;
use crate::dense::wide::Wide;

/// What stands beside the first and the last shift of a path: no path is dearer.
pub(crate) const FAR: u8 = u8::MAX;

/// The largest penalty, in units of cost, that leaves a cost some steps of a byte.
pub(crate) const MOST_PENALTY: f32 = 50.0;

/// The costs of a path before its first pixel, where nothing has been paid, between two places that
/// cost [`FAR`].
pub(crate) fn unpaid(run: &mut [u8]) {
    run.fill(0);
    if let [first, .., last] = run {
        (*first, *last) = (FAR, FAR);
    }
}

/// One step of a path to its next pixel:
/// `L(d) = C(d) + min(L'(d), L'(d - 1) + P1, L'(d + 1) + P1, min L' + P2) - min L'`.
///
/// `run` holds the path's costs between two places that cost [`FAR`], and is carried on in place;
/// `least` is the least of them. `each` gets every vector of the new costs with its block. Returns
/// the least of the new ones. A place that costs 255 is no shift, and stays as dear.
#[inline(always)]
pub(crate) fn path_step<W: Wide>(
    wide: W,
    run: &mut [u8],
    least: u8,
    (small, large): (u8, u8),
    costs: &[[u8; LANES]],
    mut each: impl FnMut(usize, W::Bytes),
) -> u8 {
    let (base, jump) = (wide.splat(least), wide.splat(least.saturating_add(large)));
    let small = wide.splat(small);
    let mut lowest = wide.splat(FAR);
    let mut below = wide.load(block(run, 0));
    for (i, costs) in costs.iter().enumerate() {
        let place = i * LANES;
        let same = wide.load(block(run, place + 1));
        let above = wide.load(block(run, place + 2));
        let beside = wide.add(wide.min(below, above), small);
        let cheapest = wide.min(wide.min(same, beside), jump);
        let cost = wide.add(wide.sub(cheapest, base), wide.load(costs));
        if i + 1 < run.len() / LANES {
            // Read before the last of it is written over.
            below = wide.load(block(run, place + LANES));
        }
        wide.store(cost, block_mut(run, place + 1));
        lowest = wide.min(lowest, cost);
        each(i, cost);
    }
    wide.least(lowest)
}

#[inline(always)]
fn block(run: &[u8], place: usize) -> &[u8; LANES] {
    run[place..]
        .first_chunk()
        .expect("a run is whole vectors and two")
}

#[inline(always)]
fn block_mut(run: &mut [u8], place: usize) -> &mut [u8; LANES] {
    run[place..]
        .first_chunk_mut()
        .expect("a run is whole vectors and two")
}
