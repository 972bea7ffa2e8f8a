use std::hint::black_box;

use disparity_pyramid::{DisparityField, MatchParams, VectorMatcher};
use v1_gabor::{Binocular, LumaImage};

use super::contender::Contender;
use super::scene::Scene;

/// The vector pyramid, both levels in one visit.
pub(super) struct Matching<'a> {
    images: &'a Binocular<LumaImage>,
    matcher: VectorMatcher,
    field: DisparityField,
}

impl<'a> Matching<'a> {
    pub(super) fn plan(scene: &'a Scene, params: MatchParams) -> anyhow::Result<Self> {
        Ok(Self {
            images: &scene.verged,
            matcher: VectorMatcher::plan(scene.bank.clone(), params)?,
            field: DisparityField::default(),
        })
    }
}

impl Contender for Matching<'_> {
    fn run(&mut self) -> anyhow::Result<()> {
        self.matcher.estimate_into(self.images, &mut self.field)?;
        black_box(&self.field);
        Ok(())
    }
}
