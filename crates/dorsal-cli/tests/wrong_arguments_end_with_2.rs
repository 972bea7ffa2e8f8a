//! Wrong arguments end with exit code 2 and a sentence that helps.
mod command;

use command::dorsal;

#[track_caller]
fn refused(line: &str, helpful: &str) {
    let said = dorsal(line.split_whitespace());
    assert_eq!(said.code, Some(2), "{line}: {}", said.err);
    assert!(said.err.contains(helpful), "{line}: {}", said.err);
    assert!(said.err.contains("Usage:"), "{line}: {}", said.err);
    assert_eq!(said.out, "");
}

#[test]
fn what_is_missing_or_unknown_is_named() {
    refused("", "Examples:");
    refused("look", "<LEFT|FOLDER|LIST>");
    refused("look left.png", "--out <DIR>");
    refused(
        "look l.png r.png --out o --again",
        "--again is for a folder",
    );
    refused(
        "look folder --out o --mcap log.mcap",
        "--mcap logs one look",
    );
    refused("bag walk.mcap --left /l", "--right <TOPIC>");
    refused("live --format gray", "--size <WxH>");
    refused("look left.png right.png", "--out <DIR>");
    refused("look l.png r.png --out o --colour", "--colour");
    refused("demo", "--out <DIR>");
    refused("flow frame1.png --out o", "<NEXT>");
    refused("v1 left.png", "--out <DIR>");
    refused("calibrate l.png r.png --rig rig.toml", "--out <FIXED.toml>");
    refused(
        "calibrate l.png r.png --rig rig.toml --out o.toml --turned --yaw-sigma 1",
        "cannot be used with",
    );
    refused("rig convert", "<RIG>");
    refused("tables --case 1", "--system <SYSTEM>");
}

#[test]
fn values_are_checked_before_any_work() {
    for (argument, helpful) in [
        ("--scales 0", "a whole number from 1 to 32"),
        ("--energy-threshold -1", "not negative"),
        ("--zero-disparity nan", "a finite number"),
        ("--threads 0", "--threads"),
        ("--estimator magic", "vector"),
        ("--max-disparity far", "or auto"),
        ("--range far", "wide"),
        ("--segment", "--rig"),
        ("--estimator dense --rectify rig", "--rig"),
        (
            "--rig r.toml --segment --labels l.png",
            "cannot be used with",
        ),
        ("--range wide --scales 5", "cannot be used with"),
        ("--min-disparity 9999", "from -8000 to 8000"),
        (
            "--max-disparity 3 --min-disparity 4",
            "no disparity lies between",
        ),
    ] {
        let line = format!("look l.png r.png --out o {argument}");
        // A leading minus looks like an argument to the parser, so the value is joined.
        let line = line.replace("threshold -1", "threshold=-1");
        let said = dorsal(line.split_whitespace());
        assert_eq!(said.code, Some(2), "{line}: {}", said.err);
        assert!(said.err.contains(helpful), "{line}: {}", said.err);
    }
    let said = dorsal(["tables", "--system", "drs1", "--case", "5"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("from 1 to 4"), "{}", said.err);
}

#[test]
fn frames_and_topics_that_hold_no_two_eyes_are_refused() {
    for (line, helpful) in [
        (
            "bag walk.mcap --left /l --right /l --mcap o.mcap",
            "both /l",
        ),
        (
            "live --format gray --size 0x0 --mcap o.mcap",
            "no two halves",
        ),
        (
            "live --format gray --size 641x480 --mcap o.mcap",
            "even number",
        ),
        ("live --format gray --size 640 --mcap o.mcap", "1280x480"),
    ] {
        let said = dorsal(line.split_whitespace());
        assert_eq!(said.code, Some(2), "{line}: {}", said.err);
        assert!(said.err.contains(helpful), "{line}: {}", said.err);
    }
}

#[test]
fn labels_need_a_rig() {
    refused(
        "look l.png r.png --out o --labels labels.png",
        "--rig <RIG.toml>",
    );
}

#[test]
fn outlines_have_names_already() {
    refused(
        "look l.png r.png --out o --rig rig.toml --labels labels.toml --names names.toml",
        "leave --names out",
    );
}

#[test]
fn help_and_version_are_no_failure() {
    for line in [
        "--help",
        "--version",
        "look --help",
        "demo --help",
        "tables --help",
        "flow --help",
        "v1 --help",
    ] {
        let said = dorsal(line.split_whitespace());
        assert_eq!(said.code, Some(0), "{line}");
        assert!(said.out.contains(if line == "--version" {
            "dorsal 0"
        } else {
            "Example"
        }));
    }
}
