use dorsal::Names;
use dorsal::allocentric_qsr::DepthReference;
use dorsal::disparity_pyramid::DisparityField;
use ndarray::Zip;
use stereo_formats::picture::Picture;
use stereo_formats::{VectorPlanes, flow_picture};

use crate::report::Report;
use crate::report::frame::{Frame, MOST_WIDTH};
use crate::report::plane::Plane;
use crate::times::Times;

/// The page of the flow between two moments.
pub(crate) fn flow_page(
    moments: [&Picture; 2],
    field: &DisparityField,
    times: &Times,
) -> anyhow::Result<Vec<u8>> {
    let size = moments[0].size();
    let mut frame = Frame::new("flow", size);
    frame.picture("earlier", moments[0].rgb(), "the earlier frame")?;
    frame.picture("later", moments[1].rgb(), "the later frame")?;
    let (u, v) = (field.only_valid(field.dx()), field.only_valid(field.dy()));
    let speed = Zip::from(&u).and(&v).map_collect(|u, v| u.hypot(*v));
    for (name, plane, alt) in [
        ("u", &u, "motion to the right in colours"),
        ("v", &v, "motion down in colours"),
        ("speed", &speed, "speed in colours, fast is red"),
    ] {
        let plane = Plane::of(plane.view(), MOST_WIDTH, "px", alt);
        frame.planes.insert(name, plane);
    }
    frame.planes.insert(
        "confidence",
        Plane::of(
            field.confidence(),
            MOST_WIDTH,
            "",
            "confidence in colours, sure is red",
        ),
    );
    let vectors = VectorPlanes::new(u, v)?;
    let full_px = flow_picture::full_speed_px(&vectors);
    let painted = flow_picture::paint(&vectors, full_px);
    frame.picture(
        "flow",
        painted.view(),
        "the direction of motion as hue, its speed as brightness",
    )?;
    frame.times = times.milliseconds();
    let mut report = Report::new(
        "How everything moves",
        "The flow between two moments of one eye",
        &DepthReference::robot_120(),
        &Names::new(),
        vec![frame],
    );
    report.facts = vec![
        ("frames".into(), format!("{size} px")),
        ("valid".into(), format!("{:.1} %", 100.0 * field.density())),
        ("full brightness".into(), format!("{full_px:.2} px")),
    ];
    Ok(report.html()?)
}
