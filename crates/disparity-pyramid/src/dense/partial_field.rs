use ndarray::Array2;

use crate::Validity;

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
    pub(crate) fn new(dx: Array2<f32>, validity: Array2<Validity>) -> Self {
        Self {
            known: validity.mapv(Validity::is_valid),
            dx,
            validity,
        }
    }

    /// The farther of the nearest known shifts to the left and right on the row: what lies behind.
    /// `None` if the row knows nothing.
    pub(crate) fn background(&self, x: usize, y: usize) -> Option<f32> {
        let (dx, known) = (self.dx.row(y), self.known.row(y));
        let left = (0..x).rev().find(|&x| known[x]);
        let right = (x + 1..dx.len()).find(|&x| known[x]);
        left.into_iter()
            .chain(right)
            .map(|x| dx[x])
            .reduce(f32::max)
    }
}

/// Whether only this eye sees the place, so that what lies there is what lies behind.
pub(crate) const fn is_hidden(validity: Validity) -> bool {
    matches!(validity, Validity::Occluded | Validity::OutOfView)
}
