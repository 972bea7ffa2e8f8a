//! `dorsal tables` prints Tables 2 and 3 of the paper, cell by cell, but for the four misprints.
mod command;

use std::collections::BTreeMap;

use command::dorsal;
use serde_json::Value;

/// `system | case | row | column` to the labels of the cell.
type Cells = BTreeMap<[String; 4], Vec<String>>;

fn fixture(name: &str) -> String {
    let path = format!(
        "{}/../../fixtures/tables/{name}",
        env!("CARGO_MANIFEST_DIR")
    );
    std::fs::read_to_string(path).expect("the fixture")
}

/// The cells of a fixture; `column` is where the cell stands.
fn cells(text: &str, column: usize) -> Cells {
    text.lines()
        .filter(|line| !line.starts_with('#') && !line.is_empty())
        .map(|line| {
            let fields: Vec<&str> = line.split(" | ").collect();
            let key = [0, 1, 2, 3].map(|at| fields[at].to_owned());
            let labels = fields[column].split_whitespace().map(str::to_owned);
            (key, labels.collect())
        })
        .collect()
}

fn table(system: &str, case: &str) -> Value {
    let said = dorsal([
        "tables", "--system", system, "--case", case, "--format", "json",
    ]);
    assert_eq!(said.code, Some(0), "{}", said.err);
    serde_json::from_str(&said.out).expect("JSON")
}

#[test]
fn json_holds_every_printed_cell_with_the_errata() {
    let mut expected = cells(&fixture("as_printed.txt"), 4);
    expected.extend(cells(&fixture("errata.txt"), 5));
    assert_eq!(expected.len(), 116);
    for (printed, cases) in [("case1", &["1"][..]), ("case23", &["2", "3"][..])] {
        for system in ["drs1", "drs2"] {
            for case in cases {
                let table = table(system, case);
                for ([of_system, of_case, row, column], labels) in &expected {
                    if of_system.to_lowercase() == system && of_case == printed {
                        assert_eq!(
                            table["cells"][row][column],
                            Value::from(labels.clone()),
                            "{system} case {case}: {row}, {column}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn json_has_exactly_the_promised_keys() {
    let table = table("drs1", "1");
    let keys: Vec<&String> = table.as_object().expect("an object").keys().collect();
    // The parser sorts them.
    assert_eq!(keys, ["case", "cells", "labels", "mode", "system"]);
    assert_eq!(table["system"], "drs1");
    assert_eq!(table["case"], 1);
    assert_eq!(table["mode"], "published");
    assert_eq!(table["labels"], Value::from(vec!["c", "n", "f"]));
}

#[test]
fn text_and_markdown_show_the_same_cells() {
    let cell = "{c, n, f}";
    let count = |format| {
        let said = dorsal([
            "tables", "--system", "drs1", "--case", "1", "--format", format,
        ]);
        said.out.matches(cell).count()
    };
    // Table 2 has five such cells: both rows of close and nearby, and far with far.
    assert_eq!((count("text"), count("markdown")), (5, 5));
}

#[test]
fn a_system_may_come_from_a_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("arm.toml");
    std::fs::write(
        &path,
        r#"name = "arm"
           class = [
               { short = "in", name = "within_reach", from_mm = 0 },
               { short = "out", name = "out_of_reach", from_mm = 850 },
           ]"#,
    )
    .expect("a file");
    let table = table(path.to_str().expect("UTF-8"), "1");
    assert_eq!(table["labels"], Value::from(vec!["in", "out"]));

    std::fs::write(&path, "name = \"arm\"\nclass = []").expect("a file");
    let said = dorsal([
        "tables",
        "--case",
        "1",
        "--system",
        path.to_str().expect("UTF-8"),
    ]);
    assert_eq!(said.code, Some(1));
    assert!(
        said.err.contains("arm.toml") && said.err.contains("at least one class"),
        "{}",
        said.err
    );
}
