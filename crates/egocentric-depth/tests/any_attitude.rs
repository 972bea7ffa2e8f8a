//! Eyes of any attitude, behind any lens, at any pose: projecting and triangulating are inverse to one
//! another, and what cannot be a rig is refused with the number.
use disparity_pyramid::{DisparityField, Validity};
use egocentric_depth::{
    Attitude, BadRig, CameraIntrinsics, Head, Lens, Position, Rectification, RelativePose,
    RigDrift, Rotation, StereoRig, general_form, midpoint, triangulate,
};
use ndarray::Array2;
use proptest::prelude::*;
use v1_gabor::{Binocular, Size};

fn camera(focal_px: f64) -> CameraIntrinsics {
    CameraIntrinsics {
        focal_px: (focal_px, focal_px * 1.01),
        principal_point_px: (321.0, 238.0),
    }
}

fn both<T: Copy>(eye: T) -> Binocular<T> {
    Binocular {
        left: eye,
        right: eye,
    }
}

prop_compose! {
    /// A head that turns its eyes every way, behind wide lenses.
    fn heads()(
        baseline_m in 0.05f64..0.4,
        focal_px in 300f64..900.0,
        vergence in 0.0f64..0.3,
        pan in -0.2f64..0.2,
        tilts in prop::array::uniform2(-0.1f64..0.1),
        torsions in prop::array::uniform2(-0.2f64..0.2),
        slip in (-0.02f64..0.02, -0.02f64..0.02),
        tilt in -0.8f64..0.8,
        kind in 0u8..3,
    ) -> StereoRig {
        let eye = |pan_rad, i: usize| Attitude {
            pan_rad,
            tilt_rad: tilts[i],
            torsion_rad: torsions[i],
        };
        let lens = match kind {
            0 => Lens::Pinhole,
            1 => Lens::BrownConrady([-0.25, 0.08, 0.001, -0.002, 0.0, 0.0, 0.0, 0.0]),
            _ => Lens::Fisheye([0.01, -0.004, 0.0, 0.0]),
        };
        let attitude = Binocular { left: eye(pan + vergence / 2.0, 0), right: eye(pan - vergence / 2.0, 1) };
        StereoRig::aimed(both(camera(focal_px)), baseline_m, attitude)
            .and_then(|rig| rig.slipped(slip))
            .and_then(|rig| rig.with_lenses(both(lens)))
            .and_then(|rig| rig.tilted(tilt))
            .expect("such a head sees depth")
    }
}

/// The direction in which the right pixel of a point moves as the point goes along the left line of
/// sight; along the row for eyes that only pan.
fn epipolar_direction(rig: &StereoRig, point: Position<Head>) -> Option<(f64, f64)> {
    if rig.only_pans() {
        return Some((1.0, 0.0));
    }
    let from = rig.eyes().left.centre.to_array();
    let to = point.to_array();
    let farther = std::array::from_fn(|i| from[i] + (1.0 + 1e-4) * (to[i] - from[i]));
    let (near, far) = (
        rig.project(point)?.right,
        rig.project(Position::from_array(farther))?.right,
    );
    let (du, dv) = (far.0 - near.0, far.1 - near.1);
    let length = du.hypot(dv);
    Some((du / length, dv / length))
}

proptest! {
    /// The rays of a point's two pixels meet in the point.
    #[test]
    fn projecting_and_triangulating_is_the_identity(
        rig in heads(),
        x in -0.3f64..0.3,
        y in -0.3f64..0.3,
        z in 0.6f64..4.0,
    ) {
        let point = Position::<Head>::new(x * z, y * z, z);
        let pixels = rig.project(point).expect("it is in front");
        let eyes = rig.eyes();
        let rays = Binocular { left: eyes.left.ray(pixels.left), right: eyes.right.ray(pixels.right) };
        let (Some(left), Some(right)) = (rays.left, rays.right) else {
            // The far corner of a picture, where the polynomial has turned back.
            return Ok(());
        };
        let found = midpoint(Binocular { left, right }).expect("lines to one point meet");
        // A lens is undone to 1e-12; a point far over the baseline magnifies that by up to 80.
        for (sent, got) in point.to_array().iter().zip(found.position.to_array()) {
            prop_assert!((sent - got).abs() < 1e-9 * z, "{sent} {got}");
        }
        prop_assert!(found.gap_m < 1e-9 * z);
        prop_assert!(rig.misalignment_px(pixels).is_none_or(|px| px.abs() < 1e-6));
    }

    /// Depth moves with the right pixel as the rig says, whatever its attitude.
    #[test]
    fn the_slope_of_depth_is_that_of_a_small_step(rig in heads(), x in -0.2f64..0.2, z in 0.8f64..3.0) {
        let point = Position::<Head>::new(x, 0.02, z);
        let pixels = rig.project(point).expect("it is in front");
        let eyes = rig.eyes();
        let Some((across, down)) = epipolar_direction(&rig, point) else { return Ok(()) };
        let depth = |step: f64| {
            let at = (pixels.right.0 + step * across, pixels.right.1 + step * down);
            let right = eyes.right.ray(at)?;
            Some(midpoint(Binocular { left: eyes.left.ray(pixels.left)?, right })?.position.z_m)
        };
        let (Some(more), Some(less)) = (depth(0.01), depth(-0.01)) else { return Ok(()) };
        let slope = ((more - less) / 0.02).abs();
        // The third order of a hundredth of a pixel, and what the line bends behind a lens. Eyes that only
        // pan count along the row.
        let allowed = if rig.only_pans() { 0.02 } else { 1e-3 };
        prop_assert!((rig.depth_per_px(point) / slope - 1.0).abs() < allowed);
    }

    /// What is uncertain of a pose shows as the shift of the point's pixel that it causes.
    #[test]
    fn a_pose_sigma_is_the_shift_of_a_drift(
        rig in heads(),
        which in 0usize..5,
        x in -0.2f64..0.2,
        z in 0.8f64..3.0,
    ) {
        let pinhole = rig.with_lenses(both(Lens::Pinhole)).expect("a pinhole is a lens");
        let point = Position::<Head>::new(x, -0.1, z);
        let mut small = [0.0; 5];
        small[which] = 1e-6;
        let small = RigDrift::from_array(small);
        let drifted = pinhole.drifted(&small).expect("a small drift");
        let (Some(before), Some(after)) = (pinhole.project(point), drifted.project(point)) else {
            return Ok(());
        };
        let Some((across, down)) = epipolar_direction(&pinhole, point) else { return Ok(()) };
        let (du, dv) = (after.right.0 - before.right.0, after.right.1 - before.right.1);
        let shift = (across * du + down * dv).abs();
        let sigma = pinhole.with_sigma(small).expect("positive").pose_sigma_px(point);
        // The second order of 1e-6, the bend of the line over a ten thousandth of the depth, and the
        // rounding of pixels near 1000.
        prop_assert!((shift - sigma).abs() < 1e-7 + 1e-3 * sigma, "{shift} {sigma}");
    }

    /// As vergence tends to zero, the general form tends to `f b / d`.
    #[test]
    fn without_vergence_depth_is_parallax(vergence in 0.0f64..1e-6, u in -0.4f64..0.4, z in 0.5f64..5.0) {
        let baseline = 0.27;
        let right = u - baseline / z;
        let half = vergence / 2.0;
        let found = general_form(
            baseline,
            Binocular { left: half + u.atan(), right: -half + right.atan() },
        );
        let (depth, _) = found.expect("the lines meet");
        // The vergence adds itself to the parallax: at most z / b of it, relatively.
        prop_assert!((depth / z - 1.0).abs() < 1e-12 + 2.0 * vergence * z / baseline * (1.0 + u * u));
    }

    /// A rig is its pose, but for the frame of the head.
    #[test]
    fn a_pose_is_a_rig(rig in heads()) {
        let pose = rig.relative_pose();
        let back = StereoRig::from_pose(rig.intrinsics(), &pose).expect("it was a rig");
        let again = back.relative_pose();
        let apart = again.rotation.after(&pose.rotation.inverse()).to_vector();
        for i in 0..3 {
            prop_assert!(apart[i].abs() < 1e-13);
            prop_assert!((again.translation_m[i] - pose.translation_m[i]).abs() < 1e-14);
        }
    }

    /// Rectified places see what the eyes saw, in one row, at the depth of a parallel rig.
    #[test]
    fn rectification_puts_points_into_rows(rig in heads(), x in -0.2f64..0.2, y in -0.2f64..0.2, z in 1.0f64..3.0) {
        let size = Size { width: 64, height: 48 };
        let plan = Rectification::plan(&rig, size).expect("such a head can be rectified");
        let parallel = plan.rig();
        let point = Position::<Head>::new(x, y, z);
        let seen = parallel.project(point).expect("it is in front");
        prop_assert!((seen.left.1 - seen.right.1).abs() < 1e-9);
        prop_assert!((parallel.baseline_m() / rig.baseline_m() - 1.0).abs() < 1e-3);
    }
}

/// The maps lead from each rectified pixel to where the eye saw the same line of sight.
#[test]
fn maps_are_the_lines_of_sight() {
    let attitude = Binocular {
        left: Attitude {
            pan_rad: 0.05,
            tilt_rad: 0.015,
            torsion_rad: 0.03,
        },
        right: Attitude {
            pan_rad: -0.04,
            tilt_rad: -0.015,
            torsion_rad: -0.01,
        },
    };
    let lens = Lens::BrownConrady([-0.2, 0.05, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    let eye = CameraIntrinsics {
        focal_px: (90.0, 90.0),
        principal_point_px: (40.0, 30.0),
    };
    let rig = StereoRig::aimed(both(eye), 0.1, attitude)
        .and_then(|rig| rig.with_lenses(both(lens)))
        .unwrap();
    let plan = Rectification::plan(
        &rig,
        Size {
            width: 81,
            height: 61,
        },
    )
    .unwrap();
    let maps = plan.maps();
    let (parallel, sources) = (plan.rig().eyes(), rig.eyes());
    for (x, y) in [(10, 10), (40, 30), (70, 50)] {
        let flat = parallel
            .right
            .ray((f64::from(x), f64::from(y)))
            .unwrap()
            .direction;
        let (u, v) = maps.right[[y as usize, x as usize]];
        let seen = sources
            .right
            .ray((f64::from(u), f64::from(v)))
            .unwrap()
            .direction;
        // Both heads lie along one baseline, and so in one frame; places of f32 are rounded by 4e-6 px.
        for i in 0..3 {
            let apart = flat[i] / flat[2] - seen[i] / seen[2];
            assert!(apart.abs() < 1e-5, "{flat:?} {seen:?}");
        }
    }
}

/// Where the eyes only pan, rays and the general form agree pixel by pixel.
#[test]
fn a_lens_of_zeros_is_a_pinhole() {
    let rig = StereoRig::vergent(
        both(camera(400.0)),
        0.2,
        Binocular {
            left: 0.1,
            right: -0.1,
        },
    )
    .unwrap();
    let same = rig.with_lenses(both(Lens::BrownConrady([0.0; 8]))).unwrap();
    assert!(rig.only_pans() && !same.only_pans());
    // Along the row of the principal points the lines of sight meet whatever dx is.
    let size = (480, 640);
    let field = DisparityField::new(
        Array2::from_elem(size, -3.0),
        Array2::zeros(size),
        Array2::ones(size),
        Array2::from_elem(size, Validity::Valid),
    )
    .unwrap();
    let (fast, slow) = (triangulate(&field, &rig), triangulate(&field, &same));
    for x in (0..640).step_by(40) {
        let (a, b) = (fast.at(x, 238).unwrap(), slow.at(x, 238).unwrap());
        // Two roundings of f32.
        assert!((a / b - 1.0).abs() < 3e-7, "{a} {b}");
    }
}

/// What cannot be is refused with the number.
#[test]
fn what_is_no_rig_is_refused_with_the_number() {
    let eye = camera(500.0);
    let refused = |rig: Result<StereoRig, BadRig>, words: &str| {
        let text = rig.unwrap_err().to_string();
        assert!(text.contains(words), "{text}");
    };
    let parting = Binocular {
        left: -0.01,
        right: 0.01,
    };
    refused(
        StereoRig::vergent(both(eye), 0.1, parting),
        "part by 1.146 degrees",
    );
    refused(StereoRig::parallel(both(eye), 0.0), "baseline of 0 m");
    refused(
        StereoRig::parallel(both(eye), f64::NAN),
        "baseline of NaN m",
    );
    refused(StereoRig::parallel(both(camera(-5.0)), 0.1), "(-5, ");
    let measured = Binocular {
        left: Attitude::panned(-0.05),
        right: Attitude::panned(0.05),
    };
    refused(
        StereoRig::aimed(both(eye), 0.1, measured),
        "part by 5.730 degrees",
    );
    let slightly = Binocular {
        left: Attitude::panned(-0.01),
        right: Attitude::panned(0.01),
    };
    assert!(StereoRig::aimed(both(eye), 0.1, slightly).is_ok());
    let rig = StereoRig::parallel(both(eye), 0.1).unwrap();
    refused(
        rig.with_lenses(both(Lens::Fisheye([0.0, f64::INFINITY, 0.0, 0.0]))),
        "coefficient inf",
    );
    refused(rig.slipped((0.0, -1.5)), "-1.5 baselines");
    refused(
        rig.with_sigma(RigDrift {
            yaw_rad: -0.1,
            ..RigDrift::default()
        }),
        "deviation of -0.1",
    );
    let pose = |translation_m| RelativePose {
        rotation: Rotation::IDENTITY,
        translation_m,
    };
    refused(
        StereoRig::from_pose(both(eye), &pose([0.1, 0.0, 0.0])),
        "0.1 m to the left",
    );
    refused(
        StereoRig::from_pose(both(eye), &pose([0.0; 3])),
        "baseline of 0 m",
    );
    refused(
        StereoRig::from_pose(both(eye), &pose([-1e-9, 0.0, -1.0])),
        "right angle",
    );
}
