//! What a head sees of the demo's room, and the facade that looks at it.

use dorsal::allocentric_qsr::{DepthReference, QualifyParams};
use dorsal::disparity_pyramid::MatchParams;
use dorsal::egocentric_depth::{LabelImage, LocateParams, StereoRig};
use dorsal::v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};
use dorsal::{Dorsal, Estimator, LookWorkspace, Names};
use stereo_scenes::{Exposure, Gaze, Room, render};

/// One frame in memory.
pub(crate) struct Frame {
    pub(crate) eyes: Binocular<LumaImage>,
    pub(crate) labels: LabelImage,
    pub(crate) names: Names,
    pub(crate) rig: StereoRig,
}

impl Frame {
    /// The room as eyes that converge see it, from a little further to the right.
    pub(crate) fn verged(size: Size, right_m: f64) -> Self {
        let room = Room::demo();
        let mut head = room.head().resized(size);
        head.position_m[0] += right_m;
        Self::of(&room, &head.fixate(room.fixation_m()).unwrap())
    }

    /// The room as parallel eyes see it.
    pub(crate) fn parallel(size: Size, baseline_m: f64) -> Self {
        let room = Room::demo();
        let head = room.head().resized(size);
        let ([_, y, z], [_, to_y, to_z]) = (head.position_m, room.fixation_m());
        let eyes = Binocular {
            left: head.intrinsics(),
            right: head.intrinsics(),
        };
        let rig = StereoRig::parallel(eyes, baseline_m).unwrap();
        let rig = rig.tilted((to_z - z).atan2(to_y - y)).unwrap();
        let gaze = Gaze::new(head.position_m, head.heading_rad, size, rig).unwrap();
        Self::of(&room, &gaze)
    }

    fn of(room: &Room, gaze: &Gaze) -> Self {
        let view = render(room, gaze, Exposure::default()).unwrap();
        let names = room.names().map(|(label, name)| (label, name.to_owned()));
        Self {
            eyes: view.images,
            labels: view.truth.labels,
            names: names.collect(),
            rig: gaze.rig(),
        }
    }

    /// A facade that has not looked yet.
    pub(crate) fn dorsal(&self, estimator: Estimator, matching: MatchParams) -> Dorsal {
        let size = self.eyes.left.size();
        Dorsal {
            bank: FilterBank::plan(GaborParams::default().fitted_to(size), size).unwrap(),
            matching,
            estimator,
            rig: self.rig,
            locating: LocateParams::default(),
            reference: DepthReference::robot_120(),
            qualifying: QualifyParams::default(),
            workspace: LookWorkspace::default(),
        }
    }
}
