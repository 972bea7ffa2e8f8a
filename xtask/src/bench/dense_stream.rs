use disparity_pyramid::{DenseMatcher, DenseParams, DenseWorkspace, DisparityField};
use v1_gabor::Size;

/// The dense estimator, with what it keeps from frame to frame.
pub(super) struct DenseStream {
    pub(super) matcher: DenseMatcher,
    pub(super) workspace: DenseWorkspace,
    pub(super) field: DisparityField,
}

impl DenseStream {
    pub(super) fn plan(params: DenseParams, size: Size) -> anyhow::Result<Self> {
        Ok(Self {
            matcher: DenseMatcher::plan(params, size)?,
            workspace: DenseWorkspace::new(),
            field: DisparityField::default(),
        })
    }
}
