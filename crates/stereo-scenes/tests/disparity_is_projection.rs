//! The truth of a view is the geometry of its rig, whatever the textures.
#![allow(
    clippy::unwrap_used,
    reason = "a law that cannot be tested fails its test"
)]

use egocentric_depth::StereoRig;
use proptest::prelude::*;
use stereo_scenes::{Exposure, Gaze, Head, Room, View, render};
use v1_gabor::{Binocular, Size};

const SMALL: Size = Size {
    width: 64,
    height: 48,
};

fn look(room: &Room, gaze: &Gaze) -> View {
    let exposure = Exposure {
        samples: 1,
        ..Exposure::default()
    };
    render(room, gaze, exposure).unwrap()
}

/// A pixel of an eye as a ray of the head frame, in the words of `StereoRig`: the origin shifted
/// along the baseline, the direction panned toward +x. Written apart from the crate's own.
fn head_ray(rig: &StereoRig, left: bool, (u, v): (f64, f64)) -> ([f64; 3], [f64; 3]) {
    let half = rig.baseline_m() / 2.0;
    let (camera, pan, x) = if left {
        (rig.intrinsics().left, rig.pan_rad().left, -half)
    } else {
        (rig.intrinsics().right, rig.pan_rad().right, half)
    };
    let right = (u - camera.principal_point_px.0) / camera.focal_px.0;
    let down = (v - camera.principal_point_px.1) / camera.focal_px.1;
    let azimuth = pan + right.atan();
    let length = right.hypot(1.0);
    (
        [x, 0.0, 0.0],
        [length * azimuth.sin(), down, length * azimuth.cos()],
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    /// The rays of matching pixels meet, at the depth that the truth states.
    #[test]
    fn matching_rays_meet_at_the_true_depth(
        x in -0.4f64..0.4, y in 0.7f64..1.6, z in 0.75f64..1.3, heading in -0.3f64..0.3,
    ) {
        let room = Room::demo();
        let mut head = room.head().resized(SMALL);
        head.heading_rad = heading;
        let [px, py, _] = head.position_m;
        let gaze = head.fixate([px + x, py + y, z]).unwrap();
        let truth = look(&room, &gaze).truth;
        let rig = gaze.rig();
        for ((v, u), &dx) in truth.dx.indexed_iter() {
            let depth = f64::from(truth.depth.at(u, v).unwrap());
            let (u, v, dy) = (u as f64, v as f64, f64::from(truth.dy[[v, u]]));
            prop_assert!(dx.is_finite());
            let (lo, ld) = head_ray(&rig, true, (u, v));
            let (ro, rd) = head_ray(&rig, false, (u + f64::from(dx), v + dy));
            let at = |o: [f64; 3], d: [f64; 3], k: usize| o[k] + d[k] * depth / d[2];
            // f32 keeps disparities of 30 px to 2e-6 px, which a head of 55 px focal length
            // sees as 4e-8 rad; at 3 m that is a tenth of a micrometre. Depth adds as much.
            prop_assert!((at(lo, ld, 0) - at(ro, rd, 0)).abs() < 2e-6);
            prop_assert!((at(lo, ld, 1) - at(ro, rd, 1)).abs() < 2e-6);
        }
    }

    /// Both eyes see the fixation point at their principal points.
    #[test]
    fn fixation_is_at_both_principal_points(
        x in -1.0f64..1.0, y in 0.2f64..2.0, z in -1.0f64..1.0, heading in -0.1f64..0.1,
    ) {
        let head = Head { heading_rad: heading, ..Head::default() };
        let point = [x, y + x.abs(), z];
        let seen = head.fixate(point).unwrap().project(point);
        for (u, v) in [seen.left.unwrap(), seen.right.unwrap()] {
            prop_assert!((u - 511.5).abs() < 1e-6 && (v - 383.5).abs() < 1e-6);
        }
    }
}

/// A frontoparallel panel has one depth; parallel eyes see it at one disparity, `-f b / Z`.
#[test]
fn a_frontal_panel_has_one_depth_and_one_disparity() {
    let room = Room::shelf();
    let head = room.head().resized(SMALL);
    let vergent = head.fixate(room.fixation_m()).unwrap();
    let camera = head.intrinsics();
    let eyes = Binocular {
        left: camera,
        right: camera,
    };
    let rig = StereoRig::parallel(eyes, head.baseline_m).unwrap();
    let parallel = Gaze::new(head.position_m, head.heading_rad, SMALL, rig).unwrap();
    let expected = -head.focal_px * head.baseline_m / 1.2;
    for (gaze, one_disparity) in [(vergent, false), (parallel, true)] {
        let truth = look(&room, &gaze).truth;
        let panel = &truth.objects[0];
        assert_eq!(panel.name, "frontal panel");
        assert!(panel.pixels > 100);
        for ((y, x), &label) in truth.labels.plane().indexed_iter() {
            if label == panel.label.0.get() {
                // A step of f32 at 1.2 m is 1.2e-7 m, at 12 px 1e-6 px.
                assert!((truth.depth.at(x, y).unwrap() - 1.2).abs() < 1e-6);
                if one_disparity {
                    assert!((f64::from(truth.dx[[y, x]]) - expected).abs() < 1e-5);
                    assert!(truth.dy[[y, x]].abs() < 1e-5);
                }
            }
        }
    }
}
