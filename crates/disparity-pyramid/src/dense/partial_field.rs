use std::ops::Range;

use ndarray::{Array2, Zip};
use v1_gabor::Size;

use crate::Validity;
use crate::dense::fitted::fit;

/// Shifts on the way to a full field: what was found, and what of it counts as known.
#[derive(Clone, Debug)]
pub(crate) struct PartialField {
    /// Shifts in pixels; a losing guess where not known.
    pub(crate) dx: Array2<f32>,
    /// Whether others may rely on the shift.
    pub(crate) known: Array2<bool>,
    /// Why the shift is an answer or not; filling does not change it.
    pub(crate) validity: Array2<Validity>,
}

impl PartialField {
    /// What is found is known where it is valid; `known` is room for it.
    pub(crate) fn new(
        dx: Array2<f32>,
        validity: Array2<Validity>,
        mut known: Array2<bool>,
    ) -> Self {
        fit(&mut known, Size::of_dim(dx.dim()), false);
        Zip::from(&mut known)
            .and(&validity)
            .for_each(|known, validity| *known = validity.is_valid());
        Self {
            dx,
            known,
            validity,
        }
    }

    /// The runs of a row's pixels that are not known, from left to right.
    pub(crate) fn holes(&self, y: usize) -> impl Iterator<Item = Hole> {
        let mut next = 0;
        std::iter::from_fn(move || {
            let hole = self.hole_from(y, next)?;
            next = hole.columns.end;
            Some(hole)
        })
    }

    /// The first run of a row's pixels that are not known, from a column on.
    pub(crate) fn hole_from(&self, y: usize, column: usize) -> Option<Hole> {
        let (dx, known) = (self.dx.row(y), self.known.row(y));
        let (Some(dx), Some(known)) = (dx.to_slice(), known.to_slice()) else {
            unreachable!("planes are made in row-major order")
        };
        let start = column + known[column..].iter().position(|known| !known)?;
        let length = known[start..].iter().position(|known| *known);
        let end = length.map_or(known.len(), |length| start + length);
        Some(Hole {
            columns: start..end,
            left: start.checked_sub(1).map(|left| dx[left]),
            right: dx.get(end).copied(),
        })
    }
}

/// A run of pixels of one row that are not known, and what is known beside it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hole {
    pub(crate) columns: Range<usize>,
    /// The shift to the left and to the right, unless the image ends there.
    pub(crate) left: Option<f32>,
    pub(crate) right: Option<f32>,
}

impl Hole {
    /// The farther of the shifts beside it: what lies behind it. `None` if its row knows nothing.
    pub(crate) fn behind(&self) -> Option<f32> {
        match (self.left, self.right) {
            (Some(left), Some(right)) => Some(left.max(right)),
            (one, other) => one.or(other),
        }
    }
}

/// Whether only this eye sees the place, so that what lies there is what lies behind.
pub(crate) const fn is_hidden(validity: Validity) -> bool {
    matches!(validity, Validity::Occluded | Validity::OutOfView)
}
