//! What a rig projects, it triangulates back, by every one of its ways.
use disparity_pyramid::{DisparityField, Validity};
use egocentric_depth::{
    CameraIntrinsics, Head, Position, StereoRig, equation_5, general_form, midpoint, point_cloud,
    triangulate, triangulate_guesses, triangulate_rays,
};
use ndarray::Array2;
use proptest::prelude::*;
use v1_gabor::Binocular;

fn eye(focal_px: f64, cx: f64) -> CameraIntrinsics {
    CameraIntrinsics {
        focal_px: (focal_px, 1.01 * focal_px),
        principal_point_px: (cx, 380.0),
    }
}

prop_compose! {
    /// Parallel and verging rigs, with equal and with different lenses.
    fn rigs()(
        focal in 400.0f64..1200.0,
        other_lens in prop_oneof![Just(1.0), 0.9f64..1.1],
        doffs in -20.0f64..20.0,
        baseline in 0.05f64..0.4,
        version in prop_oneof![Just(0.0), -0.3f64..0.3],
        vergence in prop_oneof![Just(0.0), 0.0f64..0.4],
        tilt in -0.8f64..0.8,
    ) -> StereoRig {
        let eyes = Binocular { left: eye(focal, 510.0), right: eye(focal * other_lens, 510.0 + doffs) };
        let pans = Binocular { left: version + vergence / 2.0, right: version - vergence / 2.0 };
        let level = StereoRig::vergent(eyes, baseline, pans).expect("the rig sees depth");
        level.tilted(tilt).expect("the tilt is below a right angle")
    }
}

prop_compose! {
    fn points()(
        x in -0.5f64..0.5,
        y in -0.5f64..0.5,
        z in 0.4f64..8.0,
    ) -> Position<Head> {
        Position::new(x * z, y * z, z)
    }
}

/// A field of one row that matches the rounded left pixel of `pixels` with the right one.
fn field_of_one(width: usize, dx: f32, dy: f32, validity: Validity) -> DisparityField {
    DisparityField::new(
        Array2::from_elem((1, width), dx),
        Array2::from_elem((1, width), dy),
        Array2::from_elem((1, width), 1.0),
        Array2::from_elem((1, width), validity),
    )
    .expect("the planes are a field")
}

proptest! {
    /// The midpoint of the two lines of sight of a point is the point, and they meet in it.
    #[test]
    fn rays_meet_in_the_point(rig in rigs(), point in points()) {
        let Some(pixels) = rig.project(point) else { return Ok(()) };
        let eyes = rig.eyes();
        let found = midpoint(Binocular {
            left: eyes.left.ray(pixels.left).expect("a pinhole sees it"),
            right: eyes.right.ray(pixels.right).expect("a pinhole sees it"),
        }).expect("the lines of sight of a point meet");
        // The angle between the lines is at least 0.05 / 8 / (1 + 0.5^2) and enters squared.
        for (sent, got) in point.to_array().iter().zip(found.position.to_array()) {
            prop_assert!((sent - got).abs() < 1e-9 * point.z_m);
        }
        prop_assert!(found.gap_m < 1e-12);
    }

    /// The left pixel and the depth give the point back.
    #[test]
    fn a_pixel_and_its_depth_are_the_point(rig in rigs(), point in points()) {
        let Some(pixels) = rig.project(point) else { return Ok(()) };
        let back = rig.back_project(pixels.left, point.z_m).expect("it is in front");
        for (sent, got) in point.to_array().iter().zip(back.to_array()) {
            prop_assert!((sent - got).abs() < 1e-11 * point.z_m);
        }
    }

    /// The plane-wide triangulation finds the depth of a point that a whole left pixel shows, and
    /// so does the general form by angles.
    #[test]
    fn triangulation_undoes_projection(rig in rigs(), x in 0usize..64, depth in 0.4f64..8.0) {
        let column = 16 * x;
        let pixel = (column as f64, 0.0);
        let Some(point) = rig.back_project(pixel, depth) else { return Ok(()) };
        let Some(seen) = rig.project(point) else { return Ok(()) };
        let dx = seen.right.0 - seen.left.0;
        let dy = seen.right.1 - seen.left.1;
        prop_assume!(dx.abs() < 5e3);
        let field = field_of_one(1024, dx as f32, dy as f32, Validity::Valid);

        // A step of f32 at dx and at the depth, carried through the derivative.
        let step_px = f64::from(f32::EPSILON) * dx.abs();
        let allowed = rig.depth_sigma_m(point, step_px) + 2.0 * f64::from(f32::EPSILON) * depth;
        let got = f64::from(triangulate(&field, &rig).at(column, 0).expect("it is known"));
        prop_assert!((got - depth).abs() <= allowed, "{} for {}", got, depth);
        let dense = f64::from(triangulate_guesses(&field, &rig).at(column, 0).unwrap());
        prop_assert_eq!(got, dense);

        // Rays take the rounded dy too, which moves the midpoint by far less than dx does.
        let rays = triangulate_rays(&field, &rig.eyes());
        let by_rays = f64::from(rays.depth.at(column, 0).expect("it is known"));
        prop_assert!((by_rays - depth).abs() <= 3.0 * allowed + 1e-6, "{} for {}", by_rays, depth);

        let azimuth = |eye: CameraIntrinsics, pan: f64, u: f64| {
            pan + ((u - eye.principal_point_px.0) / eye.focal_px.0).atan()
        };
        let (eyes, pans) = (rig.intrinsics(), rig.pan_rad());
        let (z, lateral) = general_form(rig.baseline_m(), Binocular {
            left: azimuth(eyes.left, pans.left, seen.left.0),
            right: azimuth(eyes.right, pans.right, seen.right.0),
        }).expect("the lines of sight meet");
        prop_assert!((z / depth - 1.0).abs() < 1e-9);
        prop_assert!((lateral - point.x_m).abs() < 1e-9 * depth);
    }

    /// On a parallel rig a nearer point on one line of sight has the smaller dx.
    #[test]
    fn nearer_is_smaller_dx(
        focal in 400.0f64..1200.0,
        doffs in -20.0f64..20.0,
        u in 0.0f64..1024.0,
        depth in 0.4f64..8.0,
        closer in 0.1f64..0.99,
    ) {
        let eyes = Binocular { left: eye(focal, 510.0), right: eye(focal, 510.0 + doffs) };
        let rig = StereoRig::parallel(eyes, 0.27).unwrap();
        let dx = |depth| {
            let seen = rig.project(rig.back_project((u, 100.0), depth).unwrap()).unwrap();
            seen.right.0 - seen.left.0
        };
        prop_assert!(dx(depth * closer) < dx(depth));
    }

    /// Equation 5 is the general form on the midline of a symmetric head.
    #[test]
    fn equation_5_is_the_general_form_on_the_midline(
        fixation in 0.2f64..10.0,
        baseline in 0.03f64..0.5,
        share in 0.05f64..5.0,
    ) {
        let point_vergence = 2.0 * (baseline / (2.0 * fixation)).atan() * share;
        prop_assume!(point_vergence < 3.0);
        let delta = 2.0 * (baseline / (2.0 * fixation)).atan() - point_vergence;
        let half = point_vergence / 2.0;
        let (depth, _) = general_form(baseline, Binocular { left: half, right: -half }).unwrap();
        let relative = equation_5(fixation, baseline, delta).unwrap();
        prop_assert!(((fixation + relative) - depth).abs() < 1e-9 * depth.max(fixation));
    }

    /// The derivative of depth by disparity is that of a small step, and on a parallel rig
    /// `Z^2 / (b f)`.
    #[test]
    fn depth_sigma_is_the_derivative(rig in rigs(), point in points()) {
        let Some(seen) = rig.project(point) else { return Ok(()) };
        let (eyes, pans) = (rig.intrinsics(), rig.pan_rad());
        let depth = |du: f64| {
            let azimuth = |eye: CameraIntrinsics, pan: f64, u: f64| {
                pan + ((u - eye.principal_point_px.0) / eye.focal_px.0).atan()
            };
            general_form(rig.baseline_m(), Binocular {
                left: azimuth(eyes.left, pans.left, seen.left.0),
                right: azimuth(eyes.right, pans.right, seen.right.0 + du),
            }).map(|(z, _)| z)
        };
        let (Some(more), Some(less)) = (depth(1e-3), depth(-1e-3)) else { return Ok(()) };
        let slope = (more - less) / 2e-3;
        let sigma = rig.depth_sigma_m(point, 1.0);
        // The central difference errs by the third derivative: (step / disparity)^2 relatively.
        prop_assert!((sigma / slope - 1.0).abs() < 1e-5, "{} against {}", sigma, slope);
        if pans.left == 0.0 && pans.right == 0.0 {
            let closed = point.z_m.powi(2) / (rig.baseline_m() * eyes.right.focal_px.0);
            prop_assert!((sigma / closed - 1.0).abs() < 1e-12);
        }
    }

    /// Tilting and levelling again changes nothing, and heights only trade with depths.
    #[test]
    fn tilt_goes_round(rig in rigs(), point in points()) {
        let level = rig.to_observer(point);
        let back = rig.to_head(level);
        for (sent, got) in point.to_array().iter().zip(back.to_array()) {
            prop_assert!((sent - got).abs() < 1e-14 * point.range_m());
        }
        prop_assert_eq!(level.x_m, point.x_m);
        prop_assert!((level.range_m() / point.range_m() - 1.0).abs() < 1e-14);
    }
}

/// A head that looks up sees what is straight ahead of it above the horizon, at negative y.
#[test]
fn looking_up_raises_what_is_ahead() {
    let eyes = Binocular {
        left: eye(800.0, 510.0),
        right: eye(800.0, 510.0),
    };
    let rig = StereoRig::parallel(eyes, 0.27)
        .unwrap()
        .tilted(0.3)
        .unwrap();
    let ahead = rig.to_observer(Position::new(0.0, 0.0, 2.0));
    assert!((ahead.y_m + 2.0 * 0.3f64.sin()).abs() < 1e-15);
    assert!((ahead.distance_m() - 2.0 * 0.3f64.cos()).abs() < 1e-15);
}

/// Only valid pixels get a depth, and a shift that would lie beyond infinity gets none at all.
#[test]
fn unknown_stays_unknown() {
    let eyes = Binocular {
        left: eye(800.0, 32.0),
        right: eye(800.0, 32.0),
    };
    let parallel = StereoRig::parallel(eyes, 0.27).unwrap();
    let pans = Binocular {
        left: 0.1,
        right: -0.1,
    };
    let vergent = StereoRig::vergent(eyes, 0.27, pans).unwrap();
    for rig in [parallel, vergent] {
        let occluded = field_of_one(64, -20.0, 0.0, Validity::Occluded);
        assert_eq!(triangulate(&occluded, &rig).density(), 0.0);
        assert_eq!(triangulate_guesses(&occluded, &rig).density(), 1.0);
        assert_eq!(
            triangulate_rays(&occluded, &rig.eyes()).depth.density(),
            0.0
        );
        let beyond = field_of_one(64, 200.0, 0.0, Validity::Valid);
        assert_eq!(triangulate_guesses(&beyond, &rig).density(), 0.0);
        assert_eq!(point_cloud(&triangulate(&beyond, &rig), &rig).count(), 0);
    }
}

/// The points of the cloud are those of the pixels, one by one.
#[test]
fn the_point_cloud_is_the_back_projection() {
    let eyes = Binocular {
        left: eye(60.0, 32.0),
        right: eye(60.0, 32.0),
    };
    let pans = Binocular {
        left: 0.2,
        right: 0.0,
    };
    let rig = StereoRig::vergent(eyes, 0.1, pans)
        .unwrap()
        .tilted(-0.4)
        .unwrap();
    let depth = triangulate(&field_of_one(64, 3.0, 0.0, Validity::Valid), &rig);
    let mut points = 0;
    for point in point_cloud(&depth, &rig) {
        let (x, y) = point.pixel;
        let depth_m = f64::from(depth.at(x, y).unwrap());
        let in_head = rig.back_project((x as f64, y as f64), depth_m).unwrap();
        assert_eq!(point.position, rig.to_observer(in_head));
        points += 1;
    }
    assert_eq!(points, 64);
}
