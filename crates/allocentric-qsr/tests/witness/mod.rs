//! Integer witnesses for the triangle table: a search, and a check that shares nothing with it.
#![allow(dead_code, reason = "each law uses some of them")]

use allocentric_qsr::{BaseRelation, Depth, DepthReference, Orientation, TriangleTable};

/// Three points with whole coordinates in micrometres: b at the origin, c at `(c, 0)`, d at `d`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Witness {
    pub(crate) c: i64,
    pub(crate) d: (i64, i64),
}

/// What the table may claim: classes of |bc| and |cd|, labels of d at c and at b, class of |bd|.
pub(crate) type Claim = (Depth, Depth, Orientation, Orientation, Depth);

/// What three points are: decided on squares in `u128` and signs in `i128`, nothing rounded.
pub(crate) fn claim_of(reference: &DepthReference, witness: Witness) -> Option<Claim> {
    let Witness { c, d: (u, v) } = witness;
    if c <= 0 {
        return None;
    }
    let square = |n: i64| u128::from(n.unsigned_abs()).pow(2);
    let class = |squared_um: u128| {
        let within = |from_mm: u32| (u128::from(from_mm) * 1000).pow(2) <= squared_um;
        let classes = reference.classes();
        Depth::of_index(classes.iter().rposition(|k| within(k.from_mm)).unwrap_or(0))
    };
    Some((
        class(square(c)),
        class(square(u - c) + square(v)),
        Orientation::of_offset(u - c, v),
        Orientation::of_offset(u, v),
        class(square(u) + square(v)),
    ))
}

/// Everything the table claims of labels on and to the left of the line from b to c; the right
/// mirrors the left, which another law checks.
pub(crate) fn claims(reference: &DepthReference) -> Vec<Claim> {
    let table = TriangleTable::plan(reference);
    let right = [
        Orientation::FrontRight,
        Orientation::Right,
        Orientation::BackRight,
    ];
    let labels: Vec<Orientation> = Orientation::ALL
        .into_iter()
        .filter(|o| !right.contains(o))
        .collect();
    let all = || reference.all().iter();
    let mut claims = Vec::new();
    for i in all() {
        for j in all() {
            for &p in &labels {
                for &psi in &labels {
                    claims.extend(
                        table
                            .third_side(i, j, p, psi)
                            .iter()
                            .map(|k| (i, j, p, psi, k)),
                    );
                }
            }
        }
    }
    claims
}

/// Searches three points for a claim: sides next to the ends of their classes and between, the
/// third point where their circles meet, rounded to whole micrometres and then checked exactly.
pub(crate) fn search(reference: &DepthReference, claim: Claim) -> Option<Witness> {
    let (i, j, p, psi, k) = claim;
    let [xs, ys, rs] = [i, j, k].map(|class| sides(reference, class));
    let found = |c: i64, d: (i64, i64)| {
        let witness = Witness { c, d };
        (claim_of(reference, witness) == Some(claim)).then_some(witness)
    };
    let pairs = |first: &[i64], second: &[i64]| -> Vec<(i64, i64)> {
        let of = |&a: &i64| second.iter().map(move |&b| (a, b)).collect::<Vec<_>>();
        first.iter().flat_map(of).collect()
    };
    if on_a_ray(p) || on_a_ray(psi) {
        // Two sides give the third, whichever two.
        let leg = |long: i64, short: i64| leg(long as f64, short as f64).round() as i64;
        let from_xy = pairs(&xs, &ys).into_iter().map(|(x, y)| match (p, psi) {
            (Orientation::None, _) => (x, (x, 0)),
            (_, Orientation::None) => (x, (0, 0)),
            (Orientation::StraightFront, _) => (x, (x + y, 0)),
            (Orientation::StraightBack, _) => (x, (x - y, 0)),
            (Orientation::Left, _) => (x, (x, y)),
            _ => (x, (0, leg(y, x))),
        });
        let from_xr = pairs(&xs, &rs).into_iter().map(|(x, r)| match (p, psi) {
            (Orientation::StraightBack, Orientation::StraightBack) => (x, (-r, 0)),
            (Orientation::StraightFront | Orientation::StraightBack, _) => (x, (r, 0)),
            (Orientation::Left, _) => (x, (x, leg(r, x))),
            _ => (x, (0, r)),
        });
        let from_yr = pairs(&ys, &rs).into_iter().map(|(y, r)| match (p, psi) {
            (Orientation::StraightFront, _) => (r - y, (r, 0)),
            (Orientation::StraightBack, Orientation::StraightBack) => (y - r, (-r, 0)),
            (Orientation::StraightBack, _) => (r + y, (r, 0)),
            (Orientation::Left, _) => (leg(r, y), (leg(r, y), y)),
            _ => (leg(y, r), (0, r)),
        });
        return from_xy
            .chain(from_xr)
            .chain(from_yr)
            .find_map(|(c, d)| found(c, d));
    }
    for (x, y) in pairs(&xs, &ys) {
        for &r in &rs {
            let [long, y, r] = [x, y, r].map(|side| side as f64);
            let u = ((long * long + r * r - y * y) / (2.0 * long)).round();
            let v = leg(r, u).round() as i64;
            for (du, dv) in [(0, 0), (0, 1), (1, 0), (-1, 0)] {
                if let Some(witness) = found(x, (u as i64 + du, v + dv)) {
                    return Some(witness);
                }
            }
        }
    }
    None
}

fn on_a_ray(label: Orientation) -> bool {
    use Orientation::{BackLeft, BackRight, FrontLeft, FrontRight};
    ![FrontLeft, FrontRight, BackLeft, BackRight].contains(&label)
}

/// The other leg of a right triangle; zero if there is none.
fn leg(long: f64, short: f64) -> f64 {
    (long * long - short * short).max(0.0).sqrt()
}

/// Sides of a class in micrometres: the middle first, then towards both ends, where the bounds of
/// the third side are approached.
fn sides(reference: &DepthReference, class: Depth) -> Vec<i64> {
    let bound = |at: usize| {
        reference
            .classes()
            .get(at)
            .map(|k| i64::from(k.from_mm) * 1000)
    };
    let low = bound(class.index()).unwrap_or(0);
    // The open class reaches beyond the sum of any two bounds.
    let top = i64::from(reference.classes().last().map_or(0, |k| k.from_mm)) * 1000;
    let high = bound(class.index() + 1).unwrap_or(3 * top + 1_000_000);
    let wide = high - low;
    let parts = [
        0.5, 0.25, 0.75, 0.1, 0.9, 0.02, 0.98, 0.003, 0.997, 0.0003, 0.9997,
    ];
    let mut sides: Vec<i64> = parts
        .iter()
        .map(|part| low + (part * wide as f64) as i64)
        .collect();
    sides.extend([
        low,
        low + 1,
        low + 2,
        low + 1000,
        high - 1,
        high - 2,
        high - 3,
        high - 1000,
    ]);
    // The other two classes' bounds, where a long side meets a short one.
    sides.extend(reference.classes().iter().flat_map(|k| {
        let at = i64::from(k.from_mm) * 1000;
        [low + at + 3, high - at - 3, at + low - 2, at + 1000]
    }));
    sides.retain(|side| (low..high).contains(side));
    sides
}
