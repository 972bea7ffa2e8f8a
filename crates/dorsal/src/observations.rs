use allocentric_qsr::Observation;
use egocentric_depth::{EgocentricScene, LocatedObject, StereoRig};

use crate::{Names, sightings};

/// The located objects as a memory takes them: the sightings, each with the radius of the object on
/// the ground and the height of its middle above the ground, which lies `eyes_above_ground_m` below
/// the eyes.
pub fn observations<'a>(
    scene: &'a EgocentricScene,
    names: &'a Names,
    rig: &'a StereoRig,
    eyes_above_ground_m: f64,
) -> impl Iterator<Item = Observation> + 'a {
    sightings(scene, names)
        .zip(&scene.objects)
        .map(move |(sighting, object)| Observation {
            sighting,
            // The casts saturate: a thing of four thousand kilometres is as wide as a memory knows.
            radius_mm: (radius_m(object, rig) * 1e3).round() as u32,
            height_mm: ((eyes_above_ground_m - object.position.y_m) * 1e3).round() as i32,
        })
}

/// How wide an object is, as far as one eye can tell: the radius in metres of the disc that faces
/// the left eye at the object's range and covers as many pixels.
#[must_use]
pub fn radius_m(object: &LocatedObject, rig: &StereoRig) -> f64 {
    let (fx, fy) = rig.intrinsics().left.focal_px;
    (object.pixels as f64 / (std::f64::consts::PI * fx * fy)).sqrt() * object.range_m()
}
