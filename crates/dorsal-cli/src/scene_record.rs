use dorsal::allocentric_qsr::{
    DepthReference, EgocentricRecord, Inference, Mode, ObjectId, RelationRecord,
};
use dorsal::egocentric_depth::{LocatedObject, StereoRig, UnlocatedObject};
use dorsal::{Names, object_id, radius_m};
use serde::Serialize;

use crate::object_table::depth_sigma_m;
use crate::sight::Scene;

/// What `scene.json` says of the objects of a look: schema `dorsal-scene/1`.
#[derive(Debug, Serialize)]
pub(crate) struct SceneRecord<'a> {
    schema: &'static str,
    version: &'static str,
    frame: &'static str,
    reference: &'a DepthReference,
    objects: Vec<ObjectRecord>,
    unlocated: Vec<UnlocatedRecord>,
    egocentric: Vec<EgocentricRecord>,
    allocentric: Allocentric,
}

/// Where an object is: metres and radians in the observer frame, each with one standard deviation.
#[derive(Debug, Serialize)]
struct ObjectRecord {
    name: ObjectId,
    label: u16,
    position_m: [f64; 3],
    sigma_m: [f64; 3],
    /// Along the head's forward axis.
    depth_m: f64,
    depth_sigma_m: f64,
    /// Over the ground.
    distance_m: f64,
    distance_sigma_m: f64,
    /// Over the ground: 0 is right, a right angle is front.
    bearing_rad: f64,
    bearing_sigma_rad: f64,
    /// Of the disc that covers as many pixels at this range.
    radius_m: f64,
    /// The median pixel of the left picture.
    pixel: [f64; 2],
    pixels: usize,
    reliable_pixels: usize,
    agreeing_pixels: usize,
}

/// An object without a place, and why.
#[derive(Debug, Serialize)]
struct UnlocatedRecord {
    name: ObjectId,
    label: u16,
    pixels: usize,
    reliable_pixels: usize,
    reason: String,
}

/// The relations between the objects by both calculi; each record carries its mode.
#[derive(Debug, Serialize)]
struct Allocentric {
    /// From the intervals around both positions.
    measured: Vec<RelationRecord>,
    /// From the places for the observer, by the paper's composition, to its fixpoint.
    inferred: InferenceRecord,
}

#[derive(Debug, Serialize)]
struct InferenceRecord {
    mode: Mode,
    rounds: usize,
    relations: Vec<RelationRecord>,
    disputes: Vec<DisputeRecord>,
}

/// A composition that was set aside, because it would have left nothing of a relation.
#[derive(Debug, Serialize)]
struct DisputeRecord {
    between: [ObjectId; 2],
    through: ObjectId,
    kept: Vec<String>,
    refused: Vec<String>,
}

impl<'a> SceneRecord<'a> {
    pub(crate) fn new(scene: &'a Scene, rig: &StereoRig, names: &Names) -> Self {
        let reference = scene.qualitative.reference();
        let objects = scene.egocentric.objects.iter();
        let unlocated = scene.egocentric.unlocated.iter();
        let relations = scene.qualitative.relations();
        Self {
            schema: "dorsal-scene/1",
            version: env!("CARGO_PKG_VERSION"),
            frame: "observer: x right, y down, z forward over the ground",
            reference,
            objects: objects
                .map(|object| ObjectRecord::of(object, rig, names))
                .collect(),
            unlocated: unlocated
                .map(|object| UnlocatedRecord::of(object, names))
                .collect(),
            egocentric: scene
                .qualitative
                .places()
                .map(|place| place.record(reference))
                .collect(),
            allocentric: Allocentric {
                measured: relations
                    .iter()
                    .map(|relation| relation.record(reference))
                    .collect(),
                inferred: InferenceRecord::of(&scene.published, reference),
            },
        }
    }
}

impl ObjectRecord {
    fn of(object: &LocatedObject, rig: &StereoRig, names: &Names) -> Self {
        Self {
            name: object_id(object.label, names),
            label: object.label.0.get(),
            position_m: object.position.to_array(),
            sigma_m: object.sigma_m(),
            depth_m: object.depth_m,
            depth_sigma_m: depth_sigma_m(object, rig),
            distance_m: object.distance_m(),
            distance_sigma_m: object.distance_sigma_m(),
            bearing_rad: object.bearing_rad(),
            bearing_sigma_rad: object.bearing_sigma_rad(),
            radius_m: radius_m(object, rig),
            pixel: [object.pixel.0, object.pixel.1],
            pixels: object.pixels,
            reliable_pixels: object.reliable_pixels,
            agreeing_pixels: object.agreeing_pixels,
        }
    }
}

impl UnlocatedRecord {
    fn of(object: &UnlocatedObject, names: &Names) -> Self {
        Self {
            name: object_id(object.label, names),
            label: object.label.0.get(),
            pixels: object.pixels,
            reliable_pixels: object.reliable_pixels,
            reason: object.reason.to_string(),
        }
    }
}

impl InferenceRecord {
    fn of(inference: &Inference, reference: &DepthReference) -> Self {
        let labels = |depths| {
            let labels = reference.labels(depths).into_iter();
            labels.map(str::to_owned).collect()
        };
        Self {
            mode: inference.mode(),
            rounds: inference.rounds(),
            relations: inference
                .relations()
                .map(|relation| relation.record(reference))
                .collect(),
            disputes: inference
                .disputes()
                .iter()
                .map(|dispute| DisputeRecord {
                    between: dispute.between.clone(),
                    through: dispute.through.clone(),
                    kept: labels(dispute.kept),
                    refused: labels(dispute.refused),
                })
                .collect(),
        }
    }
}
