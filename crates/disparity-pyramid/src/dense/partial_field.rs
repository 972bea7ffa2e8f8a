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

    /// For every pixel of a row the farther of the nearest known shifts to its left and right: what
    /// lies behind it. Minus infinity if the row knows nothing but the pixel itself.
    pub(crate) fn backgrounds(&self, y: usize) -> Vec<f32> {
        let (dx, known) = (self.dx.row(y), self.known.row(y));
        let (Some(dx), Some(known)) = (dx.to_slice(), known.to_slice()) else {
            unreachable!("planes are made in row-major order")
        };
        let mut behind = vec![f32::NEG_INFINITY; dx.len()];
        let mut nearest = f32::NEG_INFINITY;
        for ((behind, dx), known) in behind.iter_mut().zip(dx).zip(known) {
            *behind = nearest;
            nearest = if *known { *dx } else { nearest };
        }
        nearest = f32::NEG_INFINITY;
        for ((behind, dx), known) in behind.iter_mut().zip(dx).zip(known).rev() {
            *behind = if nearest > *behind { nearest } else { *behind };
            nearest = if *known { *dx } else { nearest };
        }
        behind
    }
}

/// Whether only this eye sees the place, so that what lies there is what lies behind.
pub(crate) const fn is_hidden(validity: Validity) -> bool {
    matches!(validity, Validity::Occluded | Validity::OutOfView)
}
