use crate::dense::pixel_cost::LANES;
use crate::dense::search_windows::Window;
use crate::dense::wide::Wide;

/// What a shift costs that no path has come with: no path is dearer.
const FAR: u8 = u8::MAX;

/// The largest penalty, in units of cost, that leaves a cost some steps of a byte.
pub(crate) const MOST_PENALTY: f32 = 50.0;

/// Tells a run of another window of shifts what the one before has found: what only the one before
/// had is forgotten but for its least, what only this one has costs [`FAR`].
#[inline(always)]
pub(crate) fn moved(run: &[u8], from: Window, to: Window, moved: &mut [u8]) {
    moved.fill(FAR);
    let start = from.first.max(to.first);
    let end = (from.first + from.places).min(to.first + to.places);
    if start < end {
        let kept = &run[start - from.first..end - from.first];
        moved[start - to.first..end - to.first].copy_from_slice(kept);
    }
}

/// One step of a path to its next pixel:
/// `L(d) = C(d) + min(L'(d), L'(d - 1) + P1, L'(d + 1) + P1, min L' + P2) - min L'`.
///
/// `run` holds the costs at the pixel before, all 0 before the first, and then those at this one;
/// `least` is the least of the former. `each` gets every vector of the new costs with its number.
/// Returns their least. A place that costs 255 is no shift, and stays as dear.
///
/// Vectors are read as they were written, and neighbours moved in registers: what reads across two
/// fresh writes has to wait until both are in the cache.
#[inline(always)]
pub(crate) fn path_step<W: Wide>(
    wide: W,
    run: &mut [[u8; LANES]],
    least: u8,
    (small, large): (u8, u8),
    costs: &[[u8; LANES]],
    mut each: impl FnMut(usize, W::Bytes),
) -> u8 {
    let (base, jump) = (wide.splat(least), wide.splat(least.saturating_add(large)));
    let small = wide.splat(small);
    let far = wide.splat(FAR);
    let mut lowest = far;
    let mut previous = far;
    let count = costs.len();
    let run = &mut run[..count];
    let Some(first) = run.first() else {
        return FAR;
    };
    let mut same = wide.load(first);
    for i in 0..count {
        let next = if i + 1 < count {
            wide.load(&run[i + 1])
        } else {
            far
        };
        let neighbours = wide.min(wide.after(previous, same), wide.ahead(same, next));
        let beside = wide.add(neighbours, small);
        let cheapest = wide.min(wide.min(same, beside), jump);
        let cost = wide.add(wide.sub(cheapest, base), wide.load(&costs[i]));
        wide.store(cost, &mut run[i]);
        lowest = wide.min(lowest, cost);
        each(i, cost);
        (previous, same) = (same, next);
    }
    wide.least(lowest)
}
