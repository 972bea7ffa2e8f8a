use crate::depth_reference::DepthReference;
use crate::double_cross::{DOUBLE_CROSS, within};
use crate::{
    BaseRelation, Depth, DepthSet,
    Orientation::{self, BackLeft, FrontLeft, Left, StraightBack, StraightFront},
    OrientationSet, PlaceSet,
};

/// The sound calculus: what may hold between three points b, c and d, planned once for a
/// reference system.
///
/// It relates the distances `x = |bc|`, `y = |cd|`, `r = |bd|` with the label p of d at c and the
/// label psi of d at b, both against the direction from b to c; b and c are two points. It holds
/// exactly the combinations some configuration in the plane has: class k of r is possible when it
/// meets the open interval between the least and the greatest r, which integers decide without
/// rounding. Every sound composition is a projection.
#[derive(Clone, Debug)]
pub struct TriangleTable {
    reference: DepthReference,
    /// The classes of r by class of x, class of y and row of the double cross.
    third_sides: Vec<[DepthSet; 15]>,
}

impl TriangleTable {
    /// The table of this reference system.
    #[must_use]
    pub fn plan(reference: &DepthReference) -> Self {
        let classes = reference.classes().len();
        let third_sides = (0..classes * classes)
            .map(|cell| {
                let first = Span::of(reference, Depth::of_index(cell / classes));
                let second = Span::of(reference, Depth::of_index(cell % classes));
                DOUBLE_CROSS.map(|(at_c, at_b)| third_side(reference, first, second, at_c, at_b))
            })
            .collect();
        Self {
            reference: reference.clone(),
            third_sides,
        }
    }

    /// The reference system of the table.
    #[must_use]
    pub const fn reference(&self) -> &DepthReference {
        &self.reference
    }

    /// The classes of |bd|, given one class each for |bc| and |cd| and one label each for d at
    /// c and at b; empty if no configuration has them.
    ///
    /// # Panics
    /// If a class is of a larger reference system.
    #[must_use]
    pub fn third_side(
        &self,
        bc: Depth,
        cd: Depth,
        at_c: Orientation,
        at_b: Orientation,
    ) -> DepthSet {
        DOUBLE_CROSS
            .into_iter()
            .position(|row| row == (at_c, at_b))
            .map_or(DepthSet::EMPTY, |row| self.cell(bc, cd)[row])
    }

    /// From an observer to two objects, to what lies between the objects (Figure 3): `from` and
    /// `to` are the distances of the two objects from the observer, `turn` the label of the
    /// second at the observer against the direction to the first. Gives the places of the second
    /// object at the first, against the direction from the observer to the first.
    ///
    /// # Panics
    /// If a set is of a larger reference system.
    #[must_use]
    pub fn between(&self, from: DepthSet, to: DepthSet, turn: OrientationSet) -> PlaceSet {
        let mut places = PlaceSet::default();
        for bc in from.iter() {
            for cd in self.reference.all().iter() {
                for (&(at_c, at_b), sides) in DOUBLE_CROSS.iter().zip(self.cell(bc, cd)) {
                    if turn.contains(at_b) && !(*sides & to).is_empty() {
                        places.add(at_c, cd.into());
                    }
                }
            }
        }
        places
    }

    /// CASE 1: c lies at `at_b` of a and b and at |bc| from b, d lies at `at_c` of b and c and
    /// at |cd| from c. Gives the places of d at b, against the direction from a to b.
    ///
    /// # Panics
    /// If a set is of a larger reference system.
    #[must_use]
    pub fn case1(
        &self,
        (at_b, bc): (OrientationSet, DepthSet),
        (at_c, cd): (OrientationSet, DepthSet),
    ) -> PlaceSet {
        let mut places = PlaceSet::default();
        let directed = at_b.without(Orientation::None);
        for (first, second) in pairs(bc, cd) {
            for (&(p, psi), &sides) in DOUBLE_CROSS.iter().zip(self.cell(first, second)) {
                if at_c.contains(p) {
                    for label in directed.turned(psi.into()).iter() {
                        places.add(label, sides);
                    }
                }
            }
        }
        if at_b.contains(Orientation::None) && bc.contains(Depth::FIRST) {
            // c lies at b, so no direction leads from b to c and p says nothing; d is as far
            // from b as from c.
            for label in Orientation::ALL {
                places.add(label, cd);
            }
        }
        places
    }

    /// CASE 2: c lies at `at_b` of a and b and at |ac| from a, d lies at `at_c` of b and c and
    /// at |cd| from c. Gives the classes of |ad|.
    ///
    /// The direction from b to c leaves that from a to c by a turn that `at_b` bounds; the
    /// label of d at c is turned by it.
    ///
    /// # Panics
    /// If a set is of a larger reference system.
    #[must_use]
    pub fn case2(
        &self,
        (at_b, ac): (OrientationSet, DepthSet),
        (at_c, cd): (OrientationSet, DepthSet),
    ) -> DepthSet {
        let at_c = if at_b.contains(Orientation::None) {
            OrientationSet::ALL
        } else {
            at_c.turned(
                at_b.iter()
                    .map(parallax)
                    .fold(OrientationSet::EMPTY, |a, b| a | b),
            )
        };
        self.sides_where(ac, cd, at_c)
    }

    /// CASE 3: d lies at `at_c` of b and c; |bc| and |bd| are known. Gives the classes of |cd|;
    /// none is a contradiction found.
    ///
    /// # Panics
    /// If a set is of a larger reference system.
    #[must_use]
    pub fn case3(&self, bc: DepthSet, bd: DepthSet, at_c: OrientationSet) -> DepthSet {
        self.reference
            .all()
            .iter()
            .filter(|&cd| !(self.sides_where(bc, cd.into(), at_c) & bd).is_empty())
            .collect()
    }

    /// CASE 4 with a known base: c lies at `at_b` of a and b with |ab| and |ac| known, d lies at
    /// `at_c` of b and c at |bd| from b. Gives the classes of |ad|, by CASE 3 twice and CASE 2.
    ///
    /// # Panics
    /// If a set is of a larger reference system.
    #[must_use]
    pub fn case4(
        &self,
        ab: DepthSet,
        (at_b, ac): (OrientationSet, DepthSet),
        (at_c, bd): (OrientationSet, DepthSet),
    ) -> DepthSet {
        let bc = self.case3(ab, ac, at_b);
        let cd = self.case3(bc, bd, at_c);
        let cd = if at_b.contains(Orientation::None) {
            cd | bd
        } else {
            cd
        };
        self.case2((at_b, ac), (at_c, cd))
    }

    /// The classes of |bd| where the label of d at c is one of these, whatever it is at b.
    fn sides_where(&self, bc: DepthSet, cd: DepthSet, at_c: OrientationSet) -> DepthSet {
        pairs(bc, cd)
            .flat_map(|(first, second)| DOUBLE_CROSS.iter().zip(self.cell(first, second)))
            .filter(|((p, _), _)| at_c.contains(*p))
            .fold(DepthSet::EMPTY, |all, (_, &sides)| all | sides)
    }

    fn cell(&self, bc: Depth, cd: Depth) -> &[DepthSet; 15] {
        &self.third_sides[bc.index() * self.reference.classes().len() + cd.index()]
    }
}

fn pairs(first: DepthSet, second: DepthSet) -> impl Iterator<Item = (Depth, Depth)> {
    first
        .iter()
        .flat_map(move |i| second.iter().map(move |j| (i, j)))
}

/// Where the direction from b to c may lie against the direction from a to c, when c lies at
/// `at_b` of a and b.
fn parallax(at_b: Orientation) -> OrientationSet {
    match at_b {
        StraightFront => StraightFront.into(),
        FrontLeft | Left => FrontLeft.into(),
        BackLeft => OrientationSet::from_iter([FrontLeft, Left, BackLeft]),
        StraightBack => OrientationSet::from_iter([StraightFront, StraightBack]),
        Orientation::None => OrientationSet::ALL,
        right => parallax(right.mirrored()).mirrored(),
    }
}

/// The distances of one class, `[low, high)`, in millimetres; no upper bound for the last.
#[derive(Clone, Copy)]
struct Span {
    low: u64,
    high: Option<u64>,
}

impl Span {
    fn of(reference: &DepthReference, class: Depth) -> Self {
        Self {
            low: reference.low_mm(class),
            high: reference.high_mm(class),
        }
    }

    /// Whether some distance of this span is less than some distance of `other`.
    fn begins_below(self, other: Self) -> bool {
        other.high.is_none_or(|high| self.low < high)
    }

    fn overlaps(self, other: Self) -> bool {
        self.begins_below(other) && other.begins_below(self)
    }

    /// How far this span lies above `other`; zero where it does not.
    fn gap_above(self, other: Self) -> u64 {
        other.high.map_or(0, |high| self.low.saturating_sub(high))
    }
}

/// The classes of r, from the least and the greatest side the law of cosines gives over the spans
/// of x and y where d bears these labels at c and at b. No third side attains the greatest. Rows to
/// the right mirror those to the left.
fn third_side(
    reference: &DepthReference,
    x: Span,
    y: Span,
    at_c: Orientation,
    at_b: Orientation,
) -> DepthSet {
    let square = |mm: u64| u128::from(mm).pow(2);
    let sum = || x.high.zip(y.high).map(|(x1, y1)| square(x1 + y1));
    let hypotenuse = || x.high.zip(y.high).map(|(x1, y1)| square(x1) + square(y1));
    let leg = || y.high.map(|y1| square(y1).saturating_sub(square(x.low)));
    // Where the spans do not overlap and y lies above x, x has an upper bound.
    let least_leg = || square(y.low).saturating_sub(x.high.map_or(0, square));
    let classes_between = |low_squared: u128, high_squared: Option<u128>| {
        reference
            .all()
            .iter()
            .filter(|&class| within(reference, class, low_squared, high_squared))
            .collect()
    };
    let rightward = |label: Orientation| {
        use Orientation::{BackRight, FrontRight, Right};
        matches!(label, FrontRight | Right | BackRight)
    };
    if rightward(at_c) {
        return third_side(reference, x, y, at_c.mirrored(), at_b.mirrored());
    }
    match (at_c, at_b) {
        (StraightFront, StraightFront) => classes_between(square(x.low + y.low), sum()),
        (FrontLeft, FrontLeft) => classes_between(square(x.low) + square(y.low), sum()),
        (Left, FrontLeft) => classes_between(square(x.low) + square(y.low), hypotenuse()),
        (BackLeft, FrontLeft) => {
            let least = if x.overlaps(y) {
                0
            } else if x.begins_below(y) {
                least_leg()
            } else {
                square(x.gap_above(y))
            };
            classes_between(least, hypotenuse())
        }
        (BackLeft, Left) if x.begins_below(y) => {
            let least = if x.overlaps(y) { 0 } else { least_leg() };
            classes_between(least, leg())
        }
        (BackLeft, BackLeft) if x.begins_below(y) => classes_between(square(y.gap_above(x)), leg()),
        (StraightBack, StraightFront) if y.begins_below(x) => classes_between(
            square(x.gap_above(y)),
            x.high.map(|x1| square(x1.saturating_sub(y.low))),
        ),
        (StraightBack, StraightBack) if x.begins_below(y) => classes_between(
            square(y.gap_above(x)),
            y.high.map(|y1| square(y1.saturating_sub(x.low))),
        ),
        (StraightBack, Orientation::None) if x.overlaps(y) => Depth::FIRST.into(),
        (Orientation::None, StraightFront) if y.low == 0 => {
            // d lies at c, so r is x.
            reference.qualify_mm(x.low).into()
        }
        _ => DepthSet::EMPTY,
    }
}
