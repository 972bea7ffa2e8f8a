//! Where an object is depends on its known depths alone.
use std::f64::consts::{FRAC_PI_2, PI};
use std::num::NonZeroU16;

use egocentric_depth::{
    CameraIntrinsics, DepthMap, EgocentricScene, Label, LabelImage, LocateParams, NotLocatable,
    StereoRig, WhyUnlocated, locate,
};
use ndarray::{Array2, s};
use proptest::prelude::*;
use v1_gabor::{Binocular, Size};

fn rig() -> StereoRig {
    let eye = CameraIntrinsics {
        focal_px: (110.0, 110.0),
        principal_point_px: (63.5, 47.5),
    };
    let eyes = Binocular {
        left: eye,
        right: eye,
    };
    StereoRig::parallel(eyes, 0.27).expect("the rig sees depth")
}

fn label(number: u16) -> Label {
    Label(NonZeroU16::new(number).expect("0 is no label"))
}

/// A wall at 3 m with a box at 1 m on the left and one at 1.5 m on the right, labelled 1 and 2.
fn room() -> (Array2<f32>, Array2<u16>) {
    let mut depth = Array2::from_elem((96, 128), 3.0);
    let mut labels = Array2::zeros((96, 128));
    depth.slice_mut(s![30..60, 20..50]).fill(1.0);
    labels.slice_mut(s![30..60, 20..50]).fill(1);
    depth.slice_mut(s![40..80, 80..110]).fill(1.5);
    labels.slice_mut(s![40..80, 80..110]).fill(2);
    (depth, labels)
}

fn look(depth: &Array2<f32>, labels: &Array2<u16>) -> EgocentricScene {
    let depth = DepthMap::new(depth.clone());
    let labels = LabelImage::new(labels.clone());
    locate(&depth, &labels, &rig(), &LocateParams::default()).expect("the sizes agree")
}

/// The centroid of a box, by hand: the pixel (34.5, 44.5) at 1 m.
#[test]
fn a_box_is_where_it_is() {
    let (depth, labels) = room();
    let scene = look(&depth, &labels);
    let found = scene.object(label(1)).unwrap();
    assert_eq!(found.pixel, (34.5, 44.5));
    assert_eq!(found.depth_m, 1.0);
    assert!((found.position.x_m - (-29.0 / 110.0 - 0.135)).abs() < 1e-12);
    assert!((found.position.y_m + 3.0 / 110.0).abs() < 1e-12);
    assert_eq!(found.position.z_m, 1.0);
    assert!(found.bearing_rad() > FRAC_PI_2 && found.bearing_rad() < PI);
    let [sigma_x, sigma_y, sigma_z] = found.sigma_m();
    // A flat box: only the quarter pixel of disparity, Z^2 sigma / (b f).
    assert!((sigma_z - 0.25 / (0.27 * 110.0)).abs() < 1e-9);
    // A pixel of the label and the depth's share, seen under 29 / 110 and 3 / 110.
    assert!((sigma_x - (1.0 / 110.0f64).hypot(29.0 / 110.0 * sigma_z)).abs() < 1e-9);
    assert!((sigma_y - (1.0 / 110.0f64).hypot(3.0 / 110.0 * sigma_z)).abs() < 1e-9);
    assert!(found.distance_sigma_m() > sigma_z * 0.9);
    assert!(found.bearing_sigma_rad() < 0.02);
    assert_eq!(
        (found.pixels, found.reliable_pixels, found.agreeing_pixels),
        (900, 900, 900)
    );
    assert!(scene.object(label(2)).unwrap().bearing_rad() < FRAC_PI_2);
}

/// A label drawn four pixels too wide on all sides, so that two fifths of it show the wall, finds
/// the box all the same.
#[test]
fn a_bleeding_label_finds_the_box() {
    let (depth, mut labels) = room();
    labels.slice_mut(s![26..64, 16..54]).fill(1);
    let scene = look(&depth, &labels);
    let found = scene.object(label(1)).unwrap();
    assert_eq!(found.depth_m, 1.0);
    assert_eq!(found.pixel, (34.5, 44.5));
    assert_eq!((found.pixels, found.agreeing_pixels), (1444, 900));
}

/// A slanted object keeps all its pixels and its middle depth.
#[test]
fn a_slanted_object_is_not_trimmed() {
    let (mut depth, labels) = room();
    for (x, mut column) in depth
        .slice_mut(s![30..60, 20..50])
        .columns_mut()
        .into_iter()
        .enumerate()
    {
        column.fill(1.0 + 0.02 * x as f32);
    }
    let scene = look(&depth, &labels);
    let found = scene.object(label(1)).unwrap();
    assert_eq!(found.agreeing_pixels, 900);
    assert!((found.depth_m - 1.29).abs() < 1e-6);
    assert!(found.spread_m > 0.15);
}

#[test]
fn without_depth_there_is_no_place() {
    let (mut depth, mut labels) = room();
    depth.slice_mut(s![30..60, 20..50]).fill(f32::NAN);
    depth.slice_mut(s![30..31, 20..35]).fill(1.0);
    labels[[0, 0]] = 9;
    depth[[0, 0]] = f32::NAN;
    let scene = look(&depth, &labels);
    assert_eq!(scene.objects.len(), 1);
    let reason = WhyUnlocated::TooFewReliablePixels { needed: 16 };
    let [first, second] = scene.unlocated[..] else {
        panic!("two objects have no place")
    };
    assert_eq!(
        (first.label, first.pixels, first.reliable_pixels),
        (label(1), 900, 15)
    );
    assert_eq!(
        (second.label, second.pixels, second.reliable_pixels),
        (label(9), 1, 0)
    );
    assert_eq!((first.reason, second.reason), (reason, reason));
}

#[test]
fn sizes_that_differ_are_named() {
    let depth = DepthMap::new(Array2::ones((2, 3)));
    let labels = LabelImage::new(Array2::zeros((3, 2)));
    let refused = locate(&depth, &labels, &rig(), &LocateParams::default()).unwrap_err();
    assert_eq!(
        refused,
        NotLocatable::Sizes {
            depth: Size {
                width: 3,
                height: 2
            },
            labels: Size {
                width: 2,
                height: 3
            },
        }
    );
    assert!(refused.to_string().contains("3 x 2") && refused.to_string().contains("2 x 3"));
}

/// Depths below the confidence asked for do not count.
#[test]
fn confidence_decides_what_is_reliable() {
    let (depth, labels) = room();
    let mut confidence = Array2::ones(depth.dim());
    confidence.slice_mut(s![30..45, ..]).fill(0.2);
    let depth = DepthMap::new(depth)
        .only_confident(confidence.view(), 0.5)
        .unwrap();
    let scene = locate(
        &depth,
        &LabelImage::new(labels),
        &rig(),
        &LocateParams::default(),
    )
    .unwrap();
    assert_eq!(scene.object(label(1)).unwrap().reliable_pixels, 450);
    assert!(
        depth
            .only_confident(Array2::ones((2, 2)).view(), 0.5)
            .is_err()
    );
}

proptest! {
    /// Labels are names: other numbers give the same objects.
    #[test]
    fn numbering_does_not_matter(first in 1u16..=u16::MAX, second in 1u16..=u16::MAX) {
        prop_assume!(first != second);
        let (depth, labels) = room();
        let renamed = labels.mapv(|number| [0, first, second][usize::from(number)]);
        let (before, after) = (look(&depth, &labels), look(&depth, &renamed));
        for (old, new) in [(1, first), (2, second)] {
            let mut expected = *before.object(label(old)).unwrap();
            expected.label = label(new);
            prop_assert_eq!(Some(&expected), after.object(label(new)));
        }
        prop_assert!(after.objects.is_sorted_by_key(|object| object.label));
    }

    /// Unknown pixels added to a label change its count, and make it no more certain where it is; they
    /// change nothing else.
    #[test]
    fn unknown_pixels_never_move_an_object(x in 0usize..120, y in 0usize..80, extent in 1usize..40) {
        let (mut depth, mut labels) = room();
        let before = look(&depth, &labels);
        let window = s![y..(y + extent).min(96), x..(x + extent).min(128)];
        let mut added = 0;
        for (z, number) in depth.slice_mut(window).iter_mut().zip(labels.slice_mut(window)) {
            if *number == 0 {
                (*z, *number) = (f32::NAN, 1);
                added += 1;
            }
        }
        let mut expected = before.objects;
        expected[0].pixels += added;
        let found = look(&depth, &labels).objects;
        for (sure, less_sure) in expected[0].sigma_m().into_iter().zip(found[0].sigma_m()) {
            // Sums of the same squares in the same order.
            prop_assert!(less_sure >= sure);
        }
        expected[0].covariance_m2 = found[0].covariance_m2;
        prop_assert_eq!(expected, found);
    }

    /// Tilting the head turns the positions by the tilt and changes no depth.
    #[test]
    fn tilt_turns_positions(tilt in -1.0f64..1.0) {
        let (depth, labels) = room();
        let (depth, labels) = (DepthMap::new(depth), LabelImage::new(labels));
        let level = locate(&depth, &labels, &rig(), &LocateParams::default()).unwrap();
        let tilted_rig = rig().tilted(tilt).unwrap();
        let tilted = locate(&depth, &labels, &tilted_rig, &LocateParams::default()).unwrap();
        for (level, tilted) in level.objects.iter().zip(&tilted.objects) {
            prop_assert_eq!(level.depth_m, tilted.depth_m);
            let in_head = tilted_rig.to_head(tilted.position).to_array();
            for (a, b) in level.position.to_array().iter().zip(in_head) {
                prop_assert!((a - b).abs() < 1e-14);
            }
            let trace = |c: [[f64; 3]; 3]| c[0][0] + c[1][1] + c[2][2];
            prop_assert!((trace(level.covariance_m2) / trace(tilted.covariance_m2) - 1.0).abs() < 1e-12);
        }
    }
}
