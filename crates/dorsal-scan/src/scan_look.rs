use dorsal::Percept;
use dorsal::allocentric_qsr::{Change, ObjectId, SceneMemory};
use dorsal::egocentric_depth::{NoOrientation, RelativeOrientation, StereoRig};
use dorsal::v1_gabor::Binocular;
use ndarray::Array2;
use stereo_scenes::View;

use crate::fixation::Fixation;

/// What the cameras of the head take at a fixation: the simulated part of a look.
#[derive(Clone, Debug)]
pub struct Shown {
    /// Where the head looks, and why.
    pub fixation: Fixation,
    /// The rendered light and its truth.
    pub view: View,
    /// What the cameras deliver: eight bits, red, green and blue.
    pub pictures: Binocular<Array2<[u8; 3]>>,
    /// The eyes as the encoders and the calibration have them.
    pub believed: StereoRig,
}

/// What the robot makes of one fixation.
#[derive(Clone, Debug)]
pub struct ScanLook {
    /// The look, counted from 1.
    pub number: usize,
    /// What the cameras took.
    pub shown: Shown,
    /// The eyes as the images correct them; those believed if the images do not tell.
    pub rig: StereoRig,
    /// How the right eye stands to where the encoders have it; nothing for a head without errors.
    pub drift: Option<Result<RelativeOrientation, NoOrientation>>,
    /// What is seen, level by level.
    pub percept: Percept,
    /// Objects that the edge of the left image cuts: their middle is not in view, so they are not
    /// sighted.
    pub cut: Vec<ObjectId>,
    /// What became different in the memory.
    pub changes: Vec<Change>,
    /// Why the memory refused the look, if it did.
    pub refused: Option<String>,
    /// The memory after the look.
    pub memory: SceneMemory,
    /// What somebody moved just before the look.
    pub moved: Option<String>,
}
