//! Four points of the plane, and whether every composition contains what is true of them. The laws
//! ask it of a few scenes, `cargo xtask check-soundness` of millions.

use allocentric_qsr::{
    Case, Depth, DepthReference, Mode, Orientation, OrientationSet, Place, TriangleTable, compose,
};

/// A point of the plane with whole coordinates, in millimetres.
pub(crate) type Point = (i64, i64);

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
pub(crate) fn answered(
    table: &TriangleTable,
    [a, b, c, d]: [Point; 4],
) -> Result<(), &'static str> {
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
