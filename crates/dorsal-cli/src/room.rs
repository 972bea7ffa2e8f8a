use dorsal::egocentric_depth::Position;
use ndarray::{Array3, ArrayView2, Axis};
use stereo_formats::file_sign;
use stereo_formats::picture::{self, Picture};
use stereo_scenes::{Exposure, Room, render};

use crate::demo_scene::{DemoScene, Promise};
use crate::objects::Objects;
use crate::true_object::TrueObject;

/// The rendered room: a table top in front of the paper's head, with objects after its Figures 5
/// to 9, of which everything is known exactly.
///
/// The pictures are those of 8 bits that the demo writes, so that a look at the files sees the
/// same.
pub(crate) fn room() -> anyhow::Result<DemoScene> {
    let room = Room::demo();
    let gaze = room.gaze()?;
    let view = render(&room, &gaze, Exposure::default())?;
    let objects = Objects {
        names: room
            .names()
            .map(|(label, name)| (label, name.to_owned()))
            .collect(),
        labels: view.truth.labels,
    };
    let truth = view.truth.objects.iter().filter_map(|object| {
        let surface = object.surface?;
        Some(TrueObject {
            label: object.label,
            depth_m: surface.depth_m,
            position: Position::from_array(surface.point_m),
        })
    });
    Ok(DemoScene {
        name: "room",
        title: "a rendered room: a table top after the paper's Figures 5 to 9",
        truth: truth.collect(),
        eyes: view.colour.as_ref().try_map(eight_bits)?,
        rig: gaze.rig(),
        objects,
        // From in front of the nearest object to the far wall.
        span_m: (0.85, 2.4),
        true_d: file_sign::d_of_dx(view.truth.dx.view()),
        promise: Promise::DepthAndRelations {
            within_m: 0.02,
            up_to_m: 1.5,
        },
    })
}

/// A rendered colour image `[[y, x, channel]]` as the picture of 8 bits that a camera gives.
fn eight_bits(colour: &Array3<f32>) -> anyhow::Result<Picture> {
    // The cast saturates, so that a sample beyond white stays white.
    let rgb = colour.map_axis(Axis(2), |rgb| {
        [rgb[0], rgb[1], rgb[2]].map(|sample| (sample * 255.0).round() as u8)
    });
    let rgb: ArrayView2<'_, [u8; 3]> = rgb.view();
    Ok(picture::decode(&picture::encode_rgb(rgb)?)?)
}
