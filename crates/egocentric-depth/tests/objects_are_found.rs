//! What stands on a plane is found without labels, however the eyes stand.
#![allow(
    clippy::unwrap_used,
    reason = "a law that cannot be tested fails its test"
)]

use egocentric_depth::{
    CameraIntrinsics, DepthMap, Head, NoSupport, NotSegmentable, Position, SegmentParams,
    StereoRig, SupportParams, SupportPlane, segment,
};
use ndarray::Array2;
use proptest::prelude::*;
use v1_gabor::Binocular;

const WIDTH: usize = 160;
const HEIGHT: usize = 120;

fn rig(tilt_rad: f64) -> StereoRig {
    let camera = CameraIntrinsics {
        focal_px: (140.0, 140.0),
        principal_point_px: (79.5, 59.5),
    };
    let both = Binocular {
        left: camera,
        right: camera,
    };
    StereoRig::parallel(both, 0.2)
        .unwrap()
        .tilted(tilt_rad)
        .unwrap()
}

/// Depths of a level plane `below_m` under the eyes out to 2 m, a wall there, and bodies on the plane:
/// upright cards that face the head, `(right, ahead, width, height)` in metres.
fn depths(rig: &StereoRig, below_m: f64, cards: &[(f64, f64, f64, f64)]) -> DepthMap {
    let eye = rig.eyes().left;
    DepthMap::new(Array2::from_shape_fn((HEIGHT, WIDTH), |(y, x)| {
        let ray = eye.ray((x as f64, y as f64)).unwrap();
        // The observer frame is level; its origin is the head's.
        let from = rig.to_observer(ray.origin).to_array();
        let [dx, dy, dz] = ray.direction;
        let way = rig
            .to_observer(Position::<Head>::new(dx, dy, dz))
            .to_array();
        let at = |stretch: f64| -> [f64; 3] { std::array::from_fn(|i| from[i] + stretch * way[i]) };
        let mut nearest = 2.0 / way[2];
        if way[1] > 0.0 {
            nearest = nearest.min((below_m - from[1]) / way[1]);
        }
        for &(right, ahead, width, height) in cards {
            let stretch = ahead / way[2];
            let [hit_x, hit_y, _] = at(stretch);
            let on = (hit_x - right).abs() <= width / 2.0
                && (below_m - height..=below_m).contains(&hit_y);
            if on {
                nearest = nearest.min(stretch);
            }
        }
        // Depth is the z of the head frame, along which the direction goes by `dz` a step.
        (ray.origin.z_m + nearest * dz) as f32
    }))
}

fn grey() -> Array2<[u8; 3]> {
    Array2::from_elem((HEIGHT, WIDTH), [128; 3])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The plane is found to a few millimetres under every tilt, and each card is one object.
    #[test]
    fn cards_on_a_table_are_found(
        tilt_rad in -0.7f64..-0.3,
        below_m in 0.35f64..0.5,
        right_m in -0.25f64..-0.1,
        ahead_m in 0.85f64..1.1,
        height_m in 0.08f64..0.16,
    ) {
        let rig = rig(tilt_rad);
        let cards = [(right_m, ahead_m, 0.12, height_m), (0.15, 0.95, 0.1, 0.1)];
        let depth = depths(&rig, below_m, &cards);
        let found = segment(&depth, grey().view(), &rig, &SegmentParams::default()).unwrap();
        let eye_height_m = found.support.height_m(Position::new(0.0, 0.0, 0.0));
        prop_assert!((eye_height_m - below_m).abs() < 0.005, "{eye_height_m}");
        // From left to right.
        let labels = found.labels.labels();
        prop_assert_eq!(labels.len(), 2);
        for (card, label) in cards.iter().zip(labels) {
            let (right, ahead, _, height) = *card;
            let middle = Position::new(right, below_m - height / 2.0, ahead);
            let (u, v) = rig.project(rig.to_head(middle)).unwrap().left;
            prop_assert_eq!(found.labels.at(u.round() as usize, v.round() as usize), Some(label));
        }
    }
}

#[test]
fn a_bare_table_has_no_objects() {
    let rig = rig(-0.5);
    let depth = depths(&rig, 0.4, &[]);
    let found = segment(&depth, grey().view(), &rig, &SegmentParams::default()).unwrap();
    assert!(found.labels.labels().is_empty());
}

/// A wall is no support, and a view without depths has none; both say so.
#[test]
fn without_a_plane_there_is_a_reason() {
    let rig = rig(0.0);
    let wall = DepthMap::new(Array2::from_elem((HEIGHT, WIDTH), 1.5));
    let refused = segment(&wall, grey().view(), &rig, &SegmentParams::default()).unwrap_err();
    assert!(
        matches!(
            refused,
            NotSegmentable::NoSupport(NoSupport::NoPlane { .. })
        ),
        "{refused}"
    );
    let nothing = DepthMap::new(Array2::from_elem((HEIGHT, WIDTH), f32::NAN));
    let refused = SupportPlane::find(&nothing, &rig, &SupportParams::default()).unwrap_err();
    assert!(matches!(refused, NoSupport::TooFewDepths { known: 0, .. }));
    let small = Array2::from_elem((3, 3), [0; 3]);
    let refused = segment(&wall, small.view(), &rig, &SegmentParams::default()).unwrap_err();
    assert!(matches!(refused, NotSegmentable::Sizes { .. }));
}
