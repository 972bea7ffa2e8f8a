use std::ops::Range;

use ndarray::Array2;
use rayon::prelude::*;
use v1_gabor::Size;

use crate::Validity;
use crate::dense::fitted::{fit, numbers};
use crate::first_false::first_false;

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
        let width = known.ncols();
        let Some(validities) = validity.as_slice() else {
            unreachable!("planes are made in row-major order")
        };
        numbers(&mut known)
            .par_chunks_exact_mut(width)
            .zip(validities.par_chunks_exact(width))
            .for_each(|(known, validity)| {
                for (known, validity) in known.iter_mut().zip(validity) {
                    *known = validity.is_valid();
                }
            });
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
        let start = column + first_false(&known[column..])?;
        let length = known[start..].iter().position(|known| *known);
        let end = length.map_or(known.len(), |length| start + length);
        let before = known[..start].iter().rev().take_while(|known| **known);
        let after = known[end..].iter().take_while(|known| **known);
        let (before, after) = (before.take(BESIDE).count(), after.take(BESIDE).count());
        Some(Hole {
            columns: start..end,
            left: start.checked_sub(1).map(|left| dx[left]),
            right: dx.get(end).copied(),
            left_of_it: median_of(&dx[start - before..start]),
            right_of_it: median_of(&dx[end..end + after]),
        })
    }

    /// How the surface beside a hole at the image's rim goes on into it: `None` for any other hole, or
    /// where too little is known beside it, or that is no slant.
    pub(crate) fn goes_on(&self, y: usize, hole: &Hole) -> Option<Line> {
        let (dx, known) = (self.dx.row(y), self.known.row(y));
        let beside = |columns: &mut dyn Iterator<Item = usize>| {
            let known = columns.filter(|x| known[*x]);
            let (mut places, mut shifts) = (Vec::new(), Vec::new());
            for x in known.take(2 * RUN) {
                places.push(x as f32);
                shifts.push(dx[x]);
            }
            (shifts.len() == 2 * RUN).then_some((places, shifts))
        };
        let (places, shifts) = match (hole.left, hole.right) {
            (None, Some(_)) => beside(&mut (hole.columns.end..dx.len()))?,
            (Some(_), None) => beside(&mut (0..hole.columns.start).rev())?,
            _ => return None,
        };
        let mean = |run: &[f32]| run.iter().sum::<f32>() / RUN as f32;
        let (near, far) = (mean(&places[..RUN]), mean(&places[RUN..]));
        let (shift, farther) = (median_of(&shifts[..RUN])?, median_of(&shifts[RUN..])?);
        let slant = (farther - shift) / (far - near);
        (slant.abs() < MOST_SLANT).then_some(Line {
            x: near,
            dx: shift,
            slant,
        })
    }
}

/// So many known pixels beside a hole say together what is there: the one next to it is the least
/// sure of all.
const BESIDE: usize = 5;

/// Two runs of so many known pixels say how a surface goes on.
const RUN: usize = 12;

/// The steepest slant that goes on, in pixels of shift a pixel: more is the end of a surface.
const MOST_SLANT: f32 = 0.3;

/// The median of at most [`RUN`] shifts, of two in the middle the farther; `None` of none.
fn median_of(shifts: &[f32]) -> Option<f32> {
    let mut sorted = [f32::INFINITY; RUN];
    sorted[..shifts.len()].copy_from_slice(shifts);
    sorted.sort_by(f32::total_cmp);
    (!shifts.is_empty()).then(|| sorted[shifts.len() / 2])
}

/// A slanted surface along a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Line {
    x: f32,
    dx: f32,
    /// Pixels of shift a pixel.
    slant: f32,
}

impl Line {
    /// Its shift at a pixel.
    pub(crate) fn at(self, x: usize) -> f32 {
        self.dx + self.slant * (x as f32 - self.x)
    }
}

/// A run of pixels of one row that are not known, and what is known beside it.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Hole {
    pub(crate) columns: Range<usize>,
    /// The shift to the left and to the right, unless the image ends there.
    pub(crate) left: Option<f32>,
    pub(crate) right: Option<f32>,
    /// The medians of the few known shifts there.
    left_of_it: Option<f32>,
    right_of_it: Option<f32>,
}

impl Hole {
    /// The farther of the surfaces beside it: what lies behind it. `None` if its row knows nothing.
    pub(crate) fn behind(&self) -> Option<f32> {
        match (self.left_of_it, self.right_of_it) {
            (Some(left), Some(right)) => Some(left.max(right)),
            (one, other) => one.or(other),
        }
    }

    /// Whether the image ends on one side of it.
    pub(crate) const fn is_at_rim(&self) -> bool {
        self.left.is_none() || self.right.is_none()
    }
}

/// Whether only this eye sees the place, so that what lies there is what lies behind.
pub(crate) const fn is_hidden(validity: Validity) -> bool {
    matches!(validity, Validity::Occluded | Validity::OutOfView)
}
