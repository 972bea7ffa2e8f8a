//! The triangle table against a twin that knows no geometry but the plane itself: it walks the
//! points of a grid and writes down what it sees.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod systems;

use std::collections::BTreeSet;

use allocentric_qsr::{
    BaseRelation, Case, Depth, DepthReference, Mode, Orientation, TriangleTable, compose,
};
use proptest::prelude::*;
use systems::system;

/// Grid points to a millimetre.
const GRAIN: i64 = 3;

/// Every combination the grid shows, as indices: |bc|, |cd|, label at c, label at b, |bd|.
fn seen(reference: &DepthReference, reach_mm: i64) -> BTreeSet<[usize; 5]> {
    let reach = reach_mm * GRAIN;
    // The class of every distance of the grid, by its square: a walk over the bounds, no root.
    let class = |squared: i64| {
        let within = |from_mm: u32| (i64::from(from_mm) * GRAIN).pow(2) <= squared;
        reference
            .classes()
            .iter()
            .rposition(|k| within(k.from_mm))
            .unwrap()
    };
    let by_square: Vec<usize> = (0..=2 * (2 * reach).pow(2)).map(class).collect();
    let at = |squared: i64| by_square[usize::try_from(squared).unwrap()];
    let mut seen = BTreeSet::new();
    for c in 1..=reach {
        for u in -reach..=reach {
            for v in 0..=reach {
                let ahead = u - c;
                seen.insert([
                    at(c * c),
                    at(ahead * ahead + v * v),
                    Orientation::of_offset(ahead, v).index(),
                    Orientation::of_offset(u, v).index(),
                    at(u * u + v * v),
                ]);
            }
        }
    }
    seen
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    /// What the plane shows, the table claims; and what the table claims of distances alone, the
    /// plane shows, for the open class too.
    #[test]
    fn the_plane_and_the_table_agree(bounds in proptest::collection::btree_set(2u32..14, 0..4)) {
        let top = i64::from(bounds.last().copied().unwrap_or(1));
        let reference = system(bounds);
        let table = TriangleTable::plan(&reference);
        let seen = seen(&reference, 2 * top + 2);
        let depth = Depth::of_index;
        let label = Orientation::of_index;
        for &[i, j, p, psi, k] in &seen {
            let sides = table.third_side(depth(i), depth(j), label(p), label(psi));
            prop_assert!(sides.contains(depth(k)), "{:?}", [i, j, p, psi, k]);
        }
        let sides: BTreeSet<[usize; 3]> = seen.iter().map(|s| [s[0], s[1], s[4]]).collect();
        for i in reference.all().iter() {
            for j in reference.all().iter() {
                let sound = compose(&reference, Case::One, Mode::Sound, i.into(), j.into()).depth;
                for k in sound.iter() {
                    prop_assert!(sides.contains(&[i, j, k].map(BaseRelation::index)), "{i:?} {j:?} {k:?}");
                }
            }
        }
    }
}
