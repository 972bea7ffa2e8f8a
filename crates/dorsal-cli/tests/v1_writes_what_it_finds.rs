//! `dorsal v1` leaves pictures and arrays that read back and agree with the library.
mod command;

use std::fs;

use command::{HEIGHT, Pair, Said, WIDTH, dorsal};
use dorsal::v1_gabor::{FilterBank, GaborParams, LumaImage, MonogenicBank, MonogenicParams, Size};
use ndarray::Array2;
use num_complex::Complex32;
use serde_json::Value;
use stereo_formats::{npy, picture};

/// Runs `dorsal v1` on the left picture into the folder `out`.
fn v1(pair: &Pair, further: &[&str]) -> Said {
    let image = pair.path("left.png");
    let out = pair.path("out");
    let fixed = [
        "v1".as_ref(),
        image.as_os_str(),
        "--out".as_ref(),
        out.as_os_str(),
    ];
    dorsal(fixed.into_iter().chain(further.iter().map(AsRef::as_ref)))
}

fn record(pair: &Pair) -> Value {
    let text = fs::read_to_string(pair.path("out/v1.json")).expect("a file");
    serde_json::from_str(&text).expect("JSON")
}

/// Every file that the record names is there and of its kind.
#[track_caller]
fn all_files_read(pair: &Pair) {
    let record = record(pair);
    let files = record["files"].as_array().expect("files");
    for name in files.iter().filter_map(Value::as_str) {
        let path = pair.path("out").join(name);
        if name.ends_with(".png") {
            assert!(picture::read(&path).is_ok(), "{name}");
        } else {
            assert!(path.is_file(), "{name}");
        }
    }
    let written = fs::read_dir(pair.path("out")).expect("a folder").count();
    assert_eq!(written, files.len());
}

fn size() -> Size {
    Size {
        width: WIDTH,
        height: HEIGHT,
    }
}

#[test]
fn the_arrays_are_the_librarys() {
    let pair = Pair::new();
    let said = v1(&pair, &["--scales", "2", "--orientations", "6"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.out.contains("v1.json lists them"), "{}", said.out);
    all_files_read(&pair);

    let params = GaborParams {
        scales: 2,
        orientations: 6,
        ..GaborParams::default()
    };
    let bank = FilterBank::plan(params, size()).expect("two scales fit");
    let image = picture::read(pair.path("left.png")).expect("a picture");
    let seen = bank.respond(image.luma()).expect("the planned size");
    for (scale, responses) in seen.scales().iter().enumerate() {
        let name = |what: &str| pair.path(&format!("out/scale{scale}_{what}.npy"));
        let array = npy::read::<Complex32>(name("responses")).expect("complex numbers");
        let (height, width) = responses.size().dim();
        assert_eq!(array.shape(), [6, height, width]);
        // Responses of one machine are the same to the last bit.
        assert_eq!(array[[3, 20, 30]], responses.at(3, 30, 20));
        let frequency = npy::read::<f32>(name("frequency")).expect("numbers");
        assert_eq!(frequency.shape(), [6, 2, height, width]);
        let dominant = npy::read::<f32>(name("dominant")).expect("numbers");
        assert_eq!(dominant.shape(), [2, height, width]);
        let singular = npy::read::<bool>(name("singular")).expect("truth values");
        assert_eq!(singular.shape(), [6, height, width]);
    }
    let congruency = npy::read::<f32>(pair.path("out/congruency.npy")).expect("numbers");
    assert_eq!(congruency.shape(), [HEIGHT, WIDTH]);
    let record = record(&pair);
    assert_eq!(record["schema"], "dorsal-v1/1");
    assert_eq!(
        (&record["family"], &record["orientations"]),
        (&"gabor".into(), &6.into())
    );
    assert_eq!(record["scales"][1]["width"], WIDTH / 2);
}

#[test]
fn every_family_writes() {
    for (family, bandwidth) in [("gabor", 1.0), ("s2", 1.7647), ("s4", 1.2244), ("sqf", 1.0)] {
        let pair = Pair::new();
        let said = v1(&pair, &["--family", family, "--quiet"]);
        assert_eq!((said.code, &*said.err), (Some(0), ""), "{family}");
        all_files_read(&pair);
        let record = record(&pair);
        // 120 rows carry five scales.
        assert_eq!(record["scales"].as_array().map(Vec::len), Some(5));
        let told = record["bandwidth_octaves"].as_f64().expect("a number");
        assert!((told - bandwidth).abs() < 1e-4, "{family}: {told}");
    }
}

#[test]
fn the_monogenic_signal_is_the_librarys() {
    let pair = Pair::new();
    assert_eq!(
        v1(&pair, &["--family", "sqf", "--scales", "1"]).code,
        Some(0)
    );
    let params = MonogenicParams {
        scales: 1,
        ..MonogenicParams::default()
    };
    let bank = MonogenicBank::plan(params, size()).expect("one scale fits");
    let image = picture::read(pair.path("left.png")).expect("a picture");
    let seen = bank.respond(image.luma()).expect("the planned size");
    let response = seen.scales()[0].at(30, 20);
    let parts = npy::read::<f32>(pair.path("out/scale0_monogenic.npy")).expect("numbers");
    assert_eq!(parts.shape(), [3, HEIGHT, WIDTH]);
    assert_eq!(parts[[1, 20, 30]], response.along_x);
    let local = npy::read::<f32>(pair.path("out/scale0_local.npy")).expect("numbers");
    assert_eq!(local[[0, 20, 30]], response.amplitude());
    assert_eq!(
        local[[2, 20, 30]],
        response.theta_rad().expect("a direction")
    );
}

#[test]
fn what_no_filter_can_be_is_refused_with_the_reason() {
    for (arguments, helpful) in [
        ("--orientations 3", "4 to 32"),
        ("--peak-frequency 4", "not between 0 and pi"),
        ("--peak-frequency 0.5", "taps cuts an envelope"),
        ("--bandwidth -1", "not positive"),
        ("--taps 10", "an odd number"),
        ("--scales 0", "at least one scale"),
        (
            "--family s2 --peak-frequency 2.1",
            "beyond the Nyquist frequency",
        ),
        ("--family s4 --bandwidth 1", "has its own"),
        ("--family sqf --orientations 8", "one local orientation"),
        ("--family sqf --taps 11", "Fourier domain"),
        ("--family magic", "sqf"),
    ] {
        let line = format!("v1 left.png --out o {arguments}");
        let said = dorsal(line.split_whitespace());
        assert_eq!(said.code, Some(2), "{line}: {}", said.err);
        assert!(said.err.contains(helpful), "{line}: {}", said.err);
    }
}

/// What this picture does not carry is its own failure, and leaves no folder.
#[test]
fn too_many_scales_for_the_picture() {
    let pair = Pair::new();
    for scales in ["9", "40"] {
        let said = v1(&pair, &["--scales", scales]);
        assert_eq!(said.code, Some(1));
        for word in ["left.png", "at most 5"] {
            assert!(said.err.contains(word), "{}", said.err);
        }
    }
    assert!(!pair.path("out").exists());
    fs::remove_file(pair.path("left.png")).expect("removed");
    let said = v1(&pair, &[]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("cannot be opened"), "{}", said.err);
}

#[test]
fn small_and_slender_pictures_are_filtered() {
    for (width, height) in [(1, 1), (7, 3), (500, 2)] {
        for family in ["gabor", "s2", "s4", "sqf"] {
            let pair = Pair::new();
            let image = LumaImage::new(Array2::from_elem((height, width), 0.5));
            picture::write_luma(pair.path("left.png"), &image.expect("an image")).expect("a PNG");
            let said = v1(&pair, &["--family", family]);
            assert_eq!(
                said.code,
                Some(0),
                "{family} {width} x {height}: {}",
                said.err
            );
            all_files_read(&pair);
        }
    }
}
