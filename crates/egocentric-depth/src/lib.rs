//! Metric depth, positions and located objects from the disparity of parallel or vergent eyes:
//! the third level of the house.
//!
//! A [`StereoRig`] says where the two eyes are and which way they look. With it [`triangulate`]
//! turns a disparity field into a [`DepthMap`], and [`locate`] turns a depth map and a label image
//! into an [`EgocentricScene`]: for each object its place in front of the observer, with the
//! uncertainty that the disparity leaves.
//!
//! ```
//! use disparity_pyramid::{DisparityField, Validity};
//! use egocentric_depth::{
//!     CameraIntrinsics, LabelImage, LocateParams, StereoRig, locate, triangulate,
//! };
//! use ndarray::Array2;
//! use v1_gabor::Binocular;
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! // A head like the paper's: 270 mm between the eyes, which fixate a point 1 m ahead.
//! let eye = CameraIntrinsics { focal_px: (55.0, 55.0), principal_point_px: (31.5, 23.5) };
//! let pan = (0.135_f64 / 1.0).atan();
//! let rig = StereoRig::vergent(
//!     Binocular { left: eye, right: eye },
//!     0.27,
//!     Binocular { left: pan, right: -pan },
//! )?;
//!
//! // What is fixated has no disparity. Here that is a card in the middle of the image.
//! let plane = || Array2::zeros((48, 64));
//! let sure = Array2::ones((48, 64));
//! let valid = Array2::from_elem((48, 64), Validity::Valid);
//! let disparity = DisparityField::new(plane(), plane(), sure, valid)?;
//! let card = Array2::from_shape_fn((48, 64), |(y, x)| {
//!     u16::from((20..28).contains(&y) && (28..36).contains(&x))
//! });
//!
//! let depth = triangulate(&disparity, &rig);
//! let scene = locate(&depth, &LabelImage::new(card), &rig, &LocateParams::default())?;
//! let card = &scene.objects[0];
//! assert!((card.distance_m() - 1.0).abs() < 0.01);
//! assert!((card.bearing_rad() - std::f64::consts::FRAC_PI_2).abs() < 0.01); // straight ahead
//! assert!(card.sigma_m()[2] < 0.02); // a quarter pixel, in metres, with so small an image
//! # Ok(())
//! # }
//! ```
//!
//! # Frames and signs
//! The *head* frame sits midway between the eyes, x right along the baseline, y down, z forward;
//! the *observer* frame is the same, levelled ([`Position`] carries its frame in its type).
//! Pan is positive toward +x, tilt and pitch look up, roll leans clockwise. Depth is the head's z,
//! distance runs over the ground, bearing is 0 to the right and a right angle in front.
//!
//! # Ways to triangulate
//! | eyes | function | form |
//! |---|---|---|
//! | parallel | [`triangulate`] | `Z = f b / (d + doffs)` |
//! | panned | [`triangulate`] | [`general_form`] |
//! | of any [`Attitude`], behind any [`Lens`] | [`triangulate`], [`triangulate_rays`] | [`midpoint`] of two lines of sight |
//! | fixating, on the midline | [`equation_5`] | the paper's equation 5, relative to fixation |
//!
//! # Calibration from the images themselves
//! [`relative_orientation`] finds how the right eye has slipped from its place ([`RigDrift`]) in
//! the vertical component of the disparities. Nothing is kept between looks: the drift is a value
//! that the caller passes on.
mod appearance;
mod attitude;
mod camera_intrinsics;
mod depth_map;
mod depth_sigma;
mod disparity_sigma;
mod drift_belief;
mod egocentric_scene;
mod epipolar_residual;
mod equation_5;
mod eye;
mod footprint;
mod general_form;
mod grown_regions;
mod joined_regions;
mod label_image;
mod lens;
mod locate;
mod midpoint;
mod neighbours;
mod normals;
mod point_cloud;
mod position;
mod reach;
mod rectification;
mod rectified_form;
mod relative_orientation;
mod relative_pose;
mod relief;
mod rig_drift;
mod robust_sample;
mod rotation;
mod roughness;
mod segment;
mod stereo_rig;
mod support_plane;
mod triangulate;
mod triangulate_rays;

pub use attitude::Attitude;
pub use camera_intrinsics::CameraIntrinsics;
pub use depth_map::{DepthMap, WrongPlane};
pub use disparity_sigma::{DisparitySigma, SigmaWorkspace};
pub use drift_belief::{DriftBelief, NoSigma};
pub use egocentric_scene::{EgocentricScene, LocatedObject, UnlocatedObject, WhyUnlocated};
pub use equation_5::{OutOfDomain, equation_5};
pub use eye::{Eye, Ray};
pub use general_form::general_form;
pub use label_image::{Label, LabelImage};
pub use lens::Lens;
pub use locate::{LocateParams, LocateWorkspace, NotLocatable, locate, locate_into};
pub use midpoint::{Midpoint, midpoint};
pub use normals::normals;
pub use point_cloud::{CloudPoint, point_cloud};
pub use position::{Head, Observer, Position};
pub use reach::{Reach, Search, reach_px};
pub use rectification::{Rectification, WrongFieldSize, resampled, resampled_into, resampled_rgb};
pub use relative_orientation::{
    NoOrientation, OrientationParams, RelativeOrientation, relative_orientation,
};
pub use relative_pose::RelativePose;
pub use rig_drift::RigDrift;
pub use rotation::{NoRotation, Rotation};
pub use roughness::{roughness_across_px, roughness_px, scatter};
pub use segment::{NotSegmentable, SegmentParams, Segmentation, segment};
pub use stereo_rig::{BadRig, StereoRig};
pub use support_plane::{NoSupport, SupportParams, SupportPlane};
pub use triangulate::{triangulate, triangulate_guesses, triangulate_into};
pub use triangulate_rays::{RayTriangulation, triangulate_rays};
