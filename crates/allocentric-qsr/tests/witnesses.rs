//! Every combination the triangle table claims is met by three points with whole coordinates.
//!
//! The witnesses are stored, not searched for in the suite: a stored point is a certificate that a
//! page of integer arithmetic checks and that owes nothing to the search, which may round as it
//! likes. Coordinates are whole micrometres, 1/1000 of the unit of the bounds, because an extreme
//! of the third side is approached and never attained: next to it a coarser grid has no point.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod systems;
mod witness;

use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::PathBuf;

use allocentric_qsr::{BaseRelation, Depth, DepthReference, Orientation};
use proptest::prelude::*;
use systems::{presets, system, systems};
use witness::{Claim, Witness, claim_of, claims, search};

fn file(reference: &DepthReference) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/witnesses");
    folder.join(format!("{}.txt", reference.name()))
}

fn key((i, j, p, psi, k): Claim) -> [usize; 5] {
    [i.index(), j.index(), p.index(), psi.index(), k.index()]
}

fn line(reference: &DepthReference, (i, j, p, psi, k): Claim, witness: Witness) -> String {
    let [i, j, k] = [i, j, k].map(|class: Depth| reference.short(class));
    let Witness { c, d: (u, v) } = witness;
    format!("{i} {j} {} {} {k}  {c}  {u} {v}", p.short(), psi.short())
}

fn read(reference: &DepthReference, line: &str) -> (Claim, Witness) {
    let words: Vec<&str> = line.split_whitespace().collect();
    let class = |at: usize| reference.class_named(words[at]).unwrap();
    let label = |at: usize| Orientation::named(words[at]).unwrap();
    let number = |at: usize| words[at].parse().unwrap();
    let witness = Witness {
        c: number(5),
        d: (number(6), number(7)),
    };
    ((class(0), class(1), label(2), label(3), class(4)), witness)
}

#[test]
fn every_claim_has_a_stored_integer_witness() {
    for reference in presets() {
        let text = std::fs::read_to_string(file(&reference)).unwrap();
        let mut witnessed = BTreeSet::new();
        for line in text.lines().filter(|line| !line.starts_with('#')) {
            let (claim, witness) = read(&reference, line);
            assert_eq!(claim_of(&reference, witness), Some(claim), "{line}");
            assert!(witnessed.insert(key(claim)), "twice: {line}");
        }
        let claimed: BTreeSet<[usize; 5]> = claims(&reference).into_iter().map(key).collect();
        assert_eq!(witnessed, claimed, "{}", reference.name());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// What holds of the paper's systems holds of any: no claim is without its three points.
    #[test]
    fn every_claim_of_any_system_has_a_witness(reference in systems(1500)) {
        for claim in claims(&reference) {
            prop_assert!(is_witnessed(&reference, claim), "{:?}", claim);
        }
    }
}

/// Whether three points meet a claim, in whole micrometres or else in whole nanometres: where a side
/// of less than a millimetre meets one of many, what is left between an extreme of the third side and
/// a bound is narrower than a micrometre.
fn is_witnessed(reference: &DepthReference, claim: Claim) -> bool {
    let bounds = reference.classes().iter().skip(1);
    let finer = || system(bounds.map(|class| 1000 * class.from_mm));
    search(reference, claim).is_some() || search(&finer(), claim).is_some()
}

/// A side of less than 1 mm behind one of less than 250 mm reaches 250 mm by two micrometres.
#[test]
fn a_narrow_claim_is_met_by_nanometres() {
    let reference = system([1, 250]);
    let narrow = (
        Depth::of_index(1),
        Depth::of_index(0),
        Orientation::BackLeft,
        Orientation::FrontLeft,
        Depth::of_index(2),
    );
    assert!(claims(&reference).contains(&narrow));
    assert!(search(&reference, narrow).is_none() && is_witnessed(&reference, narrow));
}

/// Writes the witnesses anew: `cargo test -p allocentric-qsr --test witnesses -- --ignored`.
#[test]
#[ignore = "it writes the files that the other tests read"]
fn write_the_witnesses() {
    for reference in presets() {
        let mut text = String::from(
            "# |bc| |cd| label-of-d-at-c label-of-d-at-b |bd|  c  d: b = (0, 0), c = (c, 0), in um\n",
        );
        for claim in claims(&reference) {
            let witness = search(&reference, claim)
                .unwrap_or_else(|| panic!("{}: no witness for {claim:?}", reference.name()));
            writeln!(text, "{}", line(&reference, claim, witness)).unwrap();
        }
        std::fs::write(file(&reference), text).unwrap();
    }
}
