//! `dorsal network`, `dorsal compose` and `dorsal tables --mode diff`.
mod command;

use std::fs;

use command::{Said, dorsal};
use serde_json::Value;
use tempfile::TempDir;

/// Runs `dorsal network` with the facts in a file; `@` is the folder of it.
fn network(folder: &TempDir, facts: &str, words: &[&str]) -> Said {
    let path = folder.path().join("facts.txt");
    fs::write(&path, facts).expect("a file");
    let named = |word: &&str| match *word {
        "FILE" => path.clone(),
        word => word.strip_prefix('@').map_or_else(
            || std::path::PathBuf::from(word),
            |name| folder.path().join(name),
        ),
    };
    dorsal(["network"].iter().chain(words).map(named))
}

#[test]
fn what_follows_is_printed_and_explained() {
    let folder = tempfile::tempdir().expect("a folder");
    let facts = "# The desk.\ncup within vc of box\n\nlamp within vc of cup # seen by Ann\n";
    let said = network(&folder, facts, &["check", "FILE"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    assert!(said.out.contains("not refuted: 2 facts about 3 objects"));
    assert!(said.out.contains("box - lamp: {vc, c, n}"), "{}", said.out);
    let said = network(
        &folder,
        facts,
        &["check", "FILE", "--explain", "box", "lamp"],
    );
    assert!(
        said.out
            .starts_with("box - lamp: {vc, c, n}, through cup\n")
    );
    let said = network(&folder, facts, &["check", "FILE", "--format", "json"]);
    let json: Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!(json["closure"], "not_refuted");
    assert_eq!(json["narrowed"], 3);
    let said = network(
        &folder,
        facts,
        &["check", "FILE", "--explain", "box", "ghost"],
    );
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("ghost"), "{}", said.err);
}

#[test]
fn a_contradiction_is_proved_and_fails() {
    let folder = tempfile::tempdir().expect("a folder");
    let facts = "cup within vc of box\nlamp within vc of cup\nlamp within vf of box\n";
    let said = network(&folder, facts, &["check", "FILE"]);
    assert_eq!(said.code, Some(1));
    assert!(said.out.contains("nothing is left") && said.out.contains("line 3"));
    assert!(
        said.err.contains("facts.txt is inconsistent"),
        "{}",
        said.err
    );
    let said = network(&folder, facts, &["check", "FILE", "--format", "json"]);
    let json: Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!(json["closure"], "inconsistent");
    assert!(json["proof"]["steps"].is_array());
    // It is written for GQR all the same, which is to find the same.
    let said = network(&folder, facts, &["export", "FILE", "--out", "@gqr"]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    let read = |name: &str| fs::read_to_string(folder.path().join("gqr").join(name));
    assert_eq!(
        read("network.csp").expect("a network"),
        "2 # robot-120 distances\n0 1 ( = vc )\n1 2 ( = vc )\n0 2 ( vf )\n.\n"
    );
    let spec = read("robot-120.spec").expect("a spec");
    assert!(spec.contains("comp_table_file robot-120.comp"));
    assert_eq!(read("robot-120.comp").expect("a table").lines().count(), 36);
    assert_eq!(
        read("robot-120.conv").expect("converses").lines().count(),
        6
    );
}

#[test]
fn broken_facts_are_named_with_their_line() {
    let folder = tempfile::tempdir().expect("a folder");
    for (facts, helpful) in [
        ("cup within vc of box\ncup near box\n", "line 2"),
        ("cup within near of box\n", "a distance class"),
        ("cup within vc of cup\n", "`cup`"),
    ] {
        let said = network(&folder, facts, &["check", "FILE"]);
        assert_eq!((said.code, said.out.as_str()), (Some(1), ""));
        assert!(said.err.contains(helpful), "{}", said.err);
        assert!(said.err.contains("facts.txt"), "{}", said.err);
    }
    let said = network(&folder, "", &["check", "@none.txt"]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("none.txt"), "{}", said.err);
    let said = network(&folder, "", &["check"]);
    assert_eq!(said.code, Some(2));
}

#[test]
fn directions_and_distances_are_closed_together() {
    let folder = tempfile::tempdir().expect("a folder");
    let facts = "cup within n of door\nlamp within n of cup\nlamp l of cup seen from door\n";
    let said = network(&folder, facts, &["check", "FILE"]);
    assert_eq!((said.code, said.err.as_str()), (Some(0), ""));
    assert!(said.out.contains("door - lamp: {f}"), "{}", said.out);
    assert!(
        said.out.contains("lamp at door seen from cup: {"),
        "{}",
        said.out
    );
    let words = ["check", "FILE", "--explain", "door", "lamp"];
    let said = network(&folder, facts, &words);
    assert!(
        said.out.contains("told: line 3: lamp l of cup"),
        "{}",
        said.out
    );
    let words = ["check", "FILE", "--format", "json"];
    let json: Value = serde_json::from_str(&network(&folder, facts, &words).out).expect("JSON");
    assert!(
        json["directions"]
            .as_array()
            .is_some_and(|some| !some.is_empty())
    );
    let more = format!("{facts}lamp within vc of door\n");
    let said = network(&folder, &more, &["check", "FILE"]);
    assert_eq!(said.code, Some(1));
    assert!(said.out.contains("nothing is left"), "{}", said.out);
    let said = network(&folder, facts, &["export", "FILE", "--out", "@gqr"]);
    assert_eq!(said.code, Some(1));
    assert!(said.err.contains("line 3"), "{}", said.err);
    assert!(!folder.path().join("gqr").exists());
}

fn composed(line: &str) -> Said {
    dorsal(["compose"].into_iter().chain(line.split_whitespace()))
}

#[test]
fn compositions_are_those_of_the_tables() {
    for (line, answer) in [
        (
            "--case 1 vc c",
            "{vc, c, n, f}, {fl, sf, fr, l, n, r, bl, sb, br}\n",
        ),
        ("--case 1 fd d --system drs2 --mode published", "{fd}\n"),
        ("--case 3 n ct --system drs2 --mode published", "{h}\n"),
        // Straight on, and straight on again: the distances add.
        ("--case 1 c@sf c@sf", "{f}, {sf}\n"),
        ("--case 4 vc vc", "{vc, c, n, f, vf}\n"),
        ("--case 4 vf@sf vf@sf --base vc", "{vf}\n"),
        ("--case ego vc vf@sb", "{vf}, {sb}\n"),
        (
            "--case 3 vf vc@fl",
            "nothing is left: no three points of the plane are so\n",
        ),
    ] {
        let said = composed(line);
        assert_eq!(said.code, Some(0), "{line}: {}", said.err);
        assert_eq!(said.out, answer, "{line}");
    }
    let said = composed("--case ego n n@fl --format json");
    let json: Value = serde_json::from_str(&said.out).expect("JSON");
    assert_eq!(
        (&json["mode"], &json["system"]),
        (&"sound".into(), &"robot-120".into())
    );
    for (line, helpful) in [
        ("--case 5 vc c", "possible values"),
        ("--case 1 vc", "CLASSES"),
        ("--case 1 near c", "vc c n f vf"),
        ("--case 1 vc@up c", "fl sf fr"),
        ("--case 1 vc@fl c --mode published", "leave the labels out"),
        ("--case 1 vc c --base vc", "--case 4"),
    ] {
        let said = composed(line);
        assert_eq!(said.code, Some(2), "{line}: {}", said.err);
        assert!(said.err.contains(helpful), "{line}: {}", said.err);
    }
}

#[test]
fn the_calculi_part_where_a_triangle_shows_it() {
    let diff = |case: &str, format: &str| {
        let said = dorsal([
            "tables", "--system", "drs2", "--case", case, "--mode", "diff", "--format", format,
        ]);
        assert_eq!(said.code, Some(0), "{}", said.err);
        said.out
    };
    let text = diff("1", "text");
    assert!(text.starts_with(
        "drs2, CASE 1: the published answer excludes a real configuration in 12 of 49"
    ));
    assert!(text.contains("CASE 1: fd, d -> {fd}, but 120 cm and 118 cm"));
    assert!(diff("1", "markdown").starts_with("| first | second | published"));
    // Every witness is a triangle, in whole micrometres.
    for (case, cells) in [("1", 12), ("2", 49), ("3", 49), ("4", 0)] {
        let json: Value = serde_json::from_str(&diff(case, "json")).expect("JSON");
        let omissions = json.as_array().expect("cells");
        assert_eq!(omissions.len(), cells, "case {case}");
        for witness in omissions
            .iter()
            .flat_map(|o| o["witnesses"].as_array().expect("some"))
        {
            let mut sides = ["first_um", "second_um", "third_um"]
                .map(|side| witness[side].as_u64().expect("a whole number"));
            sides.sort_unstable();
            assert!(sides[2] <= sides[0] + sides[1], "{witness}");
        }
    }
}

#[test]
fn help_has_examples() {
    for words in [
        &["compose", "--help"][..],
        &["network", "--help"],
        &["network", "check", "--help"],
        &["network", "export", "--help"],
        &["memory", "--help"],
    ] {
        let said = dorsal(words);
        assert_eq!(said.code, Some(0), "{words:?}");
        assert!(said.out.contains("Example"), "{words:?}");
    }
}
