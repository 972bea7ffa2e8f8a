//! Laws of the triangle relation as an algebra: symmetry, order, identity, refinement.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod systems;

use allocentric_qsr::{
    BaseRelation, Case, Depth, DepthReference, DepthSet, Mode, Orientation, OrientationSet,
    PlaceSet, TriangleTable, compose,
};
use proptest::prelude::*;
use systems::systems;

fn depths(reference: &DepthReference, bits: u8) -> DepthSet {
    reference
        .all()
        .iter()
        .filter(|d| bits >> d.index() & 1 == 1)
        .collect()
}

fn labels(bits: u16) -> OrientationSet {
    Orientation::ALL
        .into_iter()
        .filter(|o| bits >> o.index() & 1 == 1)
        .collect()
}

fn is_subset(some: &PlaceSet, all: &PlaceSet) -> bool {
    Orientation::ALL
        .into_iter()
        .all(|o| some.at(o).is_subset(all.at(o)))
}

proptest! {
    /// The three points may change their names: from c, looking back at b, the same triangle has
    /// its sides exchanged and its labels turned round.
    #[test]
    fn the_triangle_does_not_care_who_is_first(reference in systems(1500)) {
        let table = TriangleTable::plan(&reference);
        let all = || reference.all().iter();
        for i in all() {
            for j in all() {
                for k in all() {
                    for p in Orientation::ALL {
                        for psi in Orientation::ALL {
                            let there = table.third_side(i, j, p, psi).contains(k);
                            let back = table.third_side(i, k, psi.converse(), p.converse());
                            prop_assert_eq!(there, back.contains(j));
                        }
                    }
                    // Without labels every order of the three sides is one triangle.
                    let sides = |a: Depth, b: Depth, c| {
                        compose(&reference, Case::One, Mode::Sound, a.into(), b.into()).depth.contains(c)
                    };
                    prop_assert_eq!(sides(i, j, k), sides(j, i, k));
                    prop_assert_eq!(sides(i, j, k), sides(i, k, j));
                }
            }
        }
    }

    /// A wider premise never says more.
    #[test]
    fn compositions_are_monotone(
        reference in systems(1500), bits in any::<[u8; 6]>(), turns in any::<[u16; 4]>(),
    ) {
        let table = TriangleTable::plan(&reference);
        let [x, y, z] = [0, 1, 2].map(|k| depths(&reference, bits[k]));
        let [wx, wy, wz] = [3, 4, 5].map(|k| depths(&reference, bits[k]));
        let [wx, wy, wz] = [x | wx, y | wy, z | wz];
        let [p, q] = [0, 1].map(|k| labels(turns[k]));
        let [wp, wq] = [p | labels(turns[2]), q | labels(turns[3])];
        prop_assert!(is_subset(&table.case1((p, x), (q, y)), &table.case1((wp, wx), (wq, wy))));
        prop_assert!(is_subset(&table.between(x, y, p), &table.between(wx, wy, wp)));
        prop_assert!(table.case2((p, x), (q, y)).is_subset(table.case2((wp, wx), (wq, wy))));
        prop_assert!(table.case3(x, y, p).is_subset(table.case3(wx, wy, wp)));
        let case4 = table.case4(z, (p, x), (q, y));
        prop_assert!(case4.is_subset(table.case4(wz, (wp, wx), (wq, wy))));
    }

    /// What lies at the second point lies where the second point lies; what cannot be composes to
    /// nothing.
    #[test]
    fn none_is_the_identity_and_empty_annihilates(
        reference in systems(1500), bits in any::<u8>(), turns in any::<u16>(),
    ) {
        let table = TriangleTable::plan(&reference);
        let here: DepthSet = Depth::FIRST.into();
        let none: OrientationSet = Orientation::None.into();
        let x = depths(&reference, bits);
        let p = labels(turns).without(Orientation::None);
        let places = table.case1((p, x), (none, here));
        for label in Orientation::ALL {
            let expected = if p.contains(label) { x } else { DepthSet::EMPTY };
            prop_assert_eq!(places.at(label), expected);
        }
        prop_assert_eq!(table.case2((p, x), (none, here)), if p.is_empty() { DepthSet::EMPTY } else { x });
        let nothing = DepthSet::EMPTY;
        prop_assert!(table.case1((p, nothing), (OrientationSet::ALL, x)).is_empty());
        prop_assert!(table.case1((p, x), (OrientationSet::ALL, nothing)).is_empty());
        prop_assert!(table.case1((p, x), (OrientationSet::EMPTY, x)).is_empty());
        prop_assert!(table.case2((p, nothing), (OrientationSet::ALL, x)).is_empty());
        prop_assert!(table.case3(x, nothing, OrientationSet::ALL).is_empty());
        prop_assert!(table.between(x, x, OrientationSet::EMPTY).is_empty());
    }

    /// Told from the other end, against the same direction, a label is its converse; exact on
    /// whole numbers.
    #[test]
    fn the_other_end_gives_the_converse(ahead in -9i32..10, leftward in -9i32..10) {
        let there = Orientation::of_offset(ahead, leftward);
        prop_assert_eq!(Orientation::of_offset(-ahead, -leftward), there.converse());
        prop_assert_eq!(Orientation::of_offset(ahead, -leftward), there.mirrored());
    }
}

/// Every answer of the fine system lies inside the answer of the coarse one.
#[test]
fn drs2_refines_drs1() {
    let (fine, coarse) = (DepthReference::drs2(), DepthReference::drs1());
    let wider = fine.coarsening(&coarse).unwrap();
    let coarsen = |set: DepthSet| set.iter().map(|d| wider[d.index()]).collect::<DepthSet>();
    let tables = [TriangleTable::plan(&fine), TriangleTable::plan(&coarse)];
    for i in fine.all().iter() {
        for j in fine.all().iter() {
            let (wide_i, wide_j) = (wider[i.index()], wider[j.index()]);
            for p in Orientation::ALL {
                for psi in Orientation::ALL {
                    let narrow = coarsen(tables[0].third_side(i, j, p, psi));
                    let wide = tables[1].third_side(wide_i, wide_j, p, psi);
                    assert!(narrow.is_subset(wide), "{i:?} {j:?} {p} {psi}");
                    // What the coarse one claims, some finer classes claim.
                    let within = |k: &Depth, of: Depth| wider[k.index()] == of;
                    let mut all = DepthSet::EMPTY;
                    for a in fine.all().iter().filter(|k| within(k, wide_i)) {
                        for b in fine.all().iter().filter(|k| within(k, wide_j)) {
                            all |= coarsen(tables[0].third_side(a, b, p, psi));
                        }
                    }
                    assert_eq!(all, wide);
                }
            }
        }
    }
}
