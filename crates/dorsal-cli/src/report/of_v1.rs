use dorsal::Names;
use dorsal::allocentric_qsr::DepthReference;
use dorsal::v1_gabor::{MonogenicPlanes, Responses, Size};
use ndarray::{Array2, ArrayView2};
use stereo_formats::picture::Picture;
use stereo_formats::v1_picture;

use crate::report::Report;
use crate::report::frame::{Frame, MOST_WIDTH};
use crate::report::plane::Plane;
use crate::times::Times;

/// The page of a picture's oriented responses, a scale a step of its slider.
pub(crate) fn responses_page(
    picture: &Picture,
    scales: &[Responses],
    congruency: Option<&Array2<f32>>,
    times: &Times,
) -> anyhow::Result<Vec<u8>> {
    let mut frames = Vec::with_capacity(scales.len());
    for (scale, responses) in scales.iter().enumerate() {
        let mut frame = scale_frame(picture, scale, responses.size())?;
        let dominant = responses.dominant_orientation();
        let painted = v1_picture::dominant_orientation(&dominant);
        frame.picture(
            "dominant",
            painted.view(),
            "the dominant orientation: twice its angle as hue, its strength as brightness",
        )?;
        plane(
            &mut frame,
            "energy",
            energy(&v1_picture::total_energy(responses)).view(),
            ENERGY,
        );
        let degrees = dominant.theta_rad.mapv(f32::to_degrees);
        plane(
            &mut frame,
            "angle",
            degrees.view(),
            ("°", "the angle of the wave vector in colours"),
        );
        plane(
            &mut frame,
            "strength",
            dominant.strength.view(),
            ("", "the strength of the orientation in colours"),
        );
        // Congruency is one plane over all scales, of the finest one's size.
        if let (0, Some(congruency)) = (scale, congruency) {
            plane(
                &mut frame,
                "edges",
                congruency.view(),
                ("", "phase congruency in colours: edges and lines"),
            );
        }
        frames.push(frame);
    }
    page(picture, frames, times)
}

/// The page of a picture's monogenic signal, a scale a step of its slider.
pub(crate) fn monogenic_page(
    picture: &Picture,
    scales: &[MonogenicPlanes],
    times: &Times,
) -> anyhow::Result<Vec<u8>> {
    let mut frames = Vec::with_capacity(scales.len());
    for (scale, planes) in scales.iter().enumerate() {
        let mut frame = scale_frame(picture, scale, planes.size())?;
        let phase = v1_picture::monogenic_phase(planes);
        frame.picture(
            "phase",
            phase.view(),
            "the phase as hue, the amplitude as brightness",
        )?;
        let turned = v1_picture::monogenic_orientation(planes);
        frame.picture("orientation", turned.view(), "twice the orientation as hue")?;
        let amplitude =
            Array2::from_shape_fn(planes.size().dim(), |(y, x)| planes.at(x, y).amplitude());
        plane(
            &mut frame,
            "amplitude",
            amplitude.view(),
            ("", "the amplitude in colours"),
        );
        frames.push(frame);
    }
    page(picture, frames, times)
}

const ENERGY: (&str, &str) = ("(log10)", "energy in colours, by its logarithm");

/// The logarithm of the energy; silence is unknown.
fn energy(energy: &Array2<f32>) -> Array2<f32> {
    energy.mapv(|energy| {
        if energy > 0.0 {
            energy.log10()
        } else {
            f32::NAN
        }
    })
}

fn scale_frame(picture: &Picture, scale: usize, size: Size) -> anyhow::Result<Frame> {
    let mut frame = Frame::new(format!("scale {scale}"), size);
    frame.why = format!("{size} pixels; scale 0 is the finest");
    frame.picture("picture", picture.rgb(), "the picture that was filtered")?;
    Ok(frame)
}

fn plane(
    frame: &mut Frame,
    name: &'static str,
    values: ArrayView2<'_, f32>,
    (unit, alt): (&'static str, &str),
) {
    frame
        .planes
        .insert(name, Plane::of(values, MOST_WIDTH, unit, alt));
}

fn page(picture: &Picture, mut frames: Vec<Frame>, times: &Times) -> anyhow::Result<Vec<u8>> {
    for frame in &mut frames {
        frame.times = times.milliseconds();
    }
    let facts = vec![
        ("picture".into(), format!("{} px", picture.size())),
        ("scales".into(), frames.len().to_string()),
    ];
    let mut report = Report::new(
        "What the first level sees",
        "One picture, filtered as primary visual cortex does, scale by scale",
        &DepthReference::robot_120(),
        &Names::new(),
        frames,
    );
    report.facts = facts;
    Ok(report.html()?)
}
