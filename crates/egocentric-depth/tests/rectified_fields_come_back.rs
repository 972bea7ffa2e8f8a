//! A field of a rectified pair, carried back to the pictures as they were taken, tells the same depths.
#![allow(
    clippy::unwrap_used,
    reason = "a law that cannot be tested fails its test"
)]

use disparity_pyramid::{DisparityField, Validity};
use egocentric_depth::{
    Attitude, CameraIntrinsics, Lens, Rectification, StereoRig, WrongFieldSize, triangulate,
};
use ndarray::Array2;
use proptest::prelude::*;
use v1_gabor::{Binocular, Size};

const SIZE: Size = Size {
    width: 80,
    height: 60,
};

fn rig(angles: [f64; 4], barrel: f64) -> StereoRig {
    let camera = CameraIntrinsics {
        focal_px: (90.0, 90.0),
        principal_point_px: (39.5, 29.5),
    };
    let both = Binocular {
        left: camera,
        right: camera,
    };
    let [pan, tilt, torsion, other_tilt] = angles;
    let attitude = |pan_rad, tilt_rad, torsion_rad| Attitude {
        pan_rad,
        tilt_rad,
        torsion_rad,
    };
    let lens = Lens::BrownConrady([barrel, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    StereoRig::aimed(
        both,
        0.2,
        Binocular {
            left: attitude(pan, tilt, torsion),
            right: attitude(-pan, other_tilt, -torsion),
        },
    )
    .unwrap()
    .with_lenses(Binocular {
        left: lens,
        right: lens,
    })
    .unwrap()
}

/// A field that is everywhere this shift.
fn flat(dx: f32) -> DisparityField {
    let plane = |value: f32| Array2::from_elem(SIZE.dim(), value);
    let valid = Array2::from_elem(SIZE.dim(), Validity::Valid);
    DisparityField::new(plane(dx), plane(0.0), plane(1.0), valid).unwrap()
}

proptest! {
    /// One disparity of the rectified pair is one depth in the frame of the baseline, and a plane that
    /// faces it; so is the field that came back, by the rig as it is.
    #[test]
    fn depths_are_kept(
        pan in 0.02f64..0.12,
        tilt in -0.05f64..0.05,
        torsion in -0.05f64..0.05,
        other_tilt in -0.05f64..0.05,
        barrel in -0.1f64..0.05,
        dx in -4.0f32..0.0,
    ) {
        let rig = rig([pan, tilt, torsion, other_tilt], barrel);
        let plan = Rectification::plan(&rig, SIZE).unwrap();
        let [left, right] = [plan.rig().intrinsics().left, plan.rig().intrinsics().right];
        let parallax_px = right.principal_point_px.0 - left.principal_point_px.0 - f64::from(dx);
        prop_assume!(parallax_px > 2.0);
        let depth_m = left.focal_px.0 * rig.baseline_m() / parallax_px;
        let back = plan.as_taken(&flat(dx)).unwrap();
        let depth = triangulate(&back, &rig);
        // The middle is seen by both pictures. Neither frame is turned against the other by more than
        // the tilts, but the head's z and the baseline's are not the same axis, so compare along it.
        let pixel = (40usize, 30usize);
        let found_m = f64::from(depth.at(pixel.0, pixel.1).unwrap());
        let place = rig.back_project((40.0, 30.0), found_m).unwrap();
        let aligned = StereoRig::from_pose(rig.intrinsics(), &rig.relative_pose()).unwrap();
        let to_aligned = aligned.eyes().left.rotation.after(&rig.eyes().left.rotation.inverse());
        let from = rig.eyes().left.centre.to_array();
        let way: [f64; 3] = std::array::from_fn(|i| place.to_array()[i] - from[i]);
        let along = to_aligned.apply(way)[2];
        // Shifts are f32, and the depth of two pixels of parallax feels 1e-5 of them.
        prop_assert!((along / depth_m - 1.0).abs() < 1e-4, "{along} {depth_m}");
    }
}

#[test]
fn a_field_of_another_size_is_refused() {
    let plan = Rectification::plan(&rig([0.1, 0.0, 0.0, 0.0], 0.0), SIZE).unwrap();
    let small = DisparityField::new(
        Array2::zeros((4, 4)),
        Array2::zeros((4, 4)),
        Array2::ones((4, 4)),
        Array2::from_elem((4, 4), Validity::Valid),
    )
    .unwrap();
    let refused: WrongFieldSize = plan.as_taken(&small).unwrap_err();
    assert!(refused.to_string().contains("4"), "{refused}");
}
