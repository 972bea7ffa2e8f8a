use dorsal::EstimatorWorkspace;
use dorsal::disparity_pyramid::{DisparityField, FromVotes};
use dorsal::egocentric_depth::{DepthMap, LocateWorkspace, SigmaWorkspace};

use crate::sight::Sight;

/// What a [`Plan`](crate::plan::Plan) works in, kept from look to look: from the second look on nothing is
/// planned again. What was seen does not stay in it.
#[derive(Debug, Default)]
pub(crate) struct LookRoom {
    pub(crate) estimator: EstimatorWorkspace,
    /// Where the eyes are matched once more for their drift.
    pub(crate) orienting: EstimatorWorkspace,
    pub(crate) sigma: SigmaWorkspace,
    pub(crate) locate: LocateWorkspace,
    /// Planes to be written over.
    pub(crate) found: FromVotes,
    /// The same, of a field that is carried back from rectified pictures.
    pub(crate) taken: DisparityField,
    pub(crate) depth: DepthMap,
}

impl LookRoom {
    /// Takes back the planes of a look that has been written, for the next one.
    pub(crate) fn take_back(&mut self, sight: Sight) {
        // Where one field was carried back to the pictures, two are in use.
        if self.found.field.size() == sight.disparity.size() {
            self.taken = sight.disparity;
        } else {
            self.found.field = sight.disparity;
        }
        if let Some(depth) = sight.depth {
            self.depth = depth;
        }
    }
}
