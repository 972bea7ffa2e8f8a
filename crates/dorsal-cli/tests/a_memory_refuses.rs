//! What contradicts, breaks or cannot be understood leaves the memory as it was, byte by byte.
mod command;
mod desk;

use std::fs;

use desk::Desk;

/// The command fails in this way, says all of this, and changes nothing.
#[track_caller]
fn refused(desk: &Desk, words: &[&str], code: i32, helpful: &[&str]) {
    let before = desk.bytes();
    let said = desk.memory(words);
    assert_eq!(said.code, Some(code), "{words:?}: {}", said.err);
    for part in helpful {
        assert!(said.err.contains(part), "no '{part}' in: {}", said.err);
    }
    assert_eq!(said.out, "");
    assert_eq!(desk.bytes(), before, "{words:?}");
}

#[test]
fn contradictions_come_with_their_premises() {
    let desk = Desk::new();
    desk.seen();
    let far = "cup within vf of cd_box";
    refused(
        &desk,
        &["tell", far],
        1,
        &[
            "stays as it was",
            "nothing is left",
            "measured in looks 2",
            far,
        ],
    );
    desk.scene(
        "moved.json",
        &[("cup", 0.60, 0.90), ("cd_box", -0.10, 0.80)],
    );
    refused(
        &desk,
        &["add", "@moved.json", "--time", "3000"],
        1,
        &["moved.json is not taken in", "`cup` seen elsewhere"],
    );
    let nobody = ["retract", "cup within vc of cd_box"];
    refused(&desk, &nobody, 1, &["nobody told that"]);
}

#[test]
fn time_does_not_run_backwards() {
    let desk = Desk::new();
    desk.seen();
    let words = ["add", "@scene.json", "--time", "1500"];
    refused(&desk, &words, 1, &["1500 ms", "2000 ms"]);
}

#[test]
fn broken_scenes_are_named() {
    let desk = Desk::new();
    desk.seen();
    let write = |name: &str, text: &str| fs::write(desk.path(name), text).expect("a file");
    let scene = fs::read_to_string(desk.path("scene.json")).expect("a scene");
    write("half.json", &scene[..scene.len() / 2]);
    write(
        "other.json",
        &scene.replace("dorsal-scene/1", "dorsal-scene/9"),
    );
    write(
        "negative.json",
        &scene.replace("\"distance_sigma_m\":0.01", "\"distance_sigma_m\":-0.01"),
    );
    for (name, helpful) in [
        ("@half.json", "no scene.json"),
        ("@other.json", "dorsal-scene/9"),
        ("@negative.json", "must not be negative"),
        ("@none.json", "cannot be read"),
    ] {
        let words = ["add", name, "--time", "3000"];
        refused(&desk, &words, 1, &[&name[1..], helpful]);
    }
    desk.scene("twice.json", &[("cup", -0.60, 0.90), ("cup", -0.60, 0.90)]);
    let words = ["add", "@twice.json", "--time", "3000"];
    refused(&desk, &words, 1, &["`cup` is seen twice"]);
    let words = [
        "add",
        "@scene.json",
        "--rig",
        "@none.toml",
        "--eyes-height",
        "1",
    ];
    refused(&desk, &words, 1, &["none.toml"]);
}

#[test]
fn unknown_words_and_objects() {
    let desk = Desk::new();
    desk.seen();
    refused(&desk, &["ask", "where ghost"], 1, &["`ghost`"]);
    refused(
        &desk,
        &["ask", "within near of robot"],
        1,
        &["near", "robot-120"],
    );
    refused(&desk, &["explain", "cup", "ghost"], 1, &["`ghost`"]);
    refused(&desk, &["ask", "where is the cup"], 2, &["where", "--help"]);
    refused(&desk, &["tell", "cup near box"], 2, &["`near`", "`within`"]);
    refused(
        &desk,
        &["tell", "cup within near of box"],
        2,
        &["a distance class"],
    );
    refused(&desk, &["tell", "cup within vc of cup"], 1, &["`cup`"]);
}

#[test]
fn wrong_arguments() {
    let desk = Desk::new();
    for (words, helpful) in [
        (&["add"][..], "<SCENE>"),
        (&["add", "@s.json", "--pose", "1,2"], "X,Z,HEADING"),
        (&["add", "@s.json", "--pose", "1,2,3", "--lost"], "--lost"),
        (&["add", "@s.json", "--pose-sigma", "1,2"], "--pose"),
        (&["add", "@s.json", "--rig", "@rig.toml"], "--eyes-height"),
        (&["add", "@s.json", "--eyes-height", "nan"], "metres"),
        (&["add", "@s.json", "--time", "-1"], "-1"),
        (&["diff"], "BEFORE.json"),
        (&["show", "--format", "svg"], "svg"),
        (&["init", "--policy", "hope"], "hope"),
        (&["forget"], "forget"),
        (&[], "Usage"),
    ] {
        refused(&desk, words, 2, &[helpful]);
    }
}

#[test]
fn a_memory_is_not_made_twice_by_accident() {
    let desk = Desk::new();
    desk.seen();
    refused(&desk, &["init"], 1, &["exists already", "--force"]);
    let said = desk.memory(&["init", "--force", "--system", "drs2"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    assert!(desk.memory(&["show"]).out.contains("0 looks"));
}

#[test]
fn a_memory_that_is_missing_or_broken_is_named() {
    let desk = Desk::without_memory();
    for words in [
        &["ask", "where cup"][..],
        &["show"],
        &["tell", "a within vc of b"],
        &["watch"],
    ] {
        let said = desk.memory(words);
        assert_eq!(said.code, Some(1), "{words:?}");
        for part in ["memory.json", "dorsal memory init"] {
            assert!(said.err.contains(part), "{}", said.err);
        }
    }
    fs::write(
        desk.path("memory.json"),
        "{\"schema\": \"dorsal-memory/9\"}",
    )
    .expect("a file");
    refused(&desk, &["show"], 1, &["memory.json", "dorsal-memory/9"]);
    fs::write(desk.path("memory.json"), "{\"schema\": ").expect("a file");
    refused(&desk, &["tell", "a within vc of b"], 1, &["not a memory"]);
}

#[test]
fn every_command_has_help_with_examples() {
    for command in [
        "init", "add", "ask", "explain", "tell", "retract", "show", "diff", "watch",
    ] {
        let said = command::dorsal(["memory", command, "--help"]);
        assert_eq!(said.code, Some(0));
        assert!(said.out.contains("Example"), "{command}");
    }
}
