//! The sound calculus: the truth is always in the answer, and the answer holds nothing else.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod scenes;
mod systems;

use allocentric_qsr::{
    Case, DepthReference, Mode, Orientation, OrientationSet, TriangleTable, compose,
};
use proptest::prelude::*;
use scenes::{Point, answered};
use systems::systems;

fn points() -> impl Strategy<Value = Point> {
    // Few values, so that rays, right angles and equal points are common.
    prop_oneof![
        (-4i64..5, -4i64..5).prop_map(|(x, z)| (x * 100, z * 100)),
        (-900i64..900, -900i64..900),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Every composition contains the true relation of any four points.
    #[test]
    fn the_truth_is_in_every_answer(
        reference in systems(1500), a in points(), b in points(), c in points(), d in points(),
    ) {
        prop_assume!(a != b);
        prop_assert_eq!(answered(&TriangleTable::plan(&reference), [a, b, c, d]), Ok(()));
    }

    /// Exchanging left and right exchanges left and right.
    #[test]
    fn the_table_is_mirrored(reference in systems(1500)) {
        let table = TriangleTable::plan(&reference);
        for i in reference.all().iter() {
            for j in reference.all().iter() {
                for p in Orientation::ALL {
                    for psi in Orientation::ALL {
                        prop_assert_eq!(
                            table.third_side(i, j, p, psi),
                            table.third_side(i, j, p.mirrored(), psi.mirrored())
                        );
                    }
                }
            }
        }
    }

    /// Without labels the triangle says what the triangle inequality says.
    #[test]
    fn the_triangle_inequality_is_a_projection(reference in systems(1500)) {
        let table = TriangleTable::plan(&reference);
        for i in reference.all().iter() {
            for j in reference.all().iter() {
                let inequality = compose(&reference, Case::One, Mode::Sound, i.into(), j.into());
                let any = (OrientationSet::ALL, i.into());
                let projected = table.case2(any, (OrientationSet::ALL, j.into()));
                prop_assert_eq!(projected, inequality.depth);
            }
        }
    }
}

/// Fifteen pairs of labels are possible at two points, the relations of the double cross.
#[test]
fn the_double_cross_has_fifteen_relations() {
    let reference = DepthReference::drs2();
    let table = TriangleTable::plan(&reference);
    let possible = |p, psi| {
        let all = reference.all();
        all.iter().any(|i| {
            all.iter()
                .any(|j| !table.third_side(i, j, p, psi).is_empty())
        })
    };
    let pairs = Orientation::ALL
        .into_iter()
        .flat_map(|p| Orientation::ALL.map(|psi| (p, psi)));
    assert_eq!(pairs.filter(|&(p, psi)| possible(p, psi)).count(), 15);
}
