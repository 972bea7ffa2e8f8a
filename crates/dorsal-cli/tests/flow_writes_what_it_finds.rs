//! `dorsal flow` leaves files that read back, with motion in the sign of where a point went.
mod command;

use std::fs;

use command::{D, HEIGHT, Pair, Said, WIDTH, dorsal};
use dorsal::v1_gabor::LumaImage;
use ndarray::Array2;
use serde_json::Value;
use stereo_formats::{flo, pfm, picture, validity_png};

/// Runs `dorsal flow` from the left picture to the right one, into the folder `out`.
fn flow(pair: &Pair, further: &[&str]) -> Said {
    let [prev, next, out] = ["left.png", "right.png", "out"].map(|name| pair.path(name));
    let fixed = [
        "flow".as_ref(),
        prev.as_os_str(),
        next.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ];
    dorsal(fixed.into_iter().chain(further.iter().map(AsRef::as_ref)))
}

#[test]
fn motion_to_the_left_is_negative_in_every_file() {
    let pair = Pair::new();
    let said = flow(&pair, &["--dense"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.out.contains("motion    u -6.0"), "{}", said.out);

    // The later picture shows everything D px further left.
    let vectors = flo::read(pair.path("out/flow.flo")).expect("a .flo file");
    let (u, v) = vectors.at(80, 60).expect("a dense flow");
    assert!((u + D).abs() < 0.1 && v.abs() < 0.1, "({u}, {v})");
    assert!(vectors.dx().iter().all(|u| u.is_finite()));

    let coloured = picture::read(pair.path("out/flow.png")).expect("a picture");
    assert_eq!(coloured.size().width, WIDTH);
    assert!(coloured.size().height > HEIGHT, "a wheel stands below");
    let confidence = pfm::read(pair.path("out/confidence.pfm")).expect("a PFM");
    assert_eq!(confidence.dim(), (HEIGHT, WIDTH));
    assert!(picture::read(pair.path("out/confidence.png")).is_ok());
    let validity = validity_png::read(pair.path("out/validity.png")).expect("validities");
    assert!(validity[[60, 80]].is_valid());

    let text = fs::read_to_string(pair.path("out/flow.json")).expect("a file");
    let record: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!(record["schema"], "dorsal-flow/1");
    assert_eq!(record["matching"]["vertical_prior"], 0.0);
    let median = record["motion_px"]["median_u"].as_f64().expect("a number");
    assert!((median + f64::from(D)).abs() < 0.1);
    let listed = record["files"].as_array().expect("files").len();
    let written = fs::read_dir(pair.path("out")).expect("a folder").count();
    assert_eq!(listed, written);
}

#[test]
fn what_is_not_known_is_unknown_unless_dense() {
    let pair = Pair::new();
    // Half of the later picture is blank: nothing there answers.
    let later = picture::read(pair.path("right.png")).expect("a picture");
    let blank = Array2::from_shape_fn((HEIGHT, WIDTH), |(y, x)| {
        if x < WIDTH / 2 {
            0.5
        } else {
            later.luma().plane()[[y, x]]
        }
    });
    let blank = LumaImage::new(blank).expect("finite samples");
    picture::write_luma(pair.path("right.png"), &blank).expect("a PNG");
    let said = flow(&pair, &["--quiet", "--threads", "1"]);
    assert_eq!((said.code, &*said.err), (Some(0), ""));
    let vectors = flo::read(pair.path("out/flow.flo")).expect("a .flo file");
    assert_eq!(vectors.at(20, 60), None);
    assert!(vectors.at(130, 60).is_some());
}

#[test]
fn frames_that_do_not_fit_are_named() {
    let pair = Pair::new();
    let small = LumaImage::new(Array2::from_elem((10, 20), 0.5)).expect("finite samples");
    picture::write_luma(pair.path("right.png"), &small).expect("a PNG");
    let said = flow(&pair, &[]);
    assert_eq!(said.code, Some(1));
    for word in ["left.png", "right.png", "160 x 120", "20 x 10", "one size"] {
        assert!(said.err.contains(word), "{word}: {}", said.err);
    }
    fs::remove_file(pair.path("right.png")).expect("removed");
    let said = flow(&pair, &[]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("right.png"), "{}", said.err);
    assert!(!pair.path("out").exists());
}
