//! Qualitative spatial relations between objects: distance classes and orientations, composed,
//! remembered, explained. Level 4 of *dorsal*, usable without the other levels, and without eyes.
//!
//! What an observer sees goes in as distances and bearings over the ground. It becomes symbols
//! ([`QualitativeScene`]), relations between the objects, and a map that keeps what has left the
//! view ([`AllocentricMap`]):
//!
//! ```
//! use allocentric_qsr::{
//!     AllocentricMap, DepthReference, GroundPose, Orientation, QualifyParams, QualitativeScene,
//!     Sighting,
//! };
//!
//! let reference = DepthReference::robot_120();
//! let sighting = |object: &str, distance_m: f64, bearing_deg: f64| Sighting {
//!     object: object.into(),
//!     distance_m,
//!     bearing_rad: bearing_deg.to_radians(),
//!     sigma_distance_m: 0.01,
//!     sigma_bearing_rad: 0.005,
//! };
//!
//! // Both are in view: the box a little left of straight ahead, the screen to its right.
//! let look = QualitativeScene::qualify(
//!     [sighting("cd_box", 0.80, 95.0), sighting("pc_screen", 0.92, 65.0)],
//!     &reference,
//! )?;
//! let map = AllocentricMap::new(&reference, QualifyParams::default())?
//!     .with(&look, GroundPose::default())?;
//!
//! // The head turns left by 30 degrees and the screen leaves the view; the map keeps it.
//! let turned = GroundPose::new(0.0, 0.0, 30f64.to_radians())?;
//! let look = QualitativeScene::qualify([sighting("cd_box", 0.80, 65.0)], &reference)?;
//! let map = map.with(&look, turned)?;
//!
//! let screen = map.relation(&"cd_box".into(), &"pc_screen".into()).expect("both are known");
//! assert_eq!(reference.labels(screen.places.depth), ["vc"]);
//! assert_eq!(screen.places.orientation.labels(), ["fr", "r", "br"]);
//! assert_eq!(screen.read.map(|place| place.orientation), Some(Orientation::Right));
//! assert_eq!(map.last_seen(&"pc_screen".into()), Some(1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The calculus
//! A [`DepthReference`] divides distances into named classes; [`Orientation`] has the nine labels
//! of Freksa and Zimmermann. A [`RelationSet`] is what may hold. [`compose`] joins two distances
//! in any of the four [`Case`]s, [`CompositionTable`] prints Tables 2 and 3 of the paper, and
//! [`TriangleTable`] decides exactly, in integers, what may hold between three points.
//!
//! Every result carries its [`Mode`]. `Published` gives the paper's answers, which can leave out
//! what is true; `Sound` contains every configuration the premises allow. Relations measured from
//! positions are sound as far as the true positions lie within the intervals of
//! [`QualifyParams::sigmas`]; relations that [`Inference`] composes are either.
//!
//! # Data
//! Everything that is written uses short labels: depths are those of the reference system (such
//! as `vc c n f vf`), orientations `fl sf fr l n r bl sb br`, modes `published` and `sound`.
//! [`EgocentricRecord`], [`RelationRecord`], [`CompositionTable`] and [`AllocentricMap`] show
//! their form in JSON. Note the two labels `n`: *nearby* among depths, *none* among orientations.
mod allocentric_map;
mod case;
mod composition;
mod composition_table;
mod depth;
mod depth_reference;
mod double_cross;
mod egocentric_place;
mod ground_estimate;
mod ground_pose;
mod inference;
mod map_record;
mod mode;
mod object_id;
mod orientation;
mod place;
mod place_set;
mod polar_box;
mod premise;
mod presets;
mod published;
mod qualitative_scene;
mod relation;
mod relation_set;
mod sighting;
mod triangle_table;

pub use allocentric_map::{AllocentricMap, Inconsistent, Moved, Remembered};
pub use case::Case;
pub use composition::{Composed, compose, compose_over_base};
pub use composition_table::CompositionTable;
pub use depth::{Depth, DepthSet};
pub use depth_reference::{BadReference, DepthClass, DepthReference, NotADistance};
pub use egocentric_place::{EgocentricPlace, EgocentricRecord};
pub use ground_estimate::GroundEstimate;
pub use ground_pose::{GroundPose, NotAPose};
pub use inference::{Dispute, Inference};
pub use map_record::BadMap;
pub use mode::Mode;
pub use object_id::ObjectId;
pub use orientation::{NotABearing, Orientation, OrientationSet};
pub use place::{Place, PlaceRecord, Places};
pub use place_set::PlaceSet;
pub use qualitative_scene::{QualifyParams, QualitativeScene};
pub use relation::{Reason, Relation, RelationRecord};
pub use relation_set::{BaseRelation, RelationSet};
pub use sighting::{BadSighting, Sighting};
pub use triangle_table::TriangleTable;
