//! Tables 2 and 3 follow from the calculus, but for four misprinted cells.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use std::collections::BTreeMap;
use std::path::Path;

use allocentric_qsr::{Case, CompositionTable, DepthReference, Mode};

/// System, case, row and column of a cell.
type Key = [String; 4];

fn lines(file: &str) -> Vec<Vec<String>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fixtures/tables");
    let text = std::fs::read_to_string(folder.join(file)).unwrap();
    text.lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            line.split('|')
                .map(|field| field.trim().to_owned())
                .collect()
        })
        .collect()
}

fn key(fields: &[String]) -> Key {
    [0, 1, 2, 3].map(|at| fields[at].clone())
}

fn derived(key: &Key, case: Case) -> String {
    let reference = DepthReference::preset(&key[0].to_lowercase()).unwrap();
    let class = |label: &str| reference.class_named(label).unwrap();
    let table = CompositionTable::new(&reference, case, Mode::Published);
    reference
        .labels(table.cell(class(&key[2]), class(&key[3])))
        .join(" ")
}

#[test]
fn every_printed_cell_follows_but_four() {
    let printed = lines("as_printed.txt");
    assert_eq!(printed.len(), 116);
    let mut differences = BTreeMap::new();
    for fields in &printed {
        let key = key(fields);
        let cases = match key[1].as_str() {
            "case1" => vec![Case::One],
            "case23" => vec![Case::Two, Case::Three],
            other => panic!("{other} is no case"),
        };
        for case in cases {
            let cell = derived(&key, case);
            if cell != fields[4] {
                differences.insert(key.clone(), (fields[4].clone(), cell));
            }
        }
    }
    let errata: BTreeMap<Key, (String, String)> = lines("errata.txt")
        .iter()
        .map(|fields| (key(fields), (fields[4].clone(), fields[5].clone())))
        .collect();
    assert_eq!(errata.len(), 4);
    assert_eq!(differences, errata);
}
