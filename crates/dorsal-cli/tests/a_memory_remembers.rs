//! `dorsal memory` from the first look to the last question, Figure 12 among them.
mod command;
mod desk;

use std::fs;

use command::Pair;
use desk::Desk;
use dorsal::egocentric_depth::LabelImage;
use ndarray::Array2;
use serde_json::Value;
use stereo_formats::{label_png, pfm};

/// What the command says when all is well.
#[track_caller]
fn says(desk: &Desk, words: &[&str]) -> String {
    let said = desk.memory(words);
    assert_eq!(said.code, Some(0), "{words:?}: {}", said.err);
    assert_eq!(said.err, "");
    said.out
}

#[test]
fn what_has_left_the_view_is_remembered() {
    let desk = Desk::new();
    desk.seen();
    // The head moves to the left and turns; the screen leaves the view.
    let pose = ["--pose", "-0.15,0.05,25.78", "--time", "3000"];
    let (sin, cos) = 25.78f64.to_radians().sin_cos();
    let (dx, dz) = (-0.10 + 0.15, 0.80 - 0.05);
    let seen = [("cd_box", dx * cos + dz * sin, dz * cos - dx * sin)];
    desk.scene("second.json", &seen);
    let words = [&["add", "@second.json"][..], &pose].concat();
    let changes = says(&desk, &words);
    assert!(changes.contains("nothing became different") || changes.contains("pc_screen was"));
    let relation = "relation pc_screen from cd_box seen from robot";
    assert_eq!(
        says(&desk, &["ask", relation]),
        "pc_screen at cd_box: {vc}, {fr, r, br}; read vc r\n"
    );
    let within = says(&desk, &["ask", "within vc of cd_box and right of cd_box"]);
    assert_eq!(within, "certainly pc_screen; possibly none\n");
    let json: Value =
        serde_json::from_str(&says(&desk, &["ask", relation, "--format", "json"])).expect("JSON");
    assert_eq!(
        (&json["answer"], &json["depth"][0]),
        (&"relation".into(), &"vc".into())
    );
    let place = says(&desk, &["ask", "where pc_screen"]);
    assert!(place.contains("m to the right (sigma 0.0"), "{place}");
    let seen = says(&desk, &["ask", "last_seen pc_screen"]);
    assert!(seen.starts_with("in look 2, at 2000 ms"), "{seen}");
    let path = says(&desk, &["ask", "free_path from cup to pc_screen"]);
    assert_eq!(path, "blocked by cd_box\n");
}

#[test]
fn facts_are_told_explained_and_taken_back() {
    let desk = Desk::new();
    desk.seen();
    let before = desk.bytes();
    fs::write(desk.path("before.json"), &before).expect("a copy");
    let told = says(&desk, &["tell", "lamp within very_close of pc_screen"]);
    assert_eq!(told, "told: lamp within vc of pc_screen\n");
    let why = says(&desk, &["explain", "lamp", "cd_box"]);
    assert_eq!(
        why,
        "cd_box - lamp: {vc, c, n}, through pc_screen\n\
         \x20 cd_box - pc_screen: {vc}, measured in looks 2 and 2\n\
         \x20 lamp - pc_screen: {vc}, told: lamp within vc of pc_screen\n"
    );
    let json = says(&desk, &["explain", "lamp", "cd_box", "--format", "json"]);
    let json: Value = serde_json::from_str(&json).expect("JSON");
    assert_eq!(json["steps"].as_array().map(Vec::len), Some(3));
    let diff = says(&desk, &["diff", "@before.json"]);
    assert_eq!(diff, "told: lamp within vc of pc_screen\n");
    assert!(says(&desk, &["diff", "--from", "0"]).contains("1000 ms, look 1: cup appeared"));
    assert_eq!(says(&desk, &["diff", "--from", "9000"]), "");
    let shown = says(&desk, &["show"]);
    for part in ["pc_screen", "in_view", "told:", "lamp within vc", "2 looks"] {
        assert!(shown.contains(part), "no {part} in\n{shown}");
    }
    says(&desk, &["retract", "lamp within vc of pc_screen"]);
    assert_eq!(
        says(&desk, &["diff", "@before.json"]),
        "nothing became different\n"
    );
}

#[test]
fn a_memory_is_shown_in_three_forms() {
    let desk = Desk::new();
    desk.seen();
    assert_eq!(says(&desk, &["show", "--format", "json"]), desk.bytes());
    let dot = says(&desk, &["show", "--format", "dot"]);
    assert!(dot.starts_with("digraph memory {") && dot.contains("\"cd_box\" -> \"cup\""));
}

/// The depth map of the look says that there is nothing where the cup was.
#[test]
fn a_depth_map_is_evidence() {
    let desk = Desk::new();
    fs::write(
        desk.path("rig.toml"),
        "baseline_m = 0.1\n[left]\nfocal_px = 120.0\nprincipal_point_px = [79.5, 59.5]\n",
    )
    .expect("a rig");
    // A wall at 2 m behind whatever stood there; the eyes look straight ahead.
    let wall = Array2::from_elem((120, 160), 2.0f32);
    pfm::write(desk.path("depth.pfm"), wall.view()).expect("a depth map");
    let flags = ["--rig", "@rig.toml", "--eyes-height", "0.3"];
    let add = |scene: &str, time: u64, flags: &[&str]| {
        let time = time.to_string();
        says(&desk, &[&["add", scene, "--time", &time], flags].concat())
    };
    desk.scene("cup.json", &[("cup", 0.05, 0.9)]);
    desk.scene("nothing.json", &[]);
    let height = ["--eyes-height", "0.3"];
    add("@cup.json", 1, &height);
    add("@cup.json", 2, &height);
    for time in 3..5 {
        add("@nothing.json", time, &flags);
    }
    let changes = add("@nothing.json", 5, &flags);
    assert_eq!(changes, "cup was confirmed, is missing\n");
    // A look without a depth map says nothing, however often.
    let bytes = desk.bytes();
    assert_eq!(
        add("@nothing.json", 6, &["--dry-run"]),
        "nothing became different\n"
    );
    assert_eq!(desk.bytes(), bytes);
    for time in 6..8 {
        add("@nothing.json", time, &flags);
    }
    let changes = add("@nothing.json", 8, &flags);
    assert_eq!(changes, "cup was missing, is removed\n");
    let shown = says(&desk, &["show"]);
    assert!(shown.contains("gone"), "{shown}");
}

#[test]
fn a_lost_robot_opens_a_frame() {
    let desk = Desk::new();
    desk.seen();
    desk.scene("new.json", &[("lamp", 0.0, 0.9)]);
    let changes = says(&desk, &["add", "@new.json", "--time", "3000", "--lost"]);
    assert!(changes.contains("map frame 1 opens"), "{changes}");
    let said = desk.memory(&["ask", "where cup"]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("`cup`"), "{}", said.err);
    assert!(says(&desk, &["show"]).contains("in another map frame"));
}

/// From two pictures to an answer: what `dorsal look` writes is what `dorsal memory add` takes.
#[test]
fn what_a_look_writes_is_remembered() {
    let pair = Pair::new();
    let labels = Array2::from_shape_fn((command::HEIGHT, command::WIDTH), |(y, x)| {
        u16::from((40..60).contains(&x) && (40..70).contains(&y))
    });
    label_png::write(pair.path("labels.png"), &LabelImage::new(labels)).expect("a PNG");
    let said = pair.look(&["--rig", "@rig.toml", "--labels", "@labels.png", "--quiet"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let desk = Desk::new();
    let (scene, rig) = (pair.path("out"), pair.path("rig.toml"));
    let text = |path: &std::path::Path| path.to_str().expect("UTF-8").to_owned();
    let (scene, rig) = (text(&scene), text(&rig));
    let words = [
        "add",
        &scene,
        "--time",
        "1",
        "--rig",
        &rig,
        "--eyes-height",
        "0.3",
    ];
    assert_eq!(says(&desk, &words), "object-1 appeared\n");
    // The wall is 2 m away, and the poster a sixth of that to the left.
    let place = says(&desk, &["ask", "where object-1", "--format", "json"]);
    let place: Value = serde_json::from_str(&place).expect("JSON");
    let metres = |key: &str| place[key].as_f64().expect("a number");
    assert!((metres("forward_m") - 2.0).abs() < 0.05, "{place}");
    assert!((-0.6..-0.3).contains(&metres("right_m")), "{place}");
    let kept: Value = serde_json::from_str(&desk.bytes()).expect("JSON");
    let radius = kept["objects"]["object-1"]["radius_mm"].as_u64();
    // 600 pixels of a 60th of a metre are a disc of 23 cm.
    assert!(
        radius.is_some_and(|mm| (200..260).contains(&mm)),
        "{radius:?}"
    );
}
