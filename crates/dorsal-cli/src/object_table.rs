use dorsal::allocentric_qsr::{DepthReference, Place};
use dorsal::egocentric_depth::{Head, LocatedObject, Position, StereoRig};
use dorsal::{Names, object_id};

use crate::sight::Scene;
use crate::text_table::TextTable;

/// The located objects and their places for the observer, a line each; then those without a
/// place, and why.
pub(crate) fn object_table(scene: &Scene, rig: &StereoRig, names: &Names) -> String {
    let reference = scene.qualitative.reference();
    let mut table = TextTable::new([
        "object",
        ">depth m",
        "",
        ">distance m",
        "",
        ">bearing deg",
        "",
        "place",
        "may be",
    ]);
    for object in &scene.egocentric.objects {
        let name = object_id(object.label, names);
        let Some(place) = scene.qualitative.place(&name) else {
            continue;
        };
        let may_be = format!(
            "{} | {}",
            reference.labels(place.places.depth).join(" "),
            place.places.orientation.labels().join(" ")
        );
        table.line([
            name.to_string(),
            format!("{:.3}", object.depth_m),
            format!("± {:.3}", depth_sigma_m(object, rig)),
            format!("{:.3}", object.distance_m()),
            format!("± {:.3}", object.distance_sigma_m()),
            format!("{:.1}", object.bearing_rad().to_degrees()),
            format!("± {:.1}", object.bearing_sigma_rad().to_degrees()),
            place_words(place.read, reference),
            may_be,
        ]);
    }
    let mut text = table.to_string();
    for object in &scene.egocentric.unlocated {
        text += &format!(
            "{} has no place: {} of its {} pixels have a known depth; {}\n",
            object_id(object.label, names),
            object.reliable_pixels,
            object.pixels,
            object.reason
        );
    }
    text
}

/// A place in words, such as `very close, front left`.
pub(crate) fn place_words(place: Place, reference: &DepthReference) -> String {
    let words = format!(
        "{}, {}",
        reference.name_of(place.depth),
        place.orientation.name()
    );
    words.replace('_', " ")
}

/// One standard deviation of an object's depth, in metres: that of its position along the head's
/// forward axis.
pub(crate) fn depth_sigma_m(object: &LocatedObject, rig: &StereoRig) -> f64 {
    let forward = rig
        .to_observer(Position::<Head>::new(0.0, 0.0, 1.0))
        .to_array();
    let terms = (0..3).flat_map(|i| (0..3).map(move |j| (i, j)));
    let variance: f64 = terms
        .map(|(i, j)| forward[i] * object.covariance_m2[i][j] * forward[j])
        .sum();
    // Rounding may leave a vanishing variance a little below 0.
    variance.max(0.0).sqrt()
}
