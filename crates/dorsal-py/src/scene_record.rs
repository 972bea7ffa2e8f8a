//! The records of a look's objects, with the keys of the command's `scene.json`.

use dorsal::allocentric_qsr::{
    EgocentricRecord, Inference, Mode, ObjectId, QualitativeScene, RelationRecord,
};
use dorsal::egocentric_depth::{EgocentricScene, StereoRig};
use dorsal::{Names, object_id, radius_m};
use pyo3::PyResult;
use serde::Serialize;

use crate::refusal::value_error;

/// A record as JSON, in which every number reads back to the same bits.
pub(crate) fn json(record: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(record).map_err(value_error)
}

/// Where an object is: metres and radians in the observer frame, each with one standard deviation.
#[derive(Debug, Serialize)]
pub(crate) struct ObjectRecord {
    name: ObjectId,
    label: u16,
    position_m: [f64; 3],
    sigma_m: [f64; 3],
    depth_m: f64,
    distance_m: f64,
    distance_sigma_m: f64,
    bearing_rad: f64,
    bearing_sigma_rad: f64,
    radius_m: f64,
    pixel: [f64; 2],
    pixels: usize,
    reliable_pixels: usize,
    agreeing_pixels: usize,
}

/// An object without a place, and why.
#[derive(Debug, Serialize)]
pub(crate) struct UnlocatedRecord {
    name: ObjectId,
    label: u16,
    pixels: usize,
    reliable_pixels: usize,
    reason: String,
}

/// What is placed, in symbols: for the observer, between the objects as measured, and as the paper's composition
/// infers it from the places alone.
#[derive(Debug, Serialize)]
pub(crate) struct QualitativeRecord {
    places: Vec<EgocentricRecord>,
    relations: Vec<RelationRecord>,
    inferred: Vec<RelationRecord>,
}

pub(crate) fn objects(
    scene: &EgocentricScene,
    rig: &StereoRig,
    names: &Names,
) -> Vec<ObjectRecord> {
    let records = scene.objects.iter().map(|object| ObjectRecord {
        name: object_id(object.label, names),
        label: object.label.0.get(),
        position_m: object.position.to_array(),
        sigma_m: object.sigma_m(),
        depth_m: object.depth_m,
        distance_m: object.distance_m(),
        distance_sigma_m: object.distance_sigma_m(),
        bearing_rad: object.bearing_rad(),
        bearing_sigma_rad: object.bearing_sigma_rad(),
        radius_m: radius_m(object, rig),
        pixel: [object.pixel.0, object.pixel.1],
        pixels: object.pixels,
        reliable_pixels: object.reliable_pixels,
        agreeing_pixels: object.agreeing_pixels,
    });
    records.collect()
}

pub(crate) fn unlocated(scene: &EgocentricScene, names: &Names) -> Vec<UnlocatedRecord> {
    let records = scene.unlocated.iter().map(|object| UnlocatedRecord {
        name: object_id(object.label, names),
        label: object.label.0.get(),
        pixels: object.pixels,
        reliable_pixels: object.reliable_pixels,
        reason: object.reason.to_string(),
    });
    records.collect()
}

impl QualitativeRecord {
    pub(crate) fn of(scene: &QualitativeScene) -> Self {
        let reference = scene.reference();
        let inference = Inference::of_scene(scene, Mode::Published);
        Self {
            places: scene
                .places()
                .map(|place| place.record(reference))
                .collect(),
            relations: scene
                .relations()
                .iter()
                .map(|relation| relation.record(reference))
                .collect(),
            inferred: inference
                .relations()
                .map(|relation| relation.record(reference))
                .collect(),
        }
    }
}
