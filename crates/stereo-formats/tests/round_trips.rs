//! What a writer writes, its reader reads back.
#![allow(clippy::unwrap_used, reason = "what a test builds for itself is sound")]

use std::num::NonZeroU16;

use disparity_pyramid::{DisparityField, Validity};
use egocentric_depth::{CameraIntrinsics, DepthMap, Label, LabelImage, StereoRig};
use ndarray::{Array2, ArrayD, IxDyn, Zip};
use num_complex::Complex32;
use proptest::prelude::*;
use stereo_formats::label_polygons::{LabelPolygons, Outline};
use stereo_formats::middlebury_png::GreyScale;
use stereo_formats::names::Names;
use stereo_formats::{
    VectorPlanes, depth_png, file_sign, flo, kitti_png, label_png, label_polygons, mask_png, names,
    npy, pfm, rig_toml, validity_png,
};
use v1_gabor::{Binocular, Size};

/// A plane of up to 9 x 9 of these values.
fn plane<T: Clone + std::fmt::Debug>(
    value: impl Strategy<Value = T> + Clone,
) -> impl Strategy<Value = Array2<T>> {
    (1usize..9, 1usize..9).prop_flat_map(move |dim| plane_of(dim, value.clone()))
}

fn plane_of<T: Clone + std::fmt::Debug>(
    dim: (usize, usize),
    value: impl Strategy<Value = T>,
) -> impl Strategy<Value = Array2<T>> {
    prop::collection::vec(value, dim.0 * dim.1)
        .prop_map(move |values| Array2::from_shape_vec(dim, values).unwrap())
}

/// A number of this range, or unknown.
fn number(range: std::ops::Range<f32>) -> impl Strategy<Value = f32> + Clone {
    prop_oneof![4 => range, 1 => Just(f32::NAN)]
}

/// Equal numbers, and unknown where unknown.
fn same(a: &Array2<f32>, b: &Array2<f32>, tolerance: f32) -> bool {
    a.dim() == b.dim()
        && Zip::from(a)
            .and(b)
            .all(|a, b| (a.is_nan() && b.is_nan()) || (a - b).abs() <= tolerance)
}

fn validity() -> impl Strategy<Value = Validity> + Clone {
    prop::sample::select(&Validity::ALL[..])
}

fn field() -> impl Strategy<Value = DisparityField> {
    (1usize..9, 1usize..9).prop_flat_map(|dim| {
        (
            plane_of(dim, -99f32..99.0),
            plane_of(dim, -9f32..9.0),
            plane_of(dim, validity()),
        )
            .prop_map(move |(dx, dy, validity)| {
                DisparityField::new(dx, dy, Array2::from_elem(dim, 0.5), validity).unwrap()
            })
    })
}

proptest! {
    /// Floats come back to the last bit.
    #[test]
    fn pfm(plane in plane(number(-1e30..1e30))) {
        prop_assert!(same(&pfm::decode(&pfm::encode(plane.view()).unwrap()).unwrap(), &plane, 0.0));
    }

    /// Arrays of any shape and type come back to the last bit, and their data is aligned.
    #[test]
    fn npy(
        shape in prop::collection::vec(0usize..5, 0..5),
        re in prop::collection::vec(-1e30f32..1e30, 256),
    ) {
        let real = ArrayD::from_shape_fn(IxDyn(&shape), |at| {
            re[(0..shape.len()).fold(0, |place, axis| place * 4 + at[axis]) % 256]
        });
        let bytes = npy::encode(real.view());
        prop_assert_eq!((bytes.len() - 4 * real.len()) % 64, 0);
        prop_assert_eq!(npy::decode::<f32>(&bytes).unwrap(), real.clone());
        // Reversed axes are written in the order they are seen in.
        let turned = real.t();
        prop_assert_eq!(npy::decode::<f32>(&npy::encode(turned.view())).unwrap(), turned);
        let complex = real.mapv(|re| Complex32::new(re, 1.0 - re));
        let back = npy::decode::<Complex32>(&npy::encode(complex.view())).unwrap();
        prop_assert_eq!(back, complex);
        let truth = real.mapv(|re| re > 0.0);
        prop_assert_eq!(npy::decode::<bool>(&npy::encode(truth.view())).unwrap(), truth);
    }

    /// Shifts come back to the last bit, and what is unknown in one half is unknown in both.
    #[test]
    fn flo((dx, dy) in (1usize..9, 1usize..9).prop_flat_map(|dim| {
        (plane_of(dim, number(-1e3..1e3)), plane_of(dim, number(-1e3..1e3)))
    })) {
        let vectors = VectorPlanes::new(dx, dy).unwrap();
        let back = flo::decode(&flo::encode(&vectors).unwrap()).unwrap();
        for y in 0..vectors.size().height {
            for x in 0..vectors.size().width {
                prop_assert_eq!(back.at(x, y), vectors.at(x, y));
            }
        }
    }

    /// The sign turns once: a file holds `-dx`, and unknown only where the field is not valid.
    #[test]
    fn fields(field in field(), dense: bool) {
        let d = pfm::decode(&pfm::encode_disparity(&field, dense).unwrap()).unwrap();
        let dx = file_sign::dx_of_d(d.view());
        let vectors = flo::decode(&flo::encode_disparity(&field, dense).unwrap()).unwrap();
        for ((y, x), &dx) in dx.indexed_iter() {
            let guess = field.guess(x, y);
            if dense || field.at(x, y).is_some() {
                prop_assert_eq!(dx, guess.dx);
                prop_assert_eq!(vectors.at(x, y), Some((guess.dx, guess.dy)));
            } else {
                prop_assert!(dx.is_nan());
                prop_assert_eq!(vectors.at(x, y), None);
            }
        }
    }

    /// KITTI's steps are 1/256 px: half a step is lost at most.
    #[test]
    fn kitti(plane in plane(number(0.002..255.9))) {
        let back = kitti_png::decode(&kitti_png::encode(plane.view()).unwrap()).unwrap();
        prop_assert!(same(&back, &plane, 0.5 / 256.0));
    }

    /// Grey steps are 1/scale px: half a step is lost at most, beside one rounding of f32.
    #[test]
    fn middlebury(plane in plane(number(0.6..15.9)), scale in 1f32..16.0, unknown in 0u8..=0) {
        let scale_px = GreyScale::new(scale, unknown).unwrap();
        let back = scale_px.decode(&scale_px.encode(plane.view()).unwrap()).unwrap();
        prop_assert!(same(&back, &plane, 0.5 / scale + 1e-5));
    }

    /// Millimetres: half of one is lost at most, beside one rounding of f32 at 65 m.
    #[test]
    fn depth(plane in plane(number(0.001..65.5))) {
        let depth = DepthMap::new(plane);
        let back = depth_png::decode(&depth_png::encode(&depth).unwrap()).unwrap();
        prop_assert!(same(&back.metres().to_owned(), &depth.metres().to_owned(), 0.000_51));
    }

    #[test]
    fn validities(plane in plane(validity())) {
        let back = validity_png::decode(&validity_png::encode(plane.view()).unwrap()).unwrap();
        prop_assert_eq!(back, plane);
    }

    #[test]
    fn masks(plane in plane(any::<bool>())) {
        let back = mask_png::decode(&mask_png::encode(plane.view()).unwrap()).unwrap();
        prop_assert_eq!(back, plane);
    }

    /// Labels come back whether they need one byte or two.
    #[test]
    fn labels(plane in plane(any::<u16>()), few: bool) {
        let labels = LabelImage::new(if few { plane.mapv(|label| label % 7) } else { plane });
        let back = label_png::decode(&label_png::encode(&labels).unwrap()).unwrap();
        prop_assert_eq!(back, labels);
    }

    /// Names come back, whatever letters they have.
    #[test]
    fn all_names(texts in prop::collection::btree_map(1u16.., "\\PC{0,8}", 0..6)) {
        let names: Names = texts
            .into_iter()
            // Its last word makes each name its own.
            .map(|(label, text)| (Label(NonZeroU16::new(label).unwrap()), format!("{text} {label}")))
            .collect();
        prop_assert_eq!(names::decode(&names::encode(&names).unwrap()).unwrap(), names);
    }

    /// Outlines come back to the last bit.
    #[test]
    fn polygons(
        polygons in prop::collection::vec(
            prop::collection::vec((-0.5f64..9.5, -0.5f64..7.5), 3..6), 0..4,
        ),
    ) {
        let objects = polygons.into_iter().enumerate().map(|(index, corners)| Outline {
            name: format!("object {index}"),
            polygon: corners.into_iter().map(|(x, y)| [x, y]).collect(),
        });
        let size = Size { width: 10, height: 8 };
        let polygons = LabelPolygons::new(size, objects.collect()).unwrap();
        let back = label_polygons::decode(&label_polygons::encode(&polygons).unwrap()).unwrap();
        prop_assert_eq!(back, polygons);
    }

    /// Lengths come back exactly, angles within the rounding of degrees.
    #[test]
    fn rigs(
        baseline_m in 0.001f64..10.0,
        focal in prop::array::uniform4(1f64..1e4),
        point in prop::array::uniform4(-1e3f64..1e4),
        left in 0f64..1.5,
        right in -1.5f64..0.0,
        tilt in -1.5f64..1.5,
        parallel: bool,
    ) {
        let eye = |i: usize| CameraIntrinsics {
            focal_px: (focal[i], focal[i + 1]),
            principal_point_px: (point[i], point[i + 1]),
        };
        let eyes = Binocular { left: eye(0), right: eye(2) };
        let rig = if parallel {
            StereoRig::parallel(eyes, baseline_m).unwrap()
        } else {
            StereoRig::vergent(eyes, baseline_m, Binocular { left, right })
                .and_then(|rig| rig.tilted(tilt))
                .unwrap()
        };
        let back = rig_toml::decode(&rig_toml::encode(&rig).unwrap()).unwrap();
        prop_assert_eq!(back.baseline_m(), rig.baseline_m());
        prop_assert_eq!(back.intrinsics(), rig.intrinsics());
        // A few steps of f64 near one radian.
        prop_assert!((back.pan_rad().left - rig.pan_rad().left).abs() < 1e-15);
        prop_assert!((back.pan_rad().right - rig.pan_rad().right).abs() < 1e-15);
        prop_assert!((back.tilt_rad() - rig.tilt_rad()).abs() < 1e-15);
    }
}
