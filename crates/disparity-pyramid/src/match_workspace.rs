use ndarray::Array2;

use crate::speckles::Patches;
use crate::track::Track;

/// Buffers that [`estimate_into`](crate::estimate_into) works in, kept from one pair to the next: once
/// they have grown to a size of image, nothing large is allocated for the next pair of that size.
///
/// About 45 bytes a pixel of the image, by the sizes of its planes. What they hold between two pairs means nothing.
#[derive(Clone, Debug, Default)]
pub struct MatchWorkspace {
    /// The way from the left eye to the right one.
    pub(crate) there: Track,
    /// The way back, as far as it is walked.
    pub(crate) back: Track,
    /// How sure the way there is.
    pub(crate) confidence: Array2<f32>,
    /// One where a pixel is valid, 0 where not.
    pub(crate) ones: Array2<u8>,
    pub(crate) patches: Patches,
}

impl MatchWorkspace {
    /// Buffers that have not grown yet.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }
}
