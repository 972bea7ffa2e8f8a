use std::hint::black_box;

use dorsal::allocentric_qsr::{DepthReference, QualifyParams, QualitativeScene};
use dorsal::sightings;
use egocentric_depth::{DepthMap, EgocentricScene, LocateParams, LocateWorkspace, locate_into};

use super::contender::Contender;
use super::depths::Depths;
use super::scene::Scene;

/// From depths and labels to objects (level 3), and on to relations (level 4).
pub(super) struct Objects<'a> {
    scene: &'a Scene,
    depth: DepthMap,
    workspace: LocateWorkspace,
    egocentric: EgocentricScene,
    qualitative: QualitativeScene,
}

impl<'a> Objects<'a> {
    pub(super) fn plan(scene: &'a Scene) -> anyhow::Result<Self> {
        let mut depths = Depths::plan(scene)?;
        depths.run()?;
        Ok(Self {
            scene,
            depth: depths.depth,
            workspace: LocateWorkspace::default(),
            egocentric: EgocentricScene::default(),
            qualitative: QualitativeScene::default(),
        })
    }
}

impl Contender for Objects<'_> {
    fn run(&mut self) -> anyhow::Result<()> {
        let Self {
            scene,
            depth,
            workspace,
            egocentric,
            qualitative,
        } = self;
        let params = LocateParams::default();
        let room = (workspace, &mut *egocentric);
        locate_into(depth, &scene.labels, &scene.rig, &params, room)?;
        *qualitative = QualitativeScene::qualify_with(
            sightings(egocentric, &scene.names),
            &DepthReference::robot_120(),
            QualifyParams::default(),
        )?;
        black_box(qualitative);
        Ok(())
    }
}
