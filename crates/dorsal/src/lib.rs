//! From what two eyes see to depth a robot can act on and relations it can remember: the four
//! levels of *dorsal* in one chain.
//!
//! An image pair becomes responses, responses become disparity, disparity becomes depth, depth
//! becomes places, places become relations. [`Dorsal::look`] is that sentence as code, and
//! [`Dorsal::look_into`] says it again and again without planning or allocating anew; beyond that the facade
//! owns nothing. Each level can be used without it: [`v1_gabor`], [`disparity_pyramid`],
//! [`egocentric_depth`] and [`allocentric_qsr`] are re-exported here.
//!
//! ```
//! use std::collections::BTreeMap;
//!
//! use dorsal::allocentric_qsr::{
//!     AllocentricMap, DepthReference, GroundPose, MemoryParams, PoseKnowledge, QualifyParams,
//!     RobotPose, SceneMemory,
//! };
//! use dorsal::{Dorsal, Estimator, LookWorkspace, Range, Stand};
//! use dorsal::disparity_pyramid::MatchParams;
//! use dorsal::egocentric_depth::{CameraIntrinsics, LabelImage, LocateParams, StereoRig};
//! use dorsal::v1_gabor::{Binocular, FilterBank, GaborParams, LumaImage, Size};
//! use ndarray::Array2;
//!
//! // A textured wall, 20 px nearer than infinity for eyes 0.1 m apart with f = 200 px: 1 m away.
//! let size = Size { width: 160, height: 120 };
//! let texture = |x: f32, y: f32| -> f32 {
//!     let wave = |i: f32| (0.15 + 0.12 * i) * (x * (2.4 * i).cos() + y * (2.4 * i).sin());
//!     (0..16u8).map(|i| wave(f32::from(i)).sin()).sum()
//! };
//! let image = |shift: f32| {
//!     LumaImage::new(Array2::from_shape_fn(size.dim(), |(y, x)| {
//!         0.5 + 0.05 * texture(x as f32 + shift, y as f32)
//!     }))
//! };
//! let eyes = Binocular { left: image(0.0)?, right: image(20.0)? };
//!
//! let camera = CameraIntrinsics { focal_px: (200.0, 200.0), principal_point_px: (79.5, 59.5) };
//! let dorsal = Dorsal {
//!     bank: FilterBank::plan(GaborParams::default().fitted_to(size), size)?,
//!     matching: MatchParams { zero_disparity_px: (-16.0, 0.0), ..MatchParams::default() },
//!     estimator: Estimator::Vector(Range::Given),
//!     rig: StereoRig::parallel(Binocular { left: camera, right: camera }, 0.1)?,
//!     locating: LocateParams::default(),
//!     reference: DepthReference::robot_120(),
//!     qualifying: QualifyParams::default(),
//!     workspace: LookWorkspace::default(),
//! };
//!
//! // One object, marked by hand in the left image.
//! let poster = LabelImage::new(Array2::from_shape_fn(size.dim(), |(y, x)| {
//!     u16::from((40..80).contains(&y) && (90..130).contains(&x))
//! }));
//! let names = BTreeMap::from([(poster.labels()[0], "poster".to_owned())]);
//!
//! let percept = dorsal.look(&eyes, &poster, &names)?;
//! assert!((percept.egocentric.objects[0].depth_m - 1.0).abs() < 0.01);
//!
//! // What must outlive the look goes into a map, which is a value too.
//! let map = AllocentricMap::new(&dorsal.reference, dorsal.qualifying)?
//!     .with(&percept.qualitative, GroundPose::default())?;
//! assert_eq!(map.last_seen(&"poster".into()), Some(1));
//!
//! // Or into a memory, which takes the depth map as evidence for what a look does not show.
//! let mut memory = SceneMemory::new(&dorsal.reference, MemoryParams::default())?;
//! let stand = Stand {
//!     time_ms: 0,
//!     pose: PoseKnowledge::Known(RobotPose::default()),
//!     eyes_above_ground_m: 0.8,
//! };
//! dorsal.remember(&mut memory, &percept, &names, stand)?;
//! let answer = memory.ask(&"within n of robot".parse()?)?;
//! assert_eq!(answer.to_string(), "certainly none; possibly poster");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
mod coarse_range;
mod depth_evidence;
mod dorsal;
mod error;
mod estimator;
mod estimator_workspace;
mod look_workspace;
mod observations;
mod percept;
mod range;
mod rectified_eyes;
mod remember;
mod seen_things;
mod sightings;

pub use allocentric_qsr;
pub use disparity_pyramid;
pub use egocentric_depth;
pub use v1_gabor;

pub use depth_evidence::DepthEvidence;
pub use dorsal::Dorsal;
pub use error::Error;
pub use estimator::{DenseLook, Estimator, Preparation, Rows, Search};
pub use estimator_workspace::EstimatorWorkspace;
pub use look_workspace::LookWorkspace;
pub use observations::{observations, radius_m};
pub use percept::Percept;
pub use range::Range;
pub use rectified_eyes::RectifiedEyes;
pub use remember::Stand;
pub use seen_things::{Foot, SeenThings};
pub use sightings::{Names, object_id, sightings};
