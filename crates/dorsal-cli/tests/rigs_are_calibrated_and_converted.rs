//! A rig that has slipped is corrected by what its eyes see, and goes through every format.
mod command;

use std::fs;
use std::path::Path;

use command::{Pair, Said, dorsal as run_dorsal};
use dorsal::egocentric_depth::StereoRig;
use serde_json::Value;
use stereo_formats::{depth_png, pfm, rig_toml};

fn run(arguments: &[&str], pair: &Pair) -> Said {
    run_dorsal(arguments.iter().map(|argument| {
        argument
            .strip_prefix('@')
            .map_or_else(|| Path::new(argument).to_owned(), |name| pair.path(name))
    }))
}

/// The pair is aligned; a rig that thinks its right eye a degree up and clockwise is put right.
#[test]
fn a_slipped_rig_is_put_right() {
    let pair = Pair::far(12.0);
    let text = fs::read_to_string(pair.path("rig.toml")).expect("a rig");
    let slipped = format!("{text}[right]\ntilt_deg = 1.0\ntorsion_deg = 1.0\n");
    fs::write(pair.path("slipped.toml"), slipped).expect("written");
    let calibrate = [
        "calibrate",
        "@left.png",
        "@right.png",
        "--rig",
        "@slipped.toml",
        "--out",
        "@fixed.toml",
    ];
    let said = run(&calibrate, &pair);
    assert_eq!(said.code, Some(0), "{}", said.err);
    for word in ["pitch", "roll", "the images", "px before", "fixed.toml"] {
        assert!(said.out.contains(word), "{}", said.out);
    }
    // A wall is one plane, which is said.
    assert!(said.err.contains("degenerate"), "{}", said.err);
    let fixed = rig_toml::read(pair.path("fixed.toml")).expect("a rig");
    let right = fixed.attitude().right;
    // Waves of 160 pixels, seen to some hundredths of a pixel of a focal length of 120.
    assert!(right.tilt_rad.to_degrees().abs() < 0.1, "{right:?}");
    assert!(right.torsion_rad.to_degrees().abs() < 0.1, "{right:?}");
    assert!(fixed.sigma().roll_rad > 0.0);

    let json = run(&[&calibrate[..], &["--json", "--quiet"]].concat(), &pair);
    let json: Value = serde_json::from_str(&json.out).expect("JSON");
    assert!((json["pitch"]["value"].as_f64().expect("a number") + 1.0).abs() < 0.1);
    assert_eq!(json["pitch"]["told"], true);
    assert!(json["yaw"]["told"].is_boolean());
}

/// A look prints the drift, and on demand takes depth without it.
#[test]
fn a_look_tells_and_mends_the_drift() {
    let pair = Pair::far(12.0);
    let text = fs::read_to_string(pair.path("rig.toml")).expect("a rig");
    fs::write(
        pair.path("slipped.toml"),
        format!("{text}[right]\ntorsion_deg = 1.0\n"),
    )
    .expect("written");
    let said = pair.look(&["--rig", "@slipped.toml"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.out.contains("drift     pitch"), "{}", said.out);
    assert!(said.out.contains("--recalibrate takes"), "{}", said.out);
    // Where nothing has slipped there is nothing to offer.
    let said = pair.look(&["--rig", "@rig.toml"]);
    assert!(said.out.contains("drift     pitch"), "{}", said.out);
    assert!(!said.out.contains("--recalibrate"), "{}", said.out);
    let said = pair.look(&["--rig", "@slipped.toml", "--recalibrate"]);
    assert!(said.out.contains("(corrected)"), "{}", said.out);
    let look: Value =
        serde_json::from_slice(&fs::read(pair.path("out/look.json")).expect("a file"))
            .expect("JSON");
    assert_eq!(look["recalibrated"], true);
    assert!((look["drift"]["roll"]["value"].as_f64().expect("a number") + 1.0).abs() < 0.1);
    let fixed = rig_toml::read(pair.path("out/rig.fixed.toml")).expect("a rig");
    assert!(fixed.attitude().right.torsion_rad.to_degrees().abs() < 0.1);
    // Whole millimetres of the same metres.
    let metres = pfm::read(pair.path("out/depth.pfm")).expect("a PFM");
    let millimetres = depth_png::read(pair.path("out/depth_mm.png")).expect("a PNG");
    let mut known = 0;
    for ((y, x), &metres) in metres.indexed_iter() {
        if let Some(rounded) = millimetres.at(x, y) {
            assert!((rounded - metres).abs() <= 0.000_501);
            known += 1;
        }
    }
    assert!(known > 1000);
    let dense = pair.look(&[
        "--rig",
        "@rig.toml",
        "--recalibrate",
        "--estimator",
        "dense",
    ]);
    assert_eq!(dense.code, Some(2), "{}", dense.err);
    let dense = pair.look(&["--rig", "@rig.toml", "--estimator", "dense"]);
    assert!(dense.out.contains("drift     unknown"), "{}", dense.out);
}

/// Without texture there is nothing to calibrate by: the reason, exit code 1, and no file.
#[test]
fn a_blank_wall_is_reported() {
    let pair = Pair::new();
    let grey = dorsal::v1_gabor::LumaImage::new(ndarray::Array2::from_elem((96, 128), 0.5));
    stereo_formats::picture::write_luma(pair.path("grey.png"), &grey.expect("finite"))
        .expect("a PNG");
    let said = run(
        &[
            "calibrate",
            "@grey.png",
            "@grey.png",
            "--rig",
            "@rig.toml",
            "--out",
            "@none.toml",
        ],
        &pair,
    );
    assert_eq!(said.code, Some(1));
    assert!(
        said.err.contains("degenerate") && said.err.contains("0 valid"),
        "{}",
        said.err
    );
    assert!(!pair.path("none.toml").exists());
}

/// A file may leave out how large the pictures are and how long its unit is: what that hides is said, with
/// the option that gives it, and no depth is told of that the lens cannot show.
#[test]
fn what_a_file_leaves_out_is_asked_for() {
    let pair = Pair::new();
    let fixture = |name: &str| {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/rigs/");
        format!("{folder}{name}")
    };
    let parts = [
        fixture("opencv_intrinsics.yml"),
        fixture("opencv_extrinsics.yml"),
    ];
    let check = |options: &[&str]| {
        let files = ["rig", "check", &parts[0], &parts[1]];
        let said = run(&[&files, options, &["--json"]].concat(), &pair);
        assert_eq!(said.code, Some(0), "{}", said.err);
        let json: Value = serde_json::from_str(&said.out).expect("JSON");
        (json["errors"].clone(), said.err)
    };
    // Squares of 25 mm taken for metres: a head of 4.8 m, whose eyes squint at 0.5 m beyond their lenses.
    let (errors, said) = check(&[]);
    assert!(
        said.contains("--unit-m") && said.contains("--size"),
        "{said}"
    );
    assert!(errors[0]["per_px_m"].is_null(), "{errors}");
    let (errors, said) = check(&["--unit-m", "0.025", "--size", "640x480"]);
    assert!(said.is_empty(), "{said}");
    let per_px_m = errors[1]["per_px_m"].as_f64().expect("a number");
    // Z^2 / (b f), with focal lengths of 533 and 537 px.
    assert!((per_px_m * 0.12 * 535.0 - 1.0).abs() < 0.01, "{per_px_m}");

    // A rig of other pictures gives wrong metres, so it gives none.
    let text = fs::read_to_string(pair.path("rig.toml")).expect("a rig");
    let other = format!("size_px = [64, 48]\n{text}");
    fs::write(pair.path("other.toml"), other).expect("written");
    let said = pair.look(&["--rig", "@other.toml"]);
    assert_eq!(said.code, Some(1), "{}", said.out);
    assert!(said.err.contains("64 x 48"), "{}", said.err);

    // A tilt has no place outside of rig.toml, which is said.
    let convert = [
        "rig",
        "convert",
        "@tilted.toml",
        "--to",
        "opencv-xml",
        "--out",
        "@tilted.xml",
    ];
    fs::write(
        pair.path("tilted.toml"),
        format!("tilt_deg = -20.0\n{text}"),
    )
    .expect("written");
    let said = run(&convert, &pair);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.err.contains("the tilt of the head"), "{}", said.err);
}

/// Through every format and back; what a rig sees is told.
#[test]
fn rigs_are_converted_and_checked() {
    let pair = Pair::new();
    let fixture = |name: &str| {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../fixtures/rigs/");
        format!("{folder}{name}")
    };
    let (left, right) = (fixture("ros_left.yaml"), fixture("ros_right.yaml"));
    let said = run(
        &["rig", "convert", &left, &right, "--out", "@ros.toml"],
        &pair,
    );
    assert_eq!(said.code, Some(0), "{}", said.err);
    let read = |name: &str| rig_toml::read(pair.path(name)).expect("a rig");
    let same = |a: &StereoRig, b: &StereoRig| {
        assert_eq!(a.intrinsics(), b.intrinsics());
        assert!((a.baseline_m() - b.baseline_m()).abs() < 1e-12);
    };
    let ros = read("ros.toml");
    for (format, file) in [
        ("opencv-yaml", "a.yml"),
        ("opencv-xml", "a.xml"),
        ("ros", "folder"),
    ] {
        let out = format!("@{file}");
        let said = run(
            &["rig", "convert", "@ros.toml", "--to", format, "--out", &out],
            &pair,
        );
        assert_eq!(said.code, Some(0), "{}", said.err);
        // The files of both eyes, or the folder they stand in.
        let backs: &[&[&str]] = match format {
            "ros" => &[&["@folder/left.yaml", "@folder/right.yaml"], &["@folder"]],
            _ => &[&[&out]],
        };
        for back in backs {
            let arguments = [&["rig", "convert"], *back, &["--out", "@back.toml"]].concat();
            let said = run(&arguments, &pair);
            assert_eq!(said.code, Some(0), "{}", said.err);
            same(&read("back.toml"), &ros);
        }
    }
    // One eye is no rig, and k3 has no place in a camchain: said, with what to do.
    let one = run(&["rig", "check", &left], &pair);
    assert!(
        one.code == Some(1) && one.err.contains("needs both"),
        "{}",
        one.err
    );
    let kalibr = run(
        &[
            "rig",
            "convert",
            "@ros.toml",
            "--to",
            "kalibr",
            "--out",
            "@k.yaml",
        ],
        &pair,
    );
    assert!(
        kalibr.code == Some(1)
            && kalibr.err.contains("k3 = 0.16")
            && kalibr.err.contains("rig rectify"),
        "{}",
        kalibr.err
    );

    let check = run(&["rig", "check", "@rig.toml"], &pair);
    for word in ["baseline  0.1000 m", "nearest m", "mm a pixel", "any"] {
        assert!(check.out.contains(word), "{}", check.out);
    }
    let json = run(
        &["rig", "check", "@rig.toml", "--json", "--scales", "5"],
        &pair,
    );
    let json: Value = serde_json::from_str(&json.out).expect("JSON");
    // Z^2 / (b f) at 1 m.
    let per_px = json["errors"][1]["per_px_m"].as_f64().expect("a number");
    assert!((per_px - 1.0 / 12.0).abs() < 1e-12);
    let nearest = json["reaches"][0]["nearest_m"].as_f64().expect("a number");
    assert!((nearest - 12.0 / 24.0).abs() < 1e-9, "{nearest}");

    // The same eyes before the pictures of another pair.
    let text = fs::read_to_string(pair.path("ros.toml")).expect("a rig");
    let unsized_rig = text.replace("size_px = [640, 480]\n", "");
    assert_ne!(unsized_rig, text);
    fs::write(pair.path("unsized.toml"), unsized_rig).expect("written");
    let rectify = [
        "rig",
        "rectify",
        "@left.png",
        "@right.png",
        "--rig",
        "@unsized.toml",
        "--out",
        "@flat",
    ];
    let said = run(&rectify, &pair);
    assert_eq!(said.code, Some(0), "{}", said.err);
    for file in ["left.png", "right.png", "map_left_x.npy", "map_right_y.npy"] {
        assert!(pair.path("flat").join(file).is_file());
    }
    assert!(read("flat/rig.toml").only_pans());
}
