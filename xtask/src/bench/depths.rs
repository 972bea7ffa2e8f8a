use std::hint::black_box;

use disparity_pyramid::DisparityField;
use egocentric_depth::{DepthMap, DisparitySigma, SigmaWorkspace, StereoRig, triangulate_into};

use super::contender::Contender;
use super::scene::Scene;

/// The first half of level 3: from a field to the depth of every pixel and its uncertainty.
pub(super) struct Depths<'a> {
    disparity: &'a DisparityField,
    rig: &'a StereoRig,
    workspace: SigmaWorkspace,
    pub(super) depth: DepthMap,
}

impl<'a> Depths<'a> {
    pub(super) fn plan(scene: &'a Scene) -> anyhow::Result<Self> {
        Ok(Self {
            disparity: scene.disparity()?,
            rig: &scene.rig,
            workspace: SigmaWorkspace::default(),
            depth: DepthMap::default(),
        })
    }
}

impl Contender for Depths<'_> {
    fn run(&mut self) -> anyhow::Result<()> {
        let Self {
            disparity,
            rig,
            workspace,
            depth,
        } = self;
        let sigma = DisparitySigma::DENSE_FAST;
        triangulate_into(disparity, rig, &sigma, workspace, depth);
        black_box(depth);
        Ok(())
    }
}
