use std::hint::black_box;

use disparity_pyramid::{
    DenseMatcher, DenseParams, DenseWorkspace, DisparityField, EyeView, SearchRange,
};
use v1_gabor::{Binocular, LumaImage};

use super::contender::Contender;
use super::scene::search;

/// The dense estimator, with what it keeps from frame to frame.
pub(super) struct DenseStream<'a> {
    images: &'a Binocular<LumaImage>,
    search: SearchRange,
    matcher: DenseMatcher,
    workspace: DenseWorkspace,
    field: DisparityField,
}

impl<'a> DenseStream<'a> {
    pub(super) fn plan(
        params: DenseParams,
        images: &'a Binocular<LumaImage>,
    ) -> anyhow::Result<Self> {
        Ok(Self {
            matcher: DenseMatcher::plan(params, images.left.size())?,
            search: search()?,
            workspace: DenseWorkspace::new(),
            field: DisparityField::default(),
            images,
        })
    }
}

impl Contender for DenseStream<'_> {
    fn run(&mut self) -> anyhow::Result<()> {
        let views = self.images.as_ref().map(EyeView::grey);
        let Self {
            matcher,
            search,
            workspace,
            field,
            ..
        } = self;
        matcher.estimate_into(&views, *search, workspace, field)?;
        black_box(field);
        Ok(())
    }
}
