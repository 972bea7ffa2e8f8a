use crate::Orientation;
use crate::OrientationSet;
use crate::double_cross::DOUBLE_CROSS;

/// The relations of the double cross that may hold between three points b, c and d: one bit for
/// each row of [`DOUBLE_CROSS`], the label of d at c and that of d at b together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DoubleCrossSet(u16);

impl DoubleCrossSet {
    pub(crate) const ALL: Self = Self((1 << DOUBLE_CROSS.len()) - 1);
    pub(crate) const EMPTY: Self = Self(0);

    /// The rows with one of these labels at c and one of these at b.
    pub(crate) fn of(at_c: OrientationSet, at_b: OrientationSet) -> Self {
        Self::where_row(|p, psi| at_c.contains(p) && at_b.contains(psi))
    }

    fn where_row(holds: impl Fn(Orientation, Orientation) -> bool) -> Self {
        let rows = DOUBLE_CROSS.iter().enumerate();
        rows.filter(|(_, (p, psi))| holds(*p, *psi))
            .fold(Self::EMPTY, |all, (row, _)| all.with(row))
    }

    pub(crate) const fn is_empty(self) -> bool {
        self.0 == 0
    }

    pub(crate) const fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    pub(crate) const fn with(self, row: usize) -> Self {
        Self(self.0 | 1 << row)
    }

    /// The places of the rows in [`DOUBLE_CROSS`].
    pub(crate) fn rows(self) -> impl Iterator<Item = usize> {
        (0..DOUBLE_CROSS.len()).filter(move |row| self.0 >> row & 1 == 1)
    }

    /// The labels of d at c.
    pub(crate) fn at_c(self) -> OrientationSet {
        self.rows().map(|row| DOUBLE_CROSS[row].0).collect()
    }

    /// The labels of d at b.
    pub(crate) fn at_b(self) -> OrientationSet {
        self.rows().map(|row| DOUBLE_CROSS[row].1).collect()
    }

    /// The same three points told from c to b: the way turns round, and so do both labels.
    pub(crate) fn swapped(self) -> Self {
        self.mapped(|p, psi| Self::of(psi.converse().into(), p.converse().into()))
    }

    /// The same three points told from b to d, with c in the place of d. The way from d to c bears
    /// the converse of p against that from b to c, which lies off the way to d by the mirrored psi.
    /// Where d may be b no way leads there, and those rows are left out.
    pub(crate) fn exchanged(self) -> Self {
        self.mapped(|p, psi| {
            if psi == Orientation::None {
                return Self::EMPTY;
            }
            Self::of(p.converse().turned(psi.mirrored()), psi.mirrored().into())
        })
    }

    fn mapped(self, to: impl Fn(Orientation, Orientation) -> Self) -> Self {
        let rows = self.rows().map(|row| DOUBLE_CROSS[row]);
        rows.map(|(p, psi)| to(p, psi))
            .fold(Self::EMPTY, |all, some| Self(all.0 | some.0))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    type Point = (i64, i64);

    /// The row of three points with whole coordinates.
    fn row(b: Point, c: Point, d: Point) -> DoubleCrossSet {
        let front = (c.0 - b.0, c.1 - b.1);
        let label = |from: Point| {
            let way = (d.0 - from.0, d.1 - from.1);
            Orientation::of_offset(
                front.0 * way.0 + front.1 * way.1,
                front.0 * way.1 - front.1 * way.0,
            )
        };
        DoubleCrossSet::of(label(c).into(), label(b).into())
    }

    proptest! {
        /// Three points told another way are the same three points.
        #[test]
        fn the_truth_is_in_every_telling(
            b in (-4i64..5, -4i64..5), c in (-4i64..5, -4i64..5), d in (-4i64..5, -4i64..5),
        ) {
            prop_assume!(b != c);
            let told = row(b, c, d);
            prop_assert_eq!(told.rows().count(), 1);
            prop_assert_eq!(told.swapped(), row(c, b, d));
            if d != b {
                let there = row(b, d, c);
                prop_assert_eq!(told.exchanged().and(there), there);
            } else {
                prop_assert!(told.exchanged().is_empty());
            }
        }
    }
}
