use std::collections::BTreeMap;

use allocentric_qsr::{ObjectId, Sighting};
use egocentric_depth::{EgocentricScene, Label};

/// What the objects of a look are called, by label.
pub type Names = BTreeMap<Label, String>;

/// The name of a label as the relations use it: the given one, else `object-` and its number.
#[must_use]
pub fn object_id(label: Label, names: &Names) -> ObjectId {
    names.get(&label).map_or_else(
        || ObjectId::new(format!("object-{}", label.0)),
        |name| ObjectId::new(name.as_str()),
    )
}

/// The located objects as level 4 takes them: distance and bearing over the ground, each with one
/// standard deviation.
///
/// This is the whole of what passes from the metric levels to the qualitative one.
pub fn sightings<'a>(
    scene: &'a EgocentricScene,
    names: &'a Names,
) -> impl Iterator<Item = Sighting> + 'a {
    scene.objects.iter().map(|object| Sighting {
        object: object_id(object.label, names),
        distance_m: object.distance_m(),
        bearing_rad: object.bearing_rad(),
        sigma_distance_m: object.distance_sigma_m(),
        sigma_bearing_rad: object.bearing_sigma_rad(),
    })
}
