use std::hint::black_box;

use dorsal::allocentric_qsr::{DepthReference, QualifyParams};
use dorsal::egocentric_depth::{LabelImage, LocateParams};
use dorsal::{
    DenseLook, Dorsal, Estimator, LookWorkspace, Names, Percept, Rows, Search,
    disparity_pyramid::{DenseParams, MatchParams},
};
use stereo_scenes::{Gaze, Room, View};
use v1_gabor::{Binocular, FilterBank, LumaImage};

/// The facade before one frame that is held in memory: all four levels, look after look.
pub(crate) struct WholeLook {
    dorsal: Dorsal,
    eyes: Binocular<LumaImage>,
    labels: LabelImage,
    names: Names,
    percept: Percept,
}

impl WholeLook {
    /// With the vector pyramid, which finds the range, and the dense estimator's preset for robots, before what
    /// a head at `gaze` sees of a room.
    pub(crate) fn plan(room: &Room, gaze: &Gaze, view: View, bank: FilterBank) -> Self {
        let names = room.names().map(|(label, name)| (label, name.to_owned()));
        Self {
            dorsal: Dorsal {
                bank,
                matching: MatchParams::default(),
                estimator: Estimator::Dense(DenseLook {
                    params: DenseParams::fast(),
                    search: Search::Found { most_dx: None },
                    rows: Rows::AsTaken,
                }),
                rig: gaze.rig(),
                locating: LocateParams::default(),
                reference: DepthReference::robot_120(),
                qualifying: QualifyParams::default(),
                workspace: LookWorkspace::default(),
            },
            eyes: view.images,
            labels: view.truth.labels,
            names: names.collect(),
            percept: Percept::default(),
        }
    }

    /// One look, over the one before.
    pub(crate) fn look(&mut self) -> anyhow::Result<()> {
        self.dorsal
            .look_into(&self.eyes, &self.labels, &self.names, &mut self.percept)?;
        black_box(&self.percept);
        Ok(())
    }
}
