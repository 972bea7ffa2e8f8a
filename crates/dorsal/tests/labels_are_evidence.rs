//! What labels say of things whose distance is not known.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use std::num::NonZeroU16;

use dorsal::allocentric_qsr::{AskedPlace, Evidence, LookEvidence as _, ObjectId};
use dorsal::egocentric_depth::{
    CameraIntrinsics, DepthMap, Label, LabelImage, Position, StereoRig,
};
use dorsal::v1_gabor::{Binocular, Size};
use dorsal::{DepthEvidence, Names, SeenThings};
use ndarray::Array2;
use proptest::prelude::*;

const SIZE: Size = Size {
    width: 96,
    height: 72,
};

/// How far the eyes are above the ground.
const EYES_M: f64 = 0.5;

/// Eyes that look down at the ground.
fn rig() -> StereoRig {
    let eye = CameraIntrinsics {
        focal_px: (83.0, 83.0),
        principal_point_px: (47.5, 35.5),
    };
    let eyes = Binocular {
        left: eye,
        right: eye,
    };
    StereoRig::parallel(eyes, 0.27)
        .unwrap()
        .tilted(-0.5)
        .unwrap()
}

fn names() -> Names {
    [(Label(NonZeroU16::MIN), "cup".to_owned())]
        .into_iter()
        .collect()
}

/// Labels of a cup that covers a square of pixels.
fn cup((column, row): (usize, usize), half: usize) -> LabelImage {
    LabelImage::new(Array2::from_shape_fn(SIZE.dim(), |(y, x)| {
        u16::from(x.abs_diff(column) <= half && y.abs_diff(row) <= half)
    }))
}

/// A ball around the point at some depth on the line of sight of a pixel.
fn ball(rig: &StereoRig, pixel: (f64, f64), depth_m: f64, within_m: f64) -> AskedPlace {
    let at = rig.to_observer(rig.back_project(pixel, depth_m).unwrap());
    AskedPlace {
        right_m: at.x_m,
        forward_m: at.z_m,
        height_m: EYES_M - at.y_m,
        within_m,
        radius_m: 0.0,
    }
}

proptest! {
    /// Depths on a thing that has no place show no ground free, whatever they are; they may be chance. Where
    /// the thing is not seen, they are what they were.
    #[test]
    fn what_has_no_place_frees_no_ground(
        column in 30usize..66, row in 30usize..42, depth_m in 0.6..1.2f64, behind_m in 2.0..9.0f32,
    ) {
        let (rig, names, cup) = (rig(), names(), cup((column, row), 8));
        let depth = DepthMap::new(Array2::from_elem(SIZE.dim(), behind_m));
        let bare = DepthEvidence::new(&depth, &rig, EYES_M, 0.05);
        let asked = ball(&rig, (column as f64, row as f64), depth_m, 0.03);
        prop_assert_eq!(bare.at(asked), Evidence::FreeSpace);
        let things = SeenThings::new(&cup, &names);
        prop_assert_eq!(bare.clone().beside(&things).at(asked), Evidence::Taken);
        let aside = if column < 48 { 85.0 } else { 10.0 };
        let asked = ball(&rig, (aside, row as f64), depth_m, 0.03);
        prop_assert_eq!(bare.clone().beside(&things).at(asked), bare.at(asked));
    }

    /// A thing that is seen is not where no line of sight to its middle leads, at any depth, known or
    /// not; and it may be where one does.
    #[test]
    fn a_thing_is_where_it_is_seen(column in 20usize..76, row in 20usize..30, off in 20usize..26, depth_m in 0.7..1.5f64) {
        let (rig, names) = (rig(), names());
        // Its foot is hidden by the edge of the picture, and bears no witness.
        let labels = LabelImage::new(Array2::from_shape_fn(SIZE.dim(), |(y, x)| {
            u16::from(x.abs_diff(column) <= 5 && y >= row)
        }));
        let depth = DepthMap::new(Array2::from_elem(SIZE.dim(), f32::NAN));
        let things = SeenThings::new(&labels, &names);
        let evidence = DepthEvidence::new(&depth, &rig, EYES_M, 0.25).beside(&things);
        let cup = ObjectId::new("cup");
        let middle = things.middle(&cup).unwrap();
        let at = |column: usize| {
            let pixel = (column as f64, middle.1 as f64);
            evidence.of(&cup, ball(&rig, pixel, depth_m, 0.05))
        };
        prop_assert_eq!(at(middle.0), Evidence::NoEvidence);
        let aside = if column < 48 { column + off } else { column - off };
        prop_assert_eq!(at(aside), Evidence::Elsewhere);
    }

    /// A foot on the ground is found where it stands, and refutes a place on the same line of sight farther
    /// off than the thing may be.
    #[test]
    fn a_foot_tells_where_a_thing_stands(right_m in -0.2..0.2f64, forward_m in 0.8..1.3f64, wrong_m in 0.3..0.6f64) {
        let (rig, names) = (rig(), names());
        let eye = rig.eyes().left;
        let stands = rig.to_head(Position::new(right_m, EYES_M, forward_m));
        let (x, y) = eye.project(stands).unwrap();
        let (column, row) = (x.round() as usize, y.round() as usize);
        let labels = cup((column, row - 6), 6);
        let things = SeenThings::new(&labels, &names);
        let cup = ObjectId::new("cup");
        let foot = things.foot(&cup, &rig, EYES_M).unwrap();
        prop_assert!(foot.is_whole);
        // The pixel is rounded by half of one along either axis.
        let off_m = (foot.right_m - right_m).hypot(foot.forward_m - forward_m);
        prop_assert!(off_m < foot.pixel_m, "{off_m} {foot:?}");
        let depth = DepthMap::new(Array2::from_elem(SIZE.dim(), f32::NAN));
        let evidence = DepthEvidence::new(&depth, &rig, EYES_M, 0.25).beside(&things);
        let place = |part: f64| AskedPlace {
            right_m: right_m * part,
            forward_m: forward_m * part,
            height_m: 0.03,
            within_m: 0.12,
            radius_m: 0.05,
        };
        prop_assert_eq!(evidence.of(&cup, place(1.0)), Evidence::NoEvidence);
        prop_assert_eq!(evidence.of(&cup, place(1.0 + wrong_m / forward_m)), Evidence::Elsewhere);
    }

    /// What bears no label where nothing hides it is not there, however unsure the place: depths in the
    /// place itself are of something else. Where they are not known it may be. The whole place is in the picture:
    /// 25 cm about a point 1 m away reach its last row from row 41.75 on.
    #[test]
    fn what_is_not_seen_where_nothing_hides_it_is_gone(column in 40.0..56.0f64, row in 30.0..41.5f64, depth_m in 1.0..1.3f64) {
        let (rig, names) = (rig(), names());
        let labels = LabelImage::new(Array2::zeros(SIZE.dim()));
        let things = SeenThings::new(&labels, &names);
        let place = ball(&rig, (column, row), depth_m, 0.25);
        let cup = ObjectId::new("cup");
        let says = |depth: f64| {
            let depth = DepthMap::new(Array2::from_elem(SIZE.dim(), depth as f32));
            let evidence = DepthEvidence::new(&depth, &rig, EYES_M, 0.05).beside(&things);
            (evidence.at(place), evidence.of(&cup, place))
        };
        prop_assert_eq!(says(depth_m + 0.1), (Evidence::NoEvidence, Evidence::Elsewhere));
        prop_assert_eq!(says(f64::NAN).1, Evidence::NoEvidence);
        prop_assert_eq!(says(depth_m - 0.4).1, Evidence::Occluded);
    }
}
