//! A look at a synthetic pair leaves files that read back and agree with each other.
mod command;

use std::fs;

use command::{D, HEIGHT, Pair, WIDTH, dorsal};
use dorsal::disparity_pyramid::Validity;
use dorsal::egocentric_depth::LabelImage;
use dorsal::v1_gabor::Size;
use ndarray::Array2;
use serde_json::Value;
use stereo_formats::{flo, label_png, pfm, picture, rig_toml, validity_png};
use stereo_scenes::{Exposure, Room, render};

fn json(pair: &Pair, name: &str) -> Value {
    let text = fs::read_to_string(pair.path(name)).expect("a file");
    serde_json::from_str(&text).expect("JSON")
}

#[test]
fn disparity_alone() {
    let pair = Pair::new();
    let said = pair.look(&[]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    // 120 rows carry five scales.
    assert!(said.out.contains("5 scales from 0 px"), "{}", said.out);
    for word in ["160 x 120 pixels", "valid", "median", "ms", "disparity.pfm"] {
        assert!(said.out.contains(word), "{}", said.out);
    }

    let d = pfm::read(pair.path("out/disparity.pfm")).expect("a PFM");
    let vectors = flo::read(pair.path("out/disparity.flo")).expect("a .flo");
    let confidence = pfm::read(pair.path("out/confidence.pfm")).expect("a PFM");
    let sigma = pfm::read(pair.path("out/sigma_dx.pfm")).expect("a PFM");
    let validity = validity_png::read(pair.path("out/validity.png")).expect("a PNG");
    assert_eq!(d.dim(), (HEIGHT, WIDTH));
    for ((y, x), &validity) in validity.indexed_iter() {
        let known = validity == Validity::Valid;
        assert_eq!(d[[y, x]].is_finite(), known, "at {x}, {y}");
        assert_eq!(vectors.at(x, y).is_some(), known, "at {x}, {y}");
        assert_eq!(sigma[[y, x]].is_finite(), known, "at {x}, {y}");
        assert!((0.0..=1.0).contains(&confidence[[y, x]]));
        if let Some((dx, _)) = vectors.at(x, y) {
            assert_eq!(dx, 0.0 - d[[y, x]], "the sign turns between the files");
        }
    }
    // Away from the borders the wall has its disparity: nearer is positive in files. A tenth of a
    // pixel is what smooth waves at 16 bits allow with room.
    let mut inside: Vec<f32> = d
        .slice(ndarray::s![20..HEIGHT - 20, 20..WIDTH - 20])
        .iter()
        .copied()
        .filter(|d| d.is_finite())
        .collect();
    inside.sort_unstable_by(f32::total_cmp);
    assert!((inside[inside.len() / 2] - D).abs() < 0.1);

    let look = json(&pair, "out/look.json");
    assert_eq!(look["schema"], "dorsal-look/1");
    assert_eq!(
        (&look["width"], &look["height"]),
        (&WIDTH.into(), &HEIGHT.into())
    );
    assert_eq!(look["gabor"]["scales"], 5);
    assert_eq!(look["search"]["scales"], 5);
    assert_eq!(look["search"]["found"], false);
    let valid = validity
        .iter()
        .filter(|validity| validity.is_valid())
        .count();
    assert_eq!(look["pixels"]["valid"], valid);
    let counts = look["pixels"].as_object().expect("counts").values();
    assert_eq!(
        counts.filter_map(Value::as_u64).sum::<u64>(),
        (WIDTH * HEIGHT) as u64
    );
    for file in look["files"].as_array().expect("files") {
        assert!(
            pair.path("out")
                .join(file.as_str().expect("a name"))
                .is_file()
        );
    }
    // The scale bar stands under the picture.
    let coloured = picture::read(pair.path("out/disparity.png")).expect("a PNG");
    assert!(coloured.size().width == WIDTH && coloured.size().height > HEIGHT);
    assert!(!pair.path("out/depth.pfm").exists());
}

/// Far beyond what scales from zero reach, the range is found without an option.
#[test]
fn a_far_range_is_found() {
    const FAR: f32 = 52.0;
    let pair = Pair::far(FAR);
    let said = pair.look(&[]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.out.contains("found by a coarse look"), "{}", said.out);
    let search = &json(&pair, "out/look.json")["search"];
    assert_eq!(search["found"], true);
    // One pixel of the coarse look is two of the picture.
    let start = search["starts"][0]["disparity_px"].as_f64();
    let miss = start.expect("a number") - f64::from(FAR);
    assert!(miss.abs() <= 2.0, "{search}");
    // A third of the left picture is not in the right one.
    let d = pfm::read(pair.path("out/disparity.pfm")).expect("a PFM");
    let seen = d.slice(ndarray::s![10..HEIGHT - 10, 70..WIDTH - 10]);
    let right = seen.iter().filter(|d| (**d - FAR).abs() < 0.1).count();
    assert!(
        right as f64 > 0.9 * seen.len() as f64,
        "{right} of {}",
        seen.len()
    );
    assert!(pair.path("out/sigma_dx.pfm").is_file());

    // A given search is taken as it is, and the user is told of scales that the rows do not carry.
    let given = pair.look(&["--zero-disparity", "50", "--scales", "6"]);
    assert!(given.err.contains("carry 5 scales, not 6"), "{}", given.err);
    assert!(given.out.contains("5 scales from 50 px"), "{}", given.out);
    assert_eq!(json(&pair, "out/look.json")["search"]["found"], false);
}

/// A wide search finds what is near too.
#[test]
fn a_wide_search_finds_what_is_near() {
    let pair = Pair::new();
    let said = pair.look(&["--range", "wide", "--rows-only"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let look = json(&pair, "out/look.json");
    assert_eq!(look["search"]["found"], true);
    assert_eq!(look["search"]["starts"][0]["vertical_px"], 0.0);
    let median = look["disparity_px"]["median"].as_f64().expect("a number");
    assert!((median - f64::from(D)).abs() < 0.1, "{median}");
}

#[test]
fn dense_leaves_nothing_unknown() {
    let pair = Pair::new();
    assert_eq!(pair.look(&["--dense"]).code, Some(0));
    let d = pfm::read(pair.path("out/disparity.pfm")).expect("a PFM");
    assert!(d.iter().all(|d| d.is_finite()));
    let vectors = flo::read(pair.path("out/disparity.flo")).expect("a .flo");
    assert!(vectors.dx().iter().all(|dx| dx.is_finite()));
    assert_eq!(json(&pair, "out/look.json")["dense"], true);
}

#[test]
fn the_dense_estimator_finds_its_range_or_takes_it() {
    let pair = Pair::new();
    for range in [
        &["--preset", "best"][..],
        &["--max-disparity", "20", "--preset", "fast"],
    ] {
        let said = pair.look(&[&["--estimator", "dense"], range].concat());
        assert_eq!(said.code, Some(0), "{}", said.err);
        assert!(said.err.contains("px are tried"), "{}", said.err);
        let d = pfm::read(pair.path("out/disparity.pfm")).expect("a PFM");
        // The first D columns of the left picture are not in the right one.
        let seen = d.slice(ndarray::s![.., 10..]);
        let right = seen.iter().filter(|d| (**d - D).abs() < 0.1).count();
        assert!(
            right as f64 > 0.98 * seen.len() as f64,
            "{right} of {}",
            seen.len()
        );
        let look = json(&pair, "out/look.json");
        assert_eq!(look["estimator"], "dense");
        assert!(look["dense_matching"]["look_back"].is_string());
    }
}

#[test]
fn depth_and_relations() {
    let pair = Pair::new();
    // Two posters on the wall, and one mark too small to be placed.
    let labels = Array2::from_shape_fn((HEIGHT, WIDTH), |(y, x)| match (x, y) {
        (40..60, 40..70) => 1,
        (100..130, 50..80) => 2,
        (80, 60) => 3,
        _ => 0,
    });
    label_png::write(pair.path("labels.png"), &LabelImage::new(labels)).expect("a PNG");
    fs::write(
        pair.path("names.toml"),
        "[names]\n1 = \"map\"\n2 = \"photo\"\n3 = \"pin\"\n",
    )
    .expect("names");
    let said = pair.look(&[
        "--rig",
        "@rig.toml",
        "--labels",
        "@labels.png",
        "--names",
        "@names.toml",
        "--system",
        "drs2",
    ]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(
        said.err.contains("reach every depth beyond"),
        "{}",
        said.err
    );
    for word in ["map", "photo", "pin has no place", "further than double"] {
        assert!(said.out.contains(word), "no '{word}' in:\n{}", said.out);
    }

    let depth = pfm::read(pair.path("out/depth.pfm")).expect("a PFM");
    // The wall is 2 m away; a tenth of a pixel of 6 is a sixtieth of that.
    assert!((depth[[60, 80]] - 2.0).abs() < 0.04, "{}", depth[[60, 80]]);
    let known = depth.iter().filter(|depth| depth.is_finite()).count();
    let ply = fs::read(pair.path("out/cloud.ply")).expect("a cloud");
    let header = format!("element vertex {known}\n");
    assert!(
        ply.windows(header.len())
            .any(|part| part == header.as_bytes())
    );
    assert!(pair.path("out/depth.png").is_file());

    let scene = json(&pair, "out/scene.json");
    assert_eq!(scene["schema"], "dorsal-scene/1");
    assert_eq!(scene["reference"]["name"], "drs2");
    assert_eq!(scene["objects"][0]["name"], "map");
    assert_eq!(scene["objects"][0]["label"], 1);
    let depth_m = scene["objects"][1]["depth_m"].as_f64().expect("a number");
    assert!((depth_m - 2.0).abs() < 0.04);
    assert_eq!(scene["unlocated"][0]["name"], "pin");
    assert_eq!(scene["egocentric"][0]["mode"], "sound");
    let measured = &scene["allocentric"]["measured"];
    // Two objects see each other both ways; the photo is to the right of the map.
    assert_eq!(measured.as_array().expect("relations").len(), 2);
    assert_eq!(
        (&measured[0]["from"], &measured[0]["to"]),
        (&"map".into(), &"photo".into())
    );
    let sides = measured[0]["orientation"].as_array().expect("labels");
    assert!(
        sides.contains(&"r".into()) || sides.contains(&"br".into()),
        "{sides:?}"
    );
    assert_eq!(scene["allocentric"]["inferred"]["mode"], "published");
}

#[test]
fn outlines_serve_as_labels() {
    let pair = Pair::new();
    fs::write(
        pair.path("labels.toml"),
        "width = 160\nheight = 120\n[[object]]\nname = \"map\"\n\
         polygon = [[40, 40], [60, 40], [60, 70], [40, 70]]\n",
    )
    .expect("outlines");
    let said = pair.look(&["--rig", "@rig.toml", "--labels", "@labels.toml"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert_eq!(json(&pair, "out/scene.json")["objects"][0]["name"], "map");
}

/// Along rows alone the vertical shift is held, and a strict test for singularities is counted.
#[test]
fn rows_alone_and_singular_places() {
    let pair = Pair::new();
    let said = pair.look(&["--published", "--rows-only", "--singularity-tau", "1.25"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let look = json(&pair, "out/look.json");
    assert_eq!(look["matching"]["rows_only"], true);
    assert_eq!(look["matching"]["singularity_tau"], 1.25);
    assert!(look["pixels"]["singular"].is_u64());
    let sigma = pfm::read(pair.path("out/sigma_dy.pfm")).expect("a PFM");
    assert!(sigma.iter().all(|sigma| sigma.is_nan() || *sigma == 0.0));
    assert_eq!(pair.look(&["--singularity-tau", "0"]).code, Some(2));
}

#[test]
fn quiet_says_nothing_beside_the_results() {
    let pair = Pair::new();
    let said = pair.look(&["--quiet", "--rig", "@rig.toml", "--threads", "1"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    assert!(said.out.contains("written"));
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let (one, two) = (Pair::new(), Pair::new());
    assert_eq!(one.look(&["--threads", "1"]).code, Some(0));
    assert_eq!(two.look(&["--threads", "3"]).code, Some(0));
    for name in [
        "disparity.flo",
        "confidence.pfm",
        "validity.png",
        "disparity.png",
    ] {
        let read = |pair: &Pair| fs::read(pair.path("out").join(name)).expect("a file");
        assert!(read(&one) == read(&two), "{name} differs");
    }
}

#[test]
fn two_different_pictures_draw_a_note() {
    let pair = Pair::new();
    let plain = dorsal::v1_gabor::LumaImage::new(Array2::from_elem((HEIGHT, WIDTH), 0.5));
    picture::write_luma(pair.path("right.png"), &plain.expect("an image")).expect("a PNG");
    let said = pair.look(&[]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(said.err.contains("are the pictures a pair"), "{}", said.err);
    assert!(pair.folder().join("out/look.json").is_file());
}

/// What stands on a table is found without labels behind eyes that converge, densely if nothing is said.
#[test]
fn objects_are_found_without_labels() {
    let room = Room::demo();
    let size = Size {
        width: 384,
        height: 288,
    };
    let gaze = room
        .head()
        .resized(size)
        .fixate(room.fixation_m())
        .expect("a gaze");
    let view = render(&room, &gaze, Exposure::default()).expect("a view");
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    for (name, eye) in [
        ("left.png", &view.images.left),
        ("right.png", &view.images.right),
    ] {
        let codes = eye.plane().mapv(|light| [(255.0 * light).round() as u8; 3]);
        fs::write(
            path(name),
            picture::encode_rgb(codes.view()).expect("a PNG"),
        )
        .expect("a file");
    }
    fs::write(
        path("rig.toml"),
        rig_toml::encode(&gaze.rig()).expect("a rig"),
    )
    .expect("a file");
    for words_of_estimator in [&["--preset", "fast"][..], &[]] {
        let out = path(&format!("out-{}", words_of_estimator.len()));
        let mut words: Vec<std::ffi::OsString> = vec!["look".into()];
        words.extend(["left.png", "right.png"].map(|name| path(name).into()));
        words.extend(["--segment".into(), "--rig".into(), path("rig.toml").into()]);
        words.extend(words_of_estimator.iter().map(std::ffi::OsString::from));
        words.extend(["--out".into(), out.clone().into()]);
        let said = dorsal(words);
        assert_eq!(said.code, Some(0), "{}", said.err);
        assert!(said.out.contains("objects on a plane"), "{}", said.out);
        let found = label_png::read(out.join("label_image.png")).expect("labels");
        // Pictures so small lose what is thin; each that is left is an object of its own.
        let mut own = 0;
        for label in found.labels() {
            let mut votes = std::collections::BTreeMap::<u16, usize>::new();
            for (&is, &seen) in view.truth.labels.plane().iter().zip(found.plane()) {
                if seen == label.0.get() {
                    *votes.entry(is).or_default() += 1;
                }
            }
            let most = votes
                .iter()
                .max_by_key(|(_, votes)| **votes)
                .expect("pixels");
            own += usize::from(*most.0 != 0);
        }
        assert!(own >= 4, "{words_of_estimator:?}: {own}");
        let text = fs::read_to_string(out.join("scene.json")).expect("a scene");
        assert!(text.contains("\"object-1\""), "{text}");
        assert!(out.join("labels.png").is_file());
    }
}

/// A wall that faces the eyes bears nothing: the look is done all the same, and says why.
#[test]
fn without_a_table_there_is_a_reason() {
    let pair = Pair::new();
    let rig = pair.path("rig.toml");
    let said = pair.look(&["--segment", "--rig", rig.to_str().expect("a path")]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    assert!(
        said.err.contains("no objects: no plane below the eyes"),
        "{}",
        said.err
    );
    let look = json(&pair, "out/look.json");
    assert_eq!(look["segments"]["objects"], 0);
    assert!(look["segments"]["refused"].is_string(), "{look}");
    assert!(!pair.path("out/label_image.png").exists());
}
