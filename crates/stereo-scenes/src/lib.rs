//! A ray-cast room and a pan-tilt-vergence head: stereo pairs with their truth.
//!
//! No public data set has exact vector disparity, depth, labels, visibility and places for a head
//! whose eyes turn. This crate renders them: textured boxes, balls, cylinders and panels in a room
//! ([`Room`], read from TOML), seen by a [`Head`] that fixates a point ([`Gaze`]).
//!
//! ```
//! use stereo_scenes::{Exposure, Room, render};
//! use v1_gabor::Size;
//!
//! let room = Room::demo();
//! // The paper's head at a sixteenth of its resolution.
//! let head = room.head().resized(Size { width: 64, height: 48 });
//! let gaze = head.fixate(room.fixation_m())?;
//! let view = render(&room, &gaze, Exposure::default())?;
//!
//! // Both eyes have the fixation point in the middle of their images.
//! assert!(gaze.project(room.fixation_m()).left.is_some_and(|(u, _)| (u - 31.5).abs() < 1e-9));
//! // Left (10, 40) matches right (10 + dx, 40 + dy), and whether the right eye sees it is known.
//! let (dx, dy) = (view.truth.dx[[40, 10]], view.truth.dy[[40, 10]]);
//! assert!(dx.is_finite() && dy.is_finite() && view.truth.visible[[40, 10]]);
//! let cup = &view.truth.objects[2];
//! assert_eq!(cup.name, "cup");
//! // In the observer frame (x right, y down, z forward): to the left, below the eyes, in front.
//! let [x, y, z] = cup.centre_m;
//! assert!(x < 0.0 && y > 0.0 && z > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Frames
//! The *room frame* has its origin in a corner of the floor, x right, y away, z up. The *observer
//! frame* has its origin midway between the eyes, x right, y down, z forward over the ground; the
//! *head frame* is the observer frame tilted, and its z is `depth`. Everything is in metres.
//!
//! # What the images promise
//! A point of a surface has one radiance, whichever eye looks: shading is Lambertian, without
//! shadows, and textures lose detail by the distance from the point between the eyes. Truth is
//! that of the ray through a pixel's centre. The same arguments give the same bits on any number
//! of threads.
mod exposure;
mod eye;
mod gaze;
mod head;
mod noise;
mod pose;
mod random_room;
mod room;
mod shape;
mod solid;
mod stage;
mod texture;
mod thing;
mod true_object;
mod truth;
mod vector;
mod view;
mod walls;

pub use exposure::Exposure;
pub use gaze::{Gaze, NoGaze};
pub use head::Head;
pub use room::{BadRoom, Room};
pub use shape::Shape;
pub use texture::{Pattern, Texture};
pub use thing::Thing;
pub use true_object::{TrueObject, TrueSurface};
pub use truth::Truth;
pub use view::{NoView, View, render};
pub use walls::Walls;
