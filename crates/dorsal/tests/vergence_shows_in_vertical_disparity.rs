//! What yaw does to the vertical disparities of converging eyes is found in their images.

use disparity_pyramid::{MatchParams, estimate};
use egocentric_depth::{DriftBelief, OrientationParams, RigDrift, StereoRig, relative_orientation};
use stereo_scenes::{Exposure, Gaze, Head, Room, render};
use v1_gabor::{Binocular, FilterBank, GaborParams};

/// A panel, a ball and a can a metre ahead.
const ROOM: &str = "
size_m = [6.0, 6.0, 3.0]
lamp_m = [2.0, 0.3, 2.8]
[head]
position_m = [3.0, 0.5, 1.5]
fixation_m = [3.0, 1.5, 1.5]
[walls]
far = { colour = [0.75, 0.72, 0.65], patch_m = 0.3 }
[[object]]
name = \"panel\"
shape.rectangle = { centre_m = [3.0, 1.5, 1.5], size_m = [0.2, 0.2], turn_deg = 20 }
texture = { colour = [0.9, 0.8, 0.6], patch_m = 0.05 }
[[object]]
name = \"ball\"
shape.sphere = { centre_m = [2.78, 1.5, 1.5], radius_m = 0.1 }
texture = { colour = [0.5, 0.6, 0.9], patch_m = 0.05 }
[[object]]
name = \"can\"
shape.cylinder = { base_m = [3.22, 1.5, 1.4], radius_m = 0.1, height_m = 0.2 }
texture = { colour = [0.9, 0.6, 0.5], patch_m = 0.05 }
";

/// The right eye of the paper's head has slipped by a degree about each axis, and the encoder of its
/// vergence, good to 0.2 degrees, reads 0.2 more. Matched for it, the images take more than half of that
/// error away; a twentieth of a degree is what their standard error leaves, and twice that is allowed.
#[test]
fn images_correct_the_encoder() {
    let head = Head::default();
    let camera = head.intrinsics();
    let pan = (head.baseline_m / 2.0).atan();
    let nominal = StereoRig::vergent(
        Binocular {
            left: camera,
            right: camera,
        },
        head.baseline_m,
        Binocular {
            left: pan,
            right: -pan,
        },
    )
    .expect("the head is a rig");
    let one = 1f64.to_radians();
    let out = RigDrift {
        pitch_rad: one,
        yaw_rad: one,
        roll_rad: one,
        ..RigDrift::default()
    };
    let slipped = nominal.drifted(&out).expect("it slips by little");
    let room = Room::from_toml(ROOM).expect("it is a room");
    let gaze = Gaze::new([3.0, 0.5, 1.5], 0.0, head.size, slipped).expect("it looks ahead");
    let view = render(&room, &gaze, Exposure::default()).expect("the room is rendered");
    let bank = FilterBank::plan(GaborParams::default(), head.size).expect("the bank is planned");
    let responses = view.images.as_ref().try_map(|eye| bank.respond(eye));
    let responses = responses.expect("the images are of the bank's size");

    let encoder = 0.2f64.to_radians();
    let expected = RigDrift {
        yaw_rad: one + encoder,
        ..RigDrift::default()
    };
    let sigma = RigDrift {
        pitch_rad: f64::INFINITY,
        yaw_rad: encoder,
        roll_rad: f64::INFINITY,
        down: 1e-3,
        forward: 1e-3,
    };
    let params = OrientationParams {
        matches: 20_000,
        ..OrientationParams::expecting(
            DriftBelief::new(expected, &sigma).expect("sigmas are positive"),
        )
    };
    let yaw_off = |matching: MatchParams| {
        let field = estimate(&responses, matching).expect("the eyes are matched");
        let found = relative_orientation(&field, &nominal, &params).expect("it is found");
        (found.drift.yaw_rad - one).to_degrees().abs()
    };
    let off = yaw_off(OrientationParams::matching());
    assert!(off < 0.1, "{off}");
    let usual = yaw_off(MatchParams::default());
    assert!(off < usual, "{off} {usual}");
}
