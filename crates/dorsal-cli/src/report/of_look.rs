use dorsal::Names;
use dorsal::allocentric_qsr::QualitativeScene;
use dorsal::egocentric_depth::EgocentricScene;
use dorsal::v1_gabor::Binocular;
use dorsal::{object_id, radius_m};
use stereo_formats::file_sign;
use stereo_formats::picture::Picture;

use crate::plan::Plan;
use crate::report::Report;
use crate::report::frame::{Frame, MOST_WIDTH, Spot};
use crate::report::plane::{LabelPlane, Plane};
use crate::sight::Sight;
use crate::times::Times;

/// The page of one look.
pub(crate) fn look_page(
    title: &str,
    plan: &Plan,
    sight: &Sight,
    eyes: &Binocular<Picture>,
    times: &Times,
) -> anyhow::Result<Vec<u8>> {
    let size = eyes.left.size();
    let mut frame = Frame::new("look", size);
    frame.picture("left", eyes.left.rgb(), "what the left eye sees")?;
    frame.picture("right", eyes.right.rgb(), "what the right eye sees")?;
    let d = file_sign::d_of_field(&sight.disparity, false);
    frame.planes.insert(
        "disparity",
        Plane::of(
            d.view(),
            MOST_WIDTH,
            "px",
            "disparity in colours, near is red",
        ),
    );
    let confidence = sight.disparity.confidence();
    frame.planes.insert(
        "confidence",
        Plane::of(
            confidence,
            MOST_WIDTH,
            "",
            "confidence in colours, sure is red",
        ),
    );
    if let Some(depth) = &sight.depth {
        frame.planes.insert(
            "depth",
            Plane::of(
                depth.metres(),
                MOST_WIDTH,
                "m",
                "depth in colours, near is red",
            ),
        );
    }
    frame.times = times.milliseconds();
    let none = Names::new();
    let names = sight
        .objects
        .as_ref()
        .map_or(&none, |objects| &objects.names);
    if let Some(objects) = &sight.objects {
        frame.labels = Some(LabelPlane::of(&objects.labels, MOST_WIDTH));
    }
    if let (Some(scene), Some(rig)) = (&sight.scene, &sight.rig) {
        frame.see(&scene.egocentric, names);
        frame.objects = spots(&scene.egocentric, names, |object| radius_m(object, rig));
        relate(&mut frame, &scene.qualitative);
    }
    let mut report = Report::new(
        title,
        "One look at a stereo pair, level by level",
        &plan.reference,
        names,
        vec![frame],
    );
    report.facts = vec![
        ("picture".into(), format!("{size} px")),
        (
            "valid".into(),
            format!("{:.1} %", 100.0 * sight.disparity.density()),
        ),
    ];
    if let Some(scene) = &sight.scene {
        let located = scene.egocentric.objects.len();
        let all = located + scene.egocentric.unlocated.len();
        report
            .facts
            .push(("objects located".into(), format!("{located} of {all}")));
    }
    Ok(report.html()?)
}

/// The objects of one look from above.
fn spots(
    scene: &EgocentricScene,
    names: &Names,
    radius: impl Fn(&dorsal::egocentric_depth::LocatedObject) -> f64,
) -> Vec<Spot> {
    let spot = |object: &dorsal::egocentric_depth::LocatedObject| {
        let covariance = object.covariance_m2;
        Spot {
            name: object_id(object.label, names).to_string(),
            x: object.position.x_m,
            z: object.position.z_m,
            cov: [covariance[0][0], covariance[0][2], covariance[2][2]],
            radius: radius(object),
            life: "in_view",
        }
    };
    scene.objects.iter().map(spot).collect()
}

/// Every place and every relation of a scene.
fn relate(frame: &mut Frame, scene: &QualitativeScene) {
    for place in scene.places() {
        frame.egocentric(place, scene.reference());
    }
    for relation in scene.relations() {
        frame.relate(&relation, None, None, scene.reference());
    }
}
