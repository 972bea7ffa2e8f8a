use crate::dense::wide::Wide;

/// Shifts that are compared side by side; a run of costs is a whole number of these.
pub(crate) const LANES: usize = 32;

/// How badly a pixel of the reference fits each pixel of the other eye that the search allows.
///
/// Implementors hold both eyes' codes with the borders replicated as far as the search reaches, so
/// that a shift out of view costs what the last one in view does.
pub(crate) trait PixelCost: Sync {
    /// What is compared along one row.
    type Row<'a>: RowCost
    where
        Self: 'a;

    /// Row `y` of both eyes.
    fn row(&self, y: usize) -> Self::Row<'_>;

    /// Becomes the same cost seen from the other eye, in mirror images: what was searched to the left
    /// for is again to the left, so the range of shifts stays as it is. Twice is as before.
    fn change_eyes(&mut self);
}

/// A [`PixelCost`] along one row.
pub(crate) trait RowCost: Copy {
    /// The costs of pixel `x` at the `first` shift of the search and those after it, one for each
    /// place of `costs`; the length is a multiple of [`LANES`]. No cost is above
    /// [`StepPenalty::MOST_COST`](crate::dense::step_penalty::StepPenalty::MOST_COST) units.
    fn costs<W: Wide>(self, wide: W, x: usize, first: usize, costs: &mut [u8]);
}
