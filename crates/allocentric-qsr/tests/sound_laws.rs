//! The sound calculus: the truth is always in the answer, and the answer holds nothing else.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod systems;

use std::f64::consts::{FRAC_PI_2, PI};

use allocentric_qsr::{
    BaseRelation, Case, Depth, DepthReference, Mode, Orientation, OrientationSet, Place,
    TriangleTable, compose,
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
        let table = TriangleTable::plan(&reference);
        let distance = |p, q| class(&reference, p, q);
        let c_at_b = label(a, b, b, c);
        let d_at_c = label(b, c, c, d);
        // Where c is b no direction leads from b to c, so any label may be told.
        let told = if b == c { OrientationSet::ALL } else { d_at_c.into() };
        let truth = Place { depth: distance(b, d), orientation: label(a, b, b, d) };
        let case1 = table.case1((c_at_b.into(), distance(b, c).into()), (told, distance(c, d).into()));
        prop_assert!(case1.contains(truth));
        let case2 = table.case2((c_at_b.into(), distance(a, c).into()), (told, distance(c, d).into()));
        prop_assert!(case2.contains(distance(a, d)));
        let case4 = table.case4(
            distance(a, b).into(), (c_at_b.into(), distance(a, c).into()), (told, distance(b, d).into()),
        );
        prop_assert!(case4.contains(distance(a, d)));
        if b != c {
            let case3 = table.case3(distance(b, c).into(), distance(b, d).into(), told);
            prop_assert!(case3.contains(distance(c, d)));
            let d_at_b = label(b, c, b, d);
            let sides = table.third_side(distance(b, c), distance(c, d), d_at_c, d_at_b);
            prop_assert!(sides.contains(distance(b, d)));
            let between = table.between(distance(b, c).into(), distance(b, d).into(), d_at_b.into());
            let d = Place { depth: distance(c, d), orientation: d_at_c };
            prop_assert!(between.contains(d));
        }
        for (case, first, second, third) in [
            (Case::One, distance(b, c), distance(c, d), distance(b, d)),
            (Case::Two, distance(a, c), distance(c, d), distance(a, d)),
            (Case::Three, distance(b, c), distance(b, d), distance(c, d)),
        ] {
            let composed = compose(&reference, case, Mode::Sound, first.into(), second.into());
            prop_assert!(composed.depth.contains(third));
        }
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

/// Every combination the table claims is met by some triangle, in all four systems.
///
/// The range of the third side over a box of two sides is an interval whose ends are approached at
/// corners of the box, so sides next to the corners and in between, at all turns, meet every
/// class. The finest claim of these systems is 1 cm wide against a grain of 1 micrometre.
#[test]
fn every_claim_has_a_witness() {
    for reference in presets() {
        let table = TriangleTable::plan(&reference);
        let sides = |depth: Depth| {
            let from_mm = f64::from(reference.classes()[depth.index()].from_mm);
            let next = reference.classes().iter().map(|c| f64::from(c.from_mm));
            let upper = next.clone().find(|&b| b > from_mm);
            // The open class needs sides up to where it meets every other, and closer ones next
            // to its bound, where long sides of like length leave a short third.
            let (to_mm, steps) = upper.map_or((from_mm * 3.0, 60), |upper| (upper, 12));
            let grain = 1e-3;
            let sides: Vec<f64> = (1..steps)
                .map(|k| from_mm + (to_mm - from_mm) * (f64::from(k) / f64::from(steps)).powi(2))
                .chain([from_mm + grain, from_mm + 1.0, to_mm - 1.0, to_mm - grain])
                .collect();
            sides
        };
        let at = |i: Depth, j: Depth, p: Orientation, psi: Orientation, k: Depth| {
            let classes = reference.classes().len();
            let labels = p.index() * 9 + psi.index();
            ((i.index() * classes + j.index()) * 81 + labels) * classes + k.index()
        };
        let mut met = vec![false; 81 * reference.classes().len().pow(3)];
        let mut meet = |i, j, p, psi, r_mm: f64| {
            met[at(i, j, p, psi, reference.qualify(r_mm / 1e3).unwrap())] = true;
        };
        for i in reference.all().iter() {
            for j in reference.all().iter() {
                for x in sides(i) {
                    if j == Depth::FIRST {
                        meet(i, j, Orientation::None, Orientation::StraightFront, x);
                    }
                    if i == j {
                        meet(i, j, Orientation::StraightBack, Orientation::None, 0.0);
                    }
                    for y in sides(j) {
                        // Rays of the turn at c and, where |cd| is the longer, at b.
                        let mut turns = vec![(0.0, None), (FRAC_PI_2, None), (PI, None)];
                        turns.extend((1..36).map(|k| (PI * f64::from(k) / 36.0, None)));
                        turns.extend([
                            (1e-4, None),
                            (PI - 1e-4, None),
                            (FRAC_PI_2 - 1e-6, None),
                            (FRAC_PI_2 + 1e-6, None),
                        ]);
                        if x < y {
                            turns.push(((-x / y).acos(), Some(Orientation::Left)));
                            // Just behind the ray at b.
                            turns.push(((-x / y).acos() + 1e-7, None));
                        }
                        for (turn, at_b) in turns {
                            let ahead = if turn == FRAC_PI_2 {
                                0.0
                            } else {
                                y * turn.cos()
                            };
                            let left = if turn == 0.0 || turn == PI {
                                0.0
                            } else {
                                y * turn.sin()
                            };
                            let p = Orientation::of_offset(ahead, left);
                            let psi =
                                at_b.unwrap_or_else(|| Orientation::of_offset(x + ahead, left));
                            let r = (x + ahead).hypot(left);
                            for (p, psi) in [(p, psi), (p.mirrored(), psi.mirrored())] {
                                meet(i, j, p, psi, r);
                            }
                        }
                    }
                }
            }
        }
        for i in reference.all().iter() {
            for j in reference.all().iter() {
                for p in Orientation::ALL {
                    for psi in Orientation::ALL {
                        for k in table.third_side(i, j, p, psi).iter() {
                            assert!(
                                met[at(i, j, p, psi, k)],
                                "{}: no triangle with {i:?} {j:?} {p} {psi} {k:?}",
                                reference.name(),
                            );
                        }
                    }
                }
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
