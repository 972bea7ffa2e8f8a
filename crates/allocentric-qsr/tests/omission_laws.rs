//! Where the published calculus leaves out what is true, the numbers say so.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod systems;

use std::collections::BTreeMap;

use allocentric_qsr::{Case, DepthReference, Mode, Omission, compose, omissions};
use proptest::prelude::*;
use systems::{presets, systems};

const CASES: [Case; 4] = [Case::One, Case::Two, Case::Three, Case::Four];

/// Every witness is a triangle, in exact integers, whose third side the published cell denies;
/// and every class the two calculi part on has one.
fn holds(reference: &DepthReference, case: Case) -> Result<(), String> {
    let found = omissions(reference, case);
    let by_cell: BTreeMap<(String, String), &Omission> = found
        .iter()
        .map(|o| ((o.first.clone(), o.second.clone()), o))
        .collect();
    for i in reference.all().iter() {
        for j in reference.all().iter() {
            let cell = |mode| compose(reference, case, mode, i.into(), j.into()).depth;
            let left_out = cell(Mode::Sound)
                .iter()
                .filter(|&k| !cell(Mode::Published).contains(k));
            let left_out: Vec<&str> = left_out.map(|k| reference.short(k)).collect();
            let key = (reference.short(i).to_owned(), reference.short(j).to_owned());
            let witnesses = by_cell.get(&key).map_or(&[][..], |o| &o.witnesses);
            let witnessed: Vec<&str> = witnesses.iter().map(|w| w.class.as_str()).collect();
            if witnessed != left_out {
                return Err(format!("{key:?}: {witnessed:?} for {left_out:?}"));
            }
            for w in witnesses {
                let (x, y, r) = (w.first_um, w.second_um, w.third_um);
                let class = |um: u64| reference.qualify_mm(um / 1000);
                let real = x <= y + r && y <= x + r && r <= x + y;
                let is = [class(x), class(y)] == [i, j] && reference.short(class(r)) == w.class;
                if !(real && is) {
                    return Err(format!("{w:?} does not witness {key:?}"));
                }
            }
        }
    }
    Ok(())
}

#[test]
fn every_difference_of_the_presets_has_a_witness() {
    for reference in presets() {
        for case in CASES {
            holds(&reference, case).unwrap();
        }
    }
}

#[test]
fn the_fine_table_parts_in_these_cells() {
    let fine = DepthReference::drs2();
    let count = |case| omissions(&fine, case).len();
    // In CASE 1 the last class absorbs the six others from either side; CASE 2 and 3 name one
    // class in each of the 49 cells, and more than one is possible in all of them.
    assert_eq!([Case::One, Case::Two, Case::Four].map(count), [12, 49, 0]);
    let last = omissions(&fine, Case::One).pop().unwrap();
    assert_eq!(
        last.to_string().lines().next().unwrap(),
        "CASE 1: fd, d -> {fd}, but 120 cm and 118 cm on one line, overlapping, leave 2 cm (ch)"
    );
    let json = serde_json::to_value(&last).unwrap();
    assert_eq!(json["witnesses"][0]["class"], "ch");
    assert_eq!(json["published"], serde_json::json!(["fd"]));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn every_difference_of_any_system_has_a_witness(reference in systems(1500)) {
        for case in CASES {
            prop_assert_eq!(holds(&reference, case), Ok(()));
        }
    }
}
