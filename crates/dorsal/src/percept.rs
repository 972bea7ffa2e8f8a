use allocentric_qsr::QualitativeScene;
use disparity_pyramid::{DisparityField, Start};
use egocentric_depth::{DepthMap, EgocentricScene};

/// What one look gave, level by level. The default is that of a look at nothing, to be
/// [written over](crate::Dorsal::look_into).
#[derive(Clone, Debug, Default)]
pub struct Percept {
    /// Vector disparity of every pixel of the left image.
    pub disparity: DisparityField,
    /// Where the vector pyramid's search began, if a coarse look said so
    /// ([`Range`](crate::Range)); else empty.
    pub starts: Vec<Start>,
    /// Depth in metres where the disparity is known.
    pub depth: DepthMap,
    /// Where each labelled object is, in metres from the observer.
    pub egocentric: EgocentricScene,
    /// The same in symbols, and the relations between the objects.
    pub qualitative: QualitativeScene,
}
