use dorsal::allocentric_qsr::{
    BadSighting, DepthReference, QualifyParams, QualitativeScene, Sighting,
};
use dorsal::egocentric_depth::{DepthMap, Label, Observer, Position, StereoRig};
use dorsal::{Names, object_id};

use crate::objects::Objects;

/// Where an object really is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TrueObject {
    pub(crate) label: Label,
    /// Median depth of its surface along the head's forward axis, in metres.
    pub(crate) depth_m: f64,
    pub(crate) position: Position<Observer>,
}

impl TrueObject {
    /// The objects of a picture whose true depth is known: the median of the true depths over the
    /// label, on the line of sight of the median pixel. Nothing is left out as an outlier.
    pub(crate) fn all(depth: &DepthMap, objects: &Objects, rig: &StereoRig) -> Vec<Self> {
        let labels = objects.labels.labels().into_iter();
        labels
            .filter_map(|label| {
                let labelled = objects.labels.plane();
                let known = labelled.indexed_iter().filter_map(|((y, x), &number)| {
                    let depth_m = depth.at(x, y)?;
                    let known = (x as f64, y as f64, f64::from(depth_m));
                    (number == label.0.get()).then_some(known)
                });
                let known: Vec<(f64, f64, f64)> = known.collect();
                let depth_m = median(known.iter().map(|known| known.2).collect())?;
                let pixel = (
                    median(known.iter().map(|known| known.0).collect())?,
                    median(known.iter().map(|known| known.1).collect())?,
                );
                Some(Self {
                    label,
                    depth_m,
                    position: rig.to_observer(rig.back_project(pixel, depth_m)?),
                })
            })
            .collect()
    }

    /// What a perfect observer would say: the true places in symbols, without any error.
    pub(crate) fn scene(
        truth: &[Self],
        names: &Names,
        reference: &DepthReference,
        params: QualifyParams,
    ) -> Result<QualitativeScene, BadSighting> {
        let sightings = truth.iter().map(|object| Sighting {
            object: object_id(object.label, names),
            distance_m: object.position.distance_m(),
            bearing_rad: object.position.bearing_rad(),
            sigma_distance_m: 0.0,
            sigma_bearing_rad: 0.0,
        });
        QualitativeScene::qualify_with(sightings, reference, params)
    }
}

/// The middle value, of an even number the upper of the two; `None` of nothing.
fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    values.sort_unstable_by(f64::total_cmp);
    values.get(middle).copied()
}
