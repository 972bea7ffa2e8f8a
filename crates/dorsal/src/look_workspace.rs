use egocentric_depth::{LocateWorkspace, SigmaWorkspace};

use crate::EstimatorWorkspace;

/// What [`Dorsal::look_into`](crate::Dorsal::look_into) plans and works in, level by level, kept from look to
/// look. What was seen is not in it. The default has planned nothing yet.
#[derive(Clone, Debug, Default)]
pub struct LookWorkspace {
    /// Levels 1 and 2.
    pub(crate) estimator: EstimatorWorkspace,
    /// Level 3: uncertainties.
    pub(crate) sigma: SigmaWorkspace,
    /// Level 3: objects.
    pub(crate) locate: LocateWorkspace,
}
