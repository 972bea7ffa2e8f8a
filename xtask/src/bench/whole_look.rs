use std::hint::black_box;

use dorsal::allocentric_qsr::{DepthReference, QualifyParams};
use dorsal::egocentric_depth::LocateParams;
use dorsal::{
    DenseLook, Dorsal, Estimator, LookWorkspace, Percept, Rows, Search,
    disparity_pyramid::{DenseParams, MatchParams},
};

use super::contender::Contender;
use super::scene::Scene;

/// The facade before one frame that is held in memory: all four levels, look after look.
pub(super) struct WholeLook<'a> {
    scene: &'a Scene,
    dorsal: Dorsal,
    percept: Percept,
}

impl<'a> WholeLook<'a> {
    /// With the vector pyramid, which finds the range, and the dense estimator's preset for robots.
    pub(super) fn plan(scene: &'a Scene) -> Self {
        Self {
            dorsal: Dorsal {
                bank: scene.bank.clone(),
                matching: MatchParams::default(),
                estimator: Estimator::Dense(DenseLook {
                    params: DenseParams::fast(),
                    search: Search::Found { most_dx: None },
                    rows: Rows::AsTaken,
                }),
                rig: scene.rig,
                locating: LocateParams::default(),
                reference: DepthReference::robot_120(),
                qualifying: QualifyParams::default(),
                workspace: LookWorkspace::default(),
            },
            scene,
            percept: Percept::default(),
        }
    }
}

impl Contender for WholeLook<'_> {
    fn run(&mut self) -> anyhow::Result<()> {
        let Scene {
            parallel,
            labels,
            names,
            ..
        } = self.scene;
        self.dorsal
            .look_into(parallel, labels, names, &mut self.percept)?;
        black_box(&self.percept);
        Ok(())
    }
}
