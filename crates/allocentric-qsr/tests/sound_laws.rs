//! The sound calculus: the truth is always in the answer, and the answer holds nothing else.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod systems;

use allocentric_qsr::{
    Case, Depth, DepthReference, Mode, Orientation, OrientationSet, Place, TriangleTable, compose,
};
use proptest::prelude::*;
use systems::{presets, systems};

/// A point of the plane with whole coordinates, in millimetres.
type Point = (i64, i64);

/// The label of `to` at `at`, against the direction from `first` to `second`: signs of a dot and a
/// cross product, exact.
fn label(first: Point, second: Point, at: Point, to: Point) -> Orientation {
    let front = (second.0 - first.0, second.1 - first.1);
    let way = (to.0 - at.0, to.1 - at.1);
    Orientation::of_offset(
        front.0 * way.0 + front.1 * way.1,
        front.0 * way.1 - front.1 * way.0,
    )
}

/// The class of a distance between points of whole coordinates, decided on its square.
fn class(reference: &DepthReference, a: Point, b: Point) -> Depth {
    let squared = ((a.0 - b.0).pow(2) + (a.1 - b.1).pow(2)) as u64;
    reference.qualify_mm(squared.isqrt())
}

/// Whether every composition contains the true relation of four points, a and b apart; the name of
/// one that does not.
fn answered(table: &TriangleTable, [a, b, c, d]: [Point; 4]) -> Result<(), &'static str> {
    let reference = table.reference();
    let distance = |p, q| class(reference, p, q);
    let c_at_b = label(a, b, b, c);
    let d_at_c = label(b, c, c, d);
    // Where c is b no direction leads from b to c, so any label may be told.
    let told = if b == c {
        OrientationSet::ALL
    } else {
        d_at_c.into()
    };
    let holds = |holds: bool, name: &'static str| if holds { Ok(()) } else { Err(name) };
    let truth = Place {
        depth: distance(b, d),
        orientation: label(a, b, b, d),
    };
    let [ab, ac, ad] = [b, c, d].map(|end| distance(a, end));
    let [bc, bd, cd] = [distance(b, c), distance(b, d), distance(c, d)];
    let case1 = table.case1((c_at_b.into(), bc.into()), (told, cd.into()));
    holds(case1.contains(truth), "case 1")?;
    let case2 = table.case2((c_at_b.into(), ac.into()), (told, cd.into()));
    holds(case2.contains(ad), "case 2")?;
    let case4 = table.case4(ab.into(), (c_at_b.into(), ac.into()), (told, bd.into()));
    holds(case4.contains(ad), "case 4")?;
    if b != c {
        let case3 = table.case3(bc.into(), bd.into(), told);
        holds(case3.contains(cd), "case 3")?;
        let d_at_b = label(b, c, b, d);
        let sides = table.third_side(bc, cd, d_at_c, d_at_b);
        holds(sides.contains(bd), "the triangle")?;
        let between = table.between(bc.into(), bd.into(), d_at_b.into());
        let place = Place {
            depth: cd,
            orientation: d_at_c,
        };
        holds(between.contains(place), "ego to allo")?;
    }
    for (case, first, second, third) in [
        (Case::One, bc, cd, bd),
        (Case::Two, ac, cd, ad),
        (Case::Three, bc, bd, cd),
    ] {
        let composed = compose(reference, case, Mode::Sound, first.into(), second.into());
        holds(composed.depth.contains(third), "no labels")?;
    }
    Ok(())
}

/// Three million scenes in each of the paper's systems: `cargo test --release -p allocentric-qsr
/// --test sound_laws -- --ignored --nocapture`.
#[test]
#[ignore = "it takes longer than a suite should"]
fn three_million_scenes() {
    let tables: Vec<TriangleTable> = presets().iter().map(TriangleTable::plan).collect();
    // Knuth's MMIX constants; the upper bits are the good ones.
    let mut state = 1u64;
    let mut below = |bound: u64| {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((state >> 33) % bound) as i64
    };
    for scene in 0..3_000_000u64 {
        // Every other scene on a coarse grid, where rays, right angles and equal points are common.
        let points: [Point; 4] = std::array::from_fn(|_| {
            if scene % 2 == 0 {
                (below(29) * 100, below(29) * 100)
            } else {
                (below(2800), below(2800))
            }
        });
        if points[0] == points[1] {
            continue;
        }
        for table in &tables {
            let name = table.reference().name();
            assert_eq!(answered(table, points), Ok(()), "{name}: {points:?}");
        }
    }
}

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
