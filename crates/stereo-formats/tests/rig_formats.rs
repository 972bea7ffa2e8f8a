//! Rigs go through every format and come back; files of the field's own making are read; what is
//! malformed is refused with its line.
#![allow(clippy::unwrap_used, reason = "what a test builds for itself is sound")]

use std::fs;
use std::path::PathBuf;

use egocentric_depth::{Attitude, CameraIntrinsics, Lens, RigDrift, StereoRig};
use proptest::prelude::*;
use stereo_formats::opencv_storage::{self, Form};
use stereo_formats::rig_toml::{self, SizedRig};
use stereo_formats::{kalibr, middlebury_calib, ros_camera_info};
use v1_gabor::{Binocular, Size};

fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../fixtures/rigs")
        .join(name)
}

/// Any lens, with as many terms as `kind` says.
fn lens(kind: u8, terms: [f64; 8]) -> Lens {
    let [k1, k2, p1, p2, k3, ..] = terms;
    match kind {
        0 => Lens::Pinhole,
        1 => Lens::BrownConrady([k1, k2, p1, p2, 0.0, 0.0, 0.0, 0.0]),
        2 => Lens::BrownConrady([k1, k2, p1, p2, k3, 0.0, 0.0, 0.0]),
        3 => Lens::BrownConrady(terms),
        _ => Lens::Fisheye([k1, k2, p1, p2]),
    }
}

prop_compose! {
    /// Rigs as they are measured, with lenses of the kinds below `kinds`, the same for both eyes.
    fn rigs(kinds: std::ops::Range<u8>)(
        baseline_m in 0.01f64..2.0,
        focal in prop::array::uniform4(100f64..2e3),
        point in prop::array::uniform4(-1e2f64..1e3),
        left in prop::array::uniform3(0.0f64..0.2),
        right in prop::array::uniform3(-0.2f64..0.0),
        kind in kinds,
        terms in prop::array::uniform8(-0.3f64..0.3),
        size in (1usize..5000, 1usize..5000),
    ) -> SizedRig {
        let eye = |i: usize| CameraIntrinsics {
            focal_px: (focal[i], focal[i + 1]),
            principal_point_px: (point[i], point[i + 1]),
        };
        let attitude = |[pan_rad, tilt_rad, torsion_rad]: [f64; 3]| Attitude {
            pan_rad,
            tilt_rad,
            torsion_rad,
        };
        let lens = lens(kind, terms);
        let rig = StereoRig::aimed(
            Binocular { left: eye(0), right: eye(2) },
            baseline_m,
            Binocular { left: attitude(left), right: attitude(right) },
        )
        .and_then(|rig| rig.with_lenses(Binocular { left: lens, right: lens }))
        .expect("these eyes see depth");
        SizedRig { rig, size: Some(Size { width: size.0, height: size.1 }) }
    }
}

/// The same cameras in the same pose: lengths and lenses exactly, the pose within what the turn into
/// the head's frame and back rounds.
fn same(back: &SizedRig, sent: &SizedRig) -> Result<(), TestCaseError> {
    prop_assert_eq!(back.rig.intrinsics(), sent.rig.intrinsics());
    prop_assert_eq!(back.rig.lenses(), sent.rig.lenses());
    prop_assert_eq!(back.size, sent.size);
    let (got, want) = (back.rig.relative_pose(), sent.rig.relative_pose());
    let turn = got.rotation.after(&want.rotation.inverse()).to_vector();
    for i in 0..3 {
        // A dozen products of numbers near 1; differences of entries lose the rest.
        prop_assert!(turn[i].abs() < 1e-13, "{:?}", turn);
        prop_assert!((got.translation_m[i] - want.translation_m[i]).abs() < 1e-13);
    }
    Ok(())
}

proptest! {
    #[test]
    fn through_toml(
        sent in rigs(0..5),
        slip in (-0.1f64..0.1, -0.1f64..0.1),
        sigma in prop::array::uniform5(0.0f64..0.1),
    ) {
        let rig = sent.rig.slipped(slip).unwrap().with_sigma(RigDrift::from_array(sigma)).unwrap();
        let sent = SizedRig { rig, ..sent };
        let back = rig_toml::decode_sized(&rig_toml::encode_sized(&sent).unwrap()).unwrap();
        same(&back, &sent)?;
        prop_assert_eq!(back.rig.slip(), sent.rig.slip());
        for (got, want) in back.rig.sigma().to_array().iter().zip(sigma) {
            prop_assert!((got - want).abs() < 1e-15);
        }
    }

    #[test]
    fn through_opencv(sent in rigs(0..5), xml: bool) {
        let form = if xml { Form::Xml } else { Form::Yaml };
        let text = opencv_storage::encode(&sent, form).unwrap();
        same(&opencv_storage::decode(&[&text], 1.0).unwrap(), &sent)?;
    }

    #[test]
    fn through_kalibr(sent in rigs(0..2)) {
        let back = kalibr::decode(&kalibr::encode(&sent).unwrap()).unwrap();
        same(&back, &sent)?;
    }

    /// A file comes back as it was written, and a pair of files is the rig.
    #[test]
    fn through_ros(sent in rigs(0..5)) {
        let pair = ros_camera_info::of_rig(&sent).unwrap();
        let read = pair.as_ref().try_map(|eye| {
            let back = ros_camera_info::decode(&ros_camera_info::encode(eye))?;
            assert_eq!(&back, eye);
            Ok::<_, ros_camera_info::NotCameraInfo>(back)
        });
        same(&ros_camera_info::rig(&read.unwrap()).unwrap(), &sent)?;
    }

    #[test]
    fn through_middlebury(
        baseline_m in 0.01f64..2.0,
        focal in 100f64..2e3,
        point in prop::array::uniform3(-1e2f64..1e3),
        size in (1usize..5000, 1usize..5000),
    ) {
        let eye = |cx| CameraIntrinsics {
            focal_px: (focal, focal),
            principal_point_px: (cx, point[1]),
        };
        let eyes = Binocular { left: eye(point[0]), right: eye(point[2]) };
        let rig = StereoRig::parallel(eyes, baseline_m).unwrap();
        let size = Size { width: size.0, height: size.1 };
        let back = middlebury_calib::decode(&middlebury_calib::encode(&rig, Some(size)).unwrap());
        let back = back.unwrap();
        prop_assert_eq!(back.size, size);
        prop_assert_eq!(back.rig.intrinsics(), rig.intrinsics());
        // Metres and millimetres are not always within one rounding of each other.
        prop_assert!((back.rig.baseline_m() / baseline_m - 1.0).abs() < 3e-16);
    }
}

/// One rig in the layouts of four programs, NaN spellings included: all mean the same.
#[test]
fn the_fields_own_files_are_read() {
    let read = |name: &str| fs::read(fixture(name)).unwrap();
    let ros = ros_camera_info::rig(&Binocular {
        left: ros_camera_info::read(fixture("ros_left.yaml")).unwrap(),
        right: ros_camera_info::read(fixture("ros_right.yaml")).unwrap(),
    })
    .unwrap();
    let parts = [read("opencv_intrinsics.yml"), read("opencv_extrinsics.yml")];
    // The extrinsics count squares of 25 mm.
    let opencv = opencv_storage::decode(&[&parts[0], &parts[1]], 0.025).unwrap();
    let xml = opencv_storage::decode(&[&read("opencv_stereo.xml")], 1.0).unwrap();
    let kalibr = kalibr::read(fixture("kalibr_camchain.yaml")).unwrap();
    for found in [ros, opencv, xml, kalibr] {
        let eyes = found.rig.intrinsics();
        assert_eq!(eyes.left.focal_px, (532.8, 532.9));
        assert_eq!(eyes.right.principal_point_px, (327.6, 248.9));
        assert!((found.rig.baseline_m() - 0.12).abs() < 1e-9);
        let Lens::BrownConrady([k1, k2, p1, p2, ..]) = found.rig.lenses().left else {
            panic!("{:?}", found.rig.lenses());
        };
        assert_eq!([k1, k2, p1, p2], [-0.28, 0.025, 0.0012, -0.00013]);
        // The left axis leans by 0.0089441 against the right one, and the baseline is the right x axis.
        let [_, turn, _] = found.rig.relative_pose().rotation.to_vector();
        assert!((turn + 0.0089441).abs() < 1e-6, "{turn}");
    }
    assert_eq!(
        ros.size,
        Some(Size {
            width: 640,
            height: 480
        })
    );
    assert_eq!(xml.size, ros.size);
}

/// Zeros are how most formats spell a pinhole, so a rectified rig stays one through all of them.
#[test]
fn a_rectified_rig_stays_one() {
    let eye = |cx| CameraIntrinsics {
        focal_px: (500.0, 500.0),
        principal_point_px: (cx, 240.0),
    };
    let eyes = Binocular {
        left: eye(320.0),
        right: eye(331.5),
    };
    let sent = SizedRig {
        rig: StereoRig::parallel(eyes, 0.12).unwrap(),
        size: Some(Size {
            width: 640,
            height: 480,
        }),
    };
    let opencv = opencv_storage::encode(&sent, Form::Yaml).unwrap();
    let opencv = opencv_storage::decode(&[&opencv], 1.0).unwrap();
    let ros = ros_camera_info::rig(&ros_camera_info::of_rig(&opencv).unwrap()).unwrap();
    let chain = String::from_utf8(kalibr::encode(&ros).unwrap()).unwrap();
    let spelt = chain.replace(
        "distortion_coeffs: []\n  distortion_model: none",
        "distortion_coeffs: [0.0, 0.0, 0.0, 0.0]\n  distortion_model: radtan",
    );
    assert_ne!(spelt, chain);
    let kalibr = kalibr::decode(spelt.as_bytes()).unwrap();
    let calib = middlebury_calib::encode(&kalibr.rig, kalibr.size).unwrap();
    let back = middlebury_calib::decode(&calib).unwrap();
    assert!(back.rig.is_rectified());
    assert_eq!(back.rig, sent.rig);
}

/// What a format has no form for is refused with the number, and with what has one.
#[test]
fn what_does_not_fit_is_not_written() {
    let said = |refused: &dyn std::fmt::Display, words: &[&str]| {
        let text = refused.to_string();
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    };
    let read = opencv_storage::read(&[fixture("opencv_stereo.xml")], 1.0).unwrap();
    said(
        &kalibr::encode(&read).unwrap_err(),
        &["left lens", "k3 = 0.16", "rig.toml", "rectify"],
    );
    said(
        &middlebury_calib::encode(&read.rig, read.size).unwrap_err(),
        &["parallel pinholes", "rectify"],
    );
    let lenses = Binocular {
        left: Lens::Pinhole,
        right: Lens::Fisheye([0.1, 0.0, 0.0, 0.0]),
    };
    let mixed = SizedRig {
        rig: read.rig.with_lenses(lenses).unwrap(),
        size: None,
    };
    said(
        &opencv_storage::encode(&mixed, Form::Xml).unwrap_err(),
        &["fisheye", "rig.toml"],
    );
    for refused in [
        kalibr::encode(&mixed).unwrap_err().to_string(),
        ros_camera_info::of_rig(&mixed).unwrap_err().to_string(),
    ] {
        assert!(refused.contains("--size"), "{refused}");
    }
}

/// What is wrong is said with the line on which it stands.
#[test]
fn refusals_name_the_line() {
    let said = |refused: &dyn std::fmt::Display, words: &[&str]| {
        let text = refused.to_string();
        assert!(words.iter().all(|word| text.contains(word)), "{text}");
    };
    let left = fs::read_to_string(fixture("ros_left.yaml")).unwrap();
    let ros = |from: &str, to: &str| {
        assert!(left.contains(from));
        ros_camera_info::decode(left.replacen(from, to, 1).as_bytes()).unwrap_err()
    };
    said(
        &ros("data: [532.8", "data: [532.8, 7"),
        &["line 4", "10 numbers"],
    );
    said(&ros("plumb_bob", "cylinder"), &["line 8", "cylinder"]);
    said(&ros("[0.99996", "[1.99996"), &["line 13", "no rotation"]);
    said(&ros("image_width: 640", "image_width: wide"), &["line 1"]);
    said(&ros("[532.8", "[.Nan"), &["line 4"]);
    said(&ros("rows: 3", "rows: ["), &["line"]);

    let chain = fs::read_to_string(fixture("kalibr_camchain.yaml")).unwrap();
    let kalibr = |from: &str, to: &str| {
        assert!(chain.contains(from));
        kalibr::decode(chain.replacen(from, to, 1).as_bytes()).unwrap_err()
    };
    said(
        &kalibr("[537.4, 537.0", "[537.0"),
        &["line 19", "cam1", "3 intrinsics"],
    );
    said(&kalibr("pinhole", "omni"), &["line 3", "omni"]);
    said(
        &kalibr("  - [0.0, 1.0, 0.0, 0.0]\n", ""),
        &["line 10", "4 x 4"],
    );
    said(&kalibr("[532.8", "[-532.8"), &["-532.8", "no image"]);

    let parts = fs::read_to_string(fixture("opencv_stereo.xml")).unwrap();
    let opencv = |from: &str, to: &str| {
        assert!(parts.contains(from));
        let text = parts.replacen(from, to, 1);
        opencv_storage::decode(&[text.as_bytes()], 1.0).unwrap_err()
    };
    said(
        &opencv("5.3280000000000000e+02", "five"),
        &["line 5", "M1", "five"],
    );
    said(&opencv("<M2 ", "<N2 "), &["line"]);
    said(
        &opencv("0.99996 0. -8", "0.9 0. -8"),
        &["line 33", "no rotation"],
    );
    said(&opencv("-1.2000000000000000e-01", "0"), &["baseline of 0"]);
    said(&opencv("-1.2000000000000000e-01", "0.12"), &["exchanged"]);
    said(
        &opencv_storage::decode(&[b"%YAML:1.0\n---\na: 1\n"], 1.0).unwrap_err(),
        &["no R"],
    );
    said(
        &opencv_storage::decode(&[], 0.0).unwrap_err(),
        &["unit of 0"],
    );
    let pose = fs::read_to_string(fixture("opencv_extrinsics.yml")).unwrap();
    let pose = pose.replacen("0., 1., 0.,", "0., one, 0.,", 1);
    said(
        &opencv_storage::decode(&[pose.as_bytes()], 1.0).unwrap_err(),
        &["line 3", "R has 'one'"],
    );
}

/// Of two files that one of them is named in which the wrong matrix stands.
#[test]
fn refusals_name_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let wrong = folder.path().join("wrong.yml");
    let pose = fs::read_to_string(fixture("opencv_extrinsics.yml")).unwrap();
    fs::write(&wrong, pose.replacen("rows: 3", "rows: 4", 1)).expect("it is written");
    let refused = opencv_storage::read(&[fixture("opencv_intrinsics.yml"), wrong], 1.0);
    let words = refused.unwrap_err().to_string();
    assert!(
        words.contains("wrong.yml: line 3: R has 9 numbers for 4 x 3"),
        "{words}"
    );
}
