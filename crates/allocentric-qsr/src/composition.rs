use crate::depth_reference::DepthReference;
use crate::double_cross::within;
use crate::{BaseRelation, Case, Depth, DepthSet, Mode, published};

/// What two distances say about a third, with the calculus that says so.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Composed {
    /// The classes the third distance may be in; empty where the premises contradict each other.
    pub depth: DepthSet,
    /// Where the answer comes from.
    pub mode: Mode,
}

/// Composes two distances whose directions are not known.
///
/// [`Mode::Published`] gives the cells of Tables 2 and 3, [`Mode::Sound`] the triangle
/// inequality, which is the same for cases 1, 2 and 3. CASE 4 gives every class; where the base
/// is known use [`compose_over_base`]. Directions narrow the sound answer; see
/// [`TriangleTable`](crate::TriangleTable).
///
/// # Panics
/// If a set is of a larger reference system.
#[must_use]
pub fn compose(
    reference: &DepthReference,
    case: Case,
    mode: Mode,
    first: DepthSet,
    second: DepthSet,
) -> Composed {
    let cell: fn(&DepthReference, Depth, Depth) -> DepthSet = match (case, mode) {
        (Case::Four, _) => |reference, _, _| reference.all(),
        (Case::One, Mode::Published) => published::sum,
        (Case::Two | Case::Three, Mode::Published) => published::difference,
        (Case::One | Case::Two | Case::Three, Mode::Sound) => triangle_inequality,
    };
    let depth = first
        .iter()
        .flat_map(|i| second.iter().map(move |j| (i, j)))
        .fold(DepthSet::EMPTY, |all, (i, j)| all | cell(reference, i, j));
    Composed { depth, mode }
}

/// CASE 4 with a known base: |ab|, |ac| and |bd| give |ad|.
///
/// |ab| and |ac| give |bc| by CASE 3, |bc| and |bd| give |cd| by CASE 3, and |ac| and |cd| give
/// |ad| by CASE 2.
///
/// # Panics
/// If a set is of a larger reference system.
#[must_use]
pub fn compose_over_base(
    reference: &DepthReference,
    mode: Mode,
    ab: DepthSet,
    ac: DepthSet,
    bd: DepthSet,
) -> Composed {
    let bc = compose(reference, Case::Three, mode, ab, ac);
    let cd = compose(reference, Case::Three, mode, bc.depth, bd);
    compose(reference, Case::Two, mode, ac, cd.depth)
}

/// The classes of the third side of a triangle: more than the difference of the other two, less
/// than their sum. Both bounds are approached and, on half-open classes, at least one interior
/// value of every class between them is attained.
fn triangle_inequality(reference: &DepthReference, first: Depth, second: Depth) -> DepthSet {
    let low = |depth| reference.low_mm(depth);
    let high = |depth| reference.high_mm(depth);
    let beyond = |near: Option<u64>, far: u64| near.map_or(0, |near| far.saturating_sub(near));
    let gap = beyond(high(first), low(second)).max(beyond(high(second), low(first)));
    let sum = high(first).zip(high(second)).map(|(x, y)| x + y);
    let square = |mm: u64| u128::from(mm).pow(2);
    (0..reference.classes().len())
        .map(Depth::of_index)
        .filter(|&class| within(reference, class, square(gap), sum.map(square)))
        .collect()
}
