//! What a depth map says of a place where nothing was reported.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use dorsal::DepthEvidence;
use dorsal::allocentric_qsr::{AskedPlace, Evidence, LookEvidence as _};
use dorsal::egocentric_depth::{CameraIntrinsics, DepthMap, Head, Position, StereoRig};
use dorsal::v1_gabor::{Binocular, Size};
use ndarray::Array2;
use proptest::prelude::*;

const SIZE: Size = Size {
    width: 96,
    height: 72,
};

/// How far the eyes are above the ground.
const EYES_M: f64 = 0.5;

fn rig(tilt_rad: f64, pan_rad: f64) -> StereoRig {
    let eye = CameraIntrinsics {
        focal_px: (83.0, 83.0),
        principal_point_px: (47.5, 35.5),
    };
    let eyes = Binocular {
        left: eye,
        right: eye,
    };
    let pans = Binocular {
        left: pan_rad,
        right: -pan_rad,
    };
    StereoRig::vergent(eyes, 0.27, pans)
        .unwrap()
        .tilted(tilt_rad)
        .unwrap()
}

/// A wall across the head's way, the same depth everywhere.
fn wall(depth_m: f32) -> DepthMap {
    DepthMap::new(Array2::from_elem(SIZE.dim(), depth_m))
}

/// The place of a point of the head frame.
fn place(rig: &StereoRig, at: Position<Head>, within_m: f64) -> AskedPlace {
    let level = rig.to_observer(at);
    AskedPlace {
        right_m: level.x_m,
        forward_m: level.z_m,
        height_m: EYES_M - level.y_m,
        within_m,
        radius_m: 0.7 * within_m,
    }
}

/// A point on the line of sight of a pixel, some way into the image.
fn points() -> impl Strategy<Value = ((f64, f64), f64)> {
    ((35.0..61.0f64, 28.0..44.0f64), 0.6..1.6f64)
}

proptest! {
    /// Before a wall is free space, behind it nothing is known, and a wall in the place itself may
    /// be the object; all with a hole in the measurement where nothing is said.
    #[test]
    fn a_wall_says_what_is_free(
        (pixel, depth_m) in points(), tilt in -0.7..0.2f64, pan in 0.0..0.12f64, within_m in 0.01..0.06f64,
    ) {
        let rig = rig(tilt, pan);
        let at = rig.back_project(pixel, depth_m).unwrap();
        let asked = place(&rig, at, within_m);
        let says = |depth: &DepthMap| DepthEvidence::new(depth, &rig, EYES_M, 0.25).at(asked);
        // A quarter pixel is less than 2 cm in depth with this rig, at any of these depths; three of
        // them and the radius are less than 14 cm.
        let margin = 0.16 + within_m;
        prop_assert_eq!(says(&wall((depth_m + margin) as f32)), Evidence::FreeSpace);
        prop_assert_eq!(says(&wall((depth_m - margin) as f32)), Evidence::Occluded);
        prop_assert_eq!(says(&wall(depth_m as f32)), Evidence::NoEvidence);
        prop_assert_eq!(says(&wall(f32::NAN)), Evidence::NoEvidence);
        // A hole over most of the window says nothing, whatever is seen beside it.
        let holed = Array2::from_shape_fn(SIZE.dim(), |(y, x)| {
            let beside = (x as f64 - pixel.0).hypot(y as f64 - pixel.1) > 12.0;
            if beside { 9.0 } else { f32::NAN }
        });
        prop_assert_eq!(says(&DepthMap::new(holed)), Evidence::NoEvidence);
    }

    /// A surface that covers a good part of the window keeps it from being free.
    #[test]
    fn an_object_in_the_place_is_no_free_space((pixel, depth_m) in points(), tilt in -0.7..0.2f64) {
        let rig = rig(tilt, 0.0);
        let at = rig.back_project(pixel, depth_m).unwrap();
        let asked = place(&rig, at, 0.05);
        let near = 83.0 * 0.05 / depth_m;
        let depth = Array2::from_shape_fn(SIZE.dim(), |(y, x)| {
            let on = (x as f64 - pixel.0).hypot(y as f64 - pixel.1) < 0.7 * near;
            if on { depth_m as f32 } else { 5.0 }
        });
        let depth = DepthMap::new(depth);
        let says = DepthEvidence::new(&depth, &rig, EYES_M, 0.25).at(asked);
        prop_assert_eq!(says, Evidence::NoEvidence);
    }

    /// What lies outside the image, or behind the head, is out of view.
    #[test]
    fn beyond_the_image_nothing_is_seen(column in 100.0..400.0f64, row in 28.0..44.0f64, depth_m in 0.6..1.6f64) {
        let rig = rig(-0.3, 0.05);
        let depth = wall(9.0);
        let evidence = DepthEvidence::new(&depth, &rig, EYES_M, 0.25);
        let aside = rig.back_project((column, row), depth_m).unwrap();
        prop_assert_eq!(evidence.at(place(&rig, aside, 0.02)), Evidence::OutOfView);
        let behind = Position::new(0.0, 0.0, -depth_m);
        prop_assert_eq!(evidence.at(place(&rig, behind, 0.02)), Evidence::OutOfView);
        // A ball that leaves the image may hold the object where nobody looks.
        let edge = rig.back_project((94.0, row), depth_m).unwrap();
        prop_assert_eq!(evidence.at(place(&rig, edge, 0.2)), Evidence::NoEvidence);
    }
}

/// A ball that holds the eye itself has no window.
#[test]
fn a_place_as_wide_as_its_distance_says_nothing() {
    let rig = rig(0.0, 0.0);
    let depth = wall(9.0);
    let asked = place(&rig, Position::new(-0.135, 0.0, 0.3), 0.5);
    let says = DepthEvidence::new(&depth, &rig, EYES_M, 0.25).at(asked);
    assert_eq!(says, Evidence::NoEvidence);
}
