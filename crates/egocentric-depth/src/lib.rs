//! Metric depth, positions and located objects from the disparity of parallel or vergent eyes.
mod camera_intrinsics;
mod depth_map;
mod label_image;
mod stereo_rig;

pub use camera_intrinsics::CameraIntrinsics;
pub use depth_map::DepthMap;
pub use label_image::{Label, LabelImage};
pub use stereo_rig::{BadRig, StereoRig};
