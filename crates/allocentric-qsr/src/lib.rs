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
//! of Freksa and Zimmermann. A [`RelationSet`] is what may hold: one member is certain, none is a
//! contradiction. [`compose`] joins two distances in any of the four [`Case`]s, and
//! [`CompositionTable`] prints Tables 2 and 3 of the paper.
//!
//! Everything sound is one relation between three points b, c and d: `x = |bc|`, `y = |cd|`,
//! `r = |bd|`, the label of d at c and the label of d at b, both against the way from b to c. With
//! the turn at c, `r^2 = x^2 + y^2 + 2xy cos(turn)`; the label at c bounds the turn, the label at b
//! bounds `x + y cos(turn)`, and a class of r is possible exactly if it meets the open interval
//! between the least and the greatest r. [`TriangleTable`] decides that in whole numbers, and every
//! composition is a projection of it. [`Orientation::neighbours`] and
//! [`DepthReference::neighbours`] say what follows what while things move.
//!
//! Every result carries its [`Mode`]. `Published` gives the paper's answers, which can leave out
//! what is true ([`omissions`] lists where, with numbers); `Sound` contains every configuration the
//! premises allow. Relations measured from positions are sound as far as the true positions lie
//! within the intervals of [`QualifyParams::sigmas`]; relations that [`Inference`] composes are
//! either.
//!
//! A [`ConstraintNetwork`] closes facts about thousands of distances, a [`PlaceNetwork`] facts about
//! distances and directions together. Either ends in [`Closure::Inconsistent`] with an
//! [`Explanation`], which is a proof, or in [`Closure::NotRefuted`], which is not its opposite:
//! whether points of the plane have given distances is NP-hard, and relative directions are harder.
//!
//! # The memory
//! [`SceneMemory`] outlives the view. Each [`Look`] comes with its time, its pose or the news that the pose
//! is lost, and [`LookEvidence`]: what it shows of places where nothing was reported. Objects have
//! a [`Life`] that only evidence moves on, places with covariance in one or several map frames,
//! which shared landmarks join, and relations that are qualified when asked for. Facts are told and retracted, contradictions
//! come back as [`Refused`] with their premises, and a [`Query`] asks in words:
//!
//! ```
//! use allocentric_qsr::{
//!     DepthReference, Look, MemoryParams, NoDepth, PoseKnowledge, RobotPose, SceneMemory, Sighting,
//! };
//!
//! let reference = DepthReference::robot_120();
//! let mut memory = SceneMemory::new(&reference, MemoryParams::default())?;
//! let sighting = |object: &str, distance_m: f64, bearing_deg: f64| Sighting {
//!     object: object.into(),
//!     distance_m,
//!     bearing_rad: bearing_deg.to_radians(),
//!     sigma_distance_m: 0.01,
//!     sigma_bearing_rad: 0.005,
//! };
//! let seen = [sighting("cd_box", 0.80, 95.0), sighting("pc_screen", 0.92, 65.0)];
//! let look = Look {
//!     time_ms: 0,
//!     pose: PoseKnowledge::Known(RobotPose::default()),
//!     observations: seen.map(Into::into).to_vec(),
//! };
//! memory.observe(&look, &NoDepth)?;
//! let answer = memory.ask(&"relation pc_screen from cd_box seen from robot".parse()?)?;
//! assert_eq!(answer.to_string(), "pc_screen at cd_box: {vc}, {fr, r, br}; read vc r");
//!
//! memory.tell(memory.read_fact("lamp within vc of pc_screen")?)?;
//! let answer = memory.ask(&"within vc,c,n of cd_box".parse()?)?;
//! assert_eq!(answer.to_string(), "certainly lamp, pc_screen; possibly none");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Data
//! Everything that is written uses short labels: depths are those of the reference system (such
//! as `vc c n f vf`), orientations `fl sf fr l n r bl sb br`, modes `published` and `sound`.
//! [`EgocentricRecord`], [`RelationRecord`], [`CompositionTable`], [`AllocentricMap`],
//! [`Explanation`] and [`MemoryLine`] show their form in JSON; [`SceneMemory::to_json`] writes a
//! snapshot, [`GqrCalculus`] and [`ConstraintNetwork::to_gqr`] what the solver GQR reads. Note the two labels `n`: *nearby* among depths, *none* among orientations.
mod agreement;
mod allocentric_map;
mod answer;
mod ask;
mod beside;
mod case;
mod certainty;
mod composition;
mod composition_table;
mod constraint_network;
mod depth;
mod depth_reference;
mod direction_fact;
mod double_cross;
mod double_cross_set;
mod egocentric_place;
mod explanation;
mod frame_join;
mod free_ground;
mod free_path;
mod fusion;
mod gqr;
mod ground_estimate;
mod ground_extent;
mod ground_pose;
mod inference;
mod interval;
mod life;
mod look;
mod look_evidence;
mod map_record;
mod memory_change;
mod memory_diff;
mod memory_line;
mod memory_network;
mod memory_object;
mod memory_params;
mod memory_record;
mod memory_relation;
mod miss;
mod mode;
mod neighbourhood;
mod object_id;
mod observe;
mod observer;
mod omission;
mod orientation;
mod path_closure;
mod place;
mod place_network;
mod place_set;
mod polar_box;
mod premise;
mod presets;
mod proof;
mod published;
mod qualitative_scene;
mod query;
mod question;
mod refused;
mod relation;
mod relation_set;
mod robot_place;
mod robot_pose;
mod scene_memory;
mod sighting;
mod squared_bounds;
mod tell;
mod together;
mod told_fact;
mod triangle_table;
mod word_table;
mod words;

pub use agreement::{Agreement, Disputed, Gone};
pub use allocentric_map::{AllocentricMap, Inconsistent, Moved, Remembered};
pub use answer::Answer;
pub use ask::Unanswerable;
pub use case::Case;
pub use certainty::Certainty;
pub use composition::{Composed, compose, compose_over_base};
pub use composition_table::CompositionTable;
pub use constraint_network::{Closure, ConstraintNetwork, DistanceFact, FactSource, NotAFact};
pub use depth::{Depth, DepthSet};
pub use depth_reference::{BadReference, DepthClass, DepthReference, NotADistance};
pub use direction_fact::DirectionFact;
pub use egocentric_place::{EgocentricPlace, EgocentricRecord};
pub use explanation::{Because, Explanation, Rule, Statement, Step};
pub use free_path::FreePath;
pub use gqr::GqrCalculus;
pub use ground_estimate::GroundEstimate;
pub use ground_pose::{GroundPose, NotAPose};
pub use inference::{Dispute, Inference};
pub use life::Life;
pub use look::{Look, Observation, PoseKnowledge};
pub use look_evidence::{AskedPlace, Evidence, LookEvidence, NoDepth};
pub use map_record::BadMap;
pub use memory_change::{Change, Dated};
pub use memory_line::{LookLine, MemoryLine, MemoryReply, PoseLine, SeenLine, ViewLine};
pub use memory_object::MemoryObject;
pub use memory_params::{BadMemoryParams, MemoryParams, Policy};
pub use memory_record::BadMemory;
pub use mode::Mode;
pub use object_id::ObjectId;
pub use observer::Observer;
pub use omission::{Omission, TriangleWitness, omissions};
pub use orientation::{NotABearing, Orientation, OrientationSet};
pub use place::{Place, PlaceRecord, Places};
pub use place_network::PlaceNetwork;
pub use place_set::PlaceSet;
pub use qualitative_scene::{QualifyParams, QualitativeScene};
pub use query::{BadQuery, Condition, Query};
pub use refused::{Displaced, Refused};
pub use relation::{Reason, Relation, RelationRecord};
pub use relation_set::{BaseRelation, RelationSet};
pub use robot_place::RobotPlace;
pub use robot_pose::{NotAnError, RobotPose};
pub use scene_memory::SceneMemory;
pub use sighting::{BadSighting, Sighting};
pub use told_fact::ToldFact;
pub use triangle_table::TriangleTable;
