use dorsal::allocentric_qsr::{Inference, QualitativeScene};
use dorsal::disparity_pyramid::DisparityField;
use dorsal::egocentric_depth::{
    DepthMap, EgocentricScene, NoOrientation, NotSegmentable, RelativeOrientation, StereoRig,
    SupportPlane,
};

use crate::objects::Objects;
use crate::searched::Searched;
use crate::segment_record::SegmentRecord;

/// What one look gave, as far as its plan went.
#[derive(Debug)]
pub(crate) struct Sight {
    pub(crate) disparity: DisparityField,
    /// Where the vector pyramid searched, for itself or for the dense estimator.
    pub(crate) searched: Searched,
    /// The rig that depth was taken with, corrected if that was asked for.
    pub(crate) rig: Option<StereoRig>,
    /// How the right eye has slipped from where the rig has it; nothing without a rig or without
    /// vertical disparities.
    pub(crate) drift: Option<Result<RelativeOrientation, NoOrientation>>,
    pub(crate) depth: Option<DepthMap>,
    /// The objects: those that were given, or those that were found.
    pub(crate) objects: Option<Objects>,
    /// What the found objects stand on, or why none could be looked for; nothing where that was not asked.
    pub(crate) segmented: Option<Result<SupportPlane, NotSegmentable>>,
    pub(crate) scene: Option<Scene>,
}

impl Sight {
    /// What was found without labels, if that was asked.
    pub(crate) fn segments(&self) -> Option<SegmentRecord> {
        let objects = self.objects.as_ref();
        let found = objects.map_or(0, |objects| objects.labels.labels().len());
        let segmented = self.segmented.as_ref()?;
        Some(SegmentRecord::of(segmented, found))
    }
}

/// The objects of a look, in metres and in symbols.
#[derive(Debug)]
pub(crate) struct Scene {
    pub(crate) egocentric: EgocentricScene,
    pub(crate) qualitative: QualitativeScene,
    /// What the paper's composition infers from the places alone.
    pub(crate) published: Inference,
}
