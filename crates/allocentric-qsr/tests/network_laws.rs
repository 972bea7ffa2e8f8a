//! Laws of the closure: it agrees with a slow, obvious twin, narrows only, does not care about
//! order, and every step it tells can be checked.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod systems;

use allocentric_qsr::{
    BaseRelation, Because, Case, Closure, ConstraintNetwork, DepthReference, DepthSet,
    DistanceFact, Explanation, FactSource, GqrCalculus, Mode, NotAFact, ObjectId, Statement, Step,
    compose,
};
use proptest::prelude::*;
use systems::{system, systems};

fn name(k: usize) -> ObjectId {
    // Ten and more sort as numbers do.
    ObjectId::new(format!("o{k:03}"))
}

fn network(reference: &DepthReference, count: usize) -> ConstraintNetwork {
    ConstraintNetwork::new(reference, (0..count).map(name))
}

fn fact(i: usize, j: usize, depth: DepthSet) -> DistanceFact {
    DistanceFact {
        between: [name(i), name(j)],
        depth,
        source: FactSource::Told(format!("{i} {j}")),
    }
}

/// Facts of random pairs, any set of classes: small ones contradict each other soon.
fn facts(
    reference: &DepthReference,
    count: usize,
    told: &[(usize, usize, u32)],
) -> Vec<DistanceFact> {
    let set = |bits: u32| -> DepthSet {
        let some: DepthSet = reference
            .all()
            .iter()
            .filter(|d| bits >> d.index() & 1 == 1)
            .collect();
        if some.is_empty() {
            reference.all()
        } else {
            some
        }
    };
    told.iter()
        .map(|&(i, j, bits)| (i % count, j % count, bits))
        .filter(|(i, j, _)| i != j)
        .map(|(i, j, bits)| fact(i, j, set(bits)))
        .collect()
}

/// The naive closure: every triple again and again, until nothing changes.
fn naive(
    reference: &DepthReference,
    count: usize,
    facts: &[DistanceFact],
) -> Option<Vec<Vec<DepthSet>>> {
    let place = |o: &ObjectId| o.as_str()[1..].parse::<usize>().unwrap();
    let mut sets = vec![vec![reference.all(); count]; count];
    for fact in facts {
        let (i, j) = (place(&fact.between[0]), place(&fact.between[1]));
        sets[i][j] &= fact.depth;
        sets[j][i] = sets[i][j];
    }
    loop {
        let before = sets.clone();
        for i in 0..count {
            for j in (0..count).filter(|&j| j != i) {
                for k in (0..count).filter(|&k| k != i && k != j) {
                    let sum = compose(reference, Case::One, Mode::Sound, sets[i][k], sets[k][j]);
                    sets[i][j] &= sum.depth;
                    sets[j][i] = sets[i][j];
                }
                if sets[i][j].is_empty() {
                    return None;
                }
            }
        }
        if sets == before {
            return Some(sets);
        }
    }
}

/// What a step says of a distance.
fn distance(step: &Step) -> (&[ObjectId; 2], &[String]) {
    match &step.statement {
        Statement::Distance { between, depth } => (between, depth),
        Statement::Direction { .. } => panic!("only distances were told"),
    }
}

/// Checks every step of an explanation from its premises, with the public composition.
fn follows(reference: &DepthReference, explanation: &Explanation, facts: &[DistanceFact]) {
    let set = |labels: &[String]| -> DepthSet {
        labels
            .iter()
            .map(|label| reference.class_named(label).unwrap())
            .collect()
    };
    let pair = |[a, b]: &[ObjectId; 2]| {
        if a < b {
            [a.clone(), b.clone()]
        } else {
            [b.clone(), a.clone()]
        }
    };
    for (at, step) in explanation.steps.iter().enumerate() {
        let earlier = |premise: usize| {
            assert!(premise < at, "a premise comes before what follows from it");
            distance(&explanation.steps[premise])
        };
        let (between, depth) = distance(step);
        let depth = set(depth);
        match &step.because {
            Because::Unknown => assert_eq!(depth, reference.all()),
            Because::Told { fact } => assert!(facts.iter().any(|f| {
                f.source == FactSource::Told(fact.clone())
                    && pair(&f.between) == pair(between)
                    && f.depth == depth
            })),
            Because::Measured { .. } | Because::Joined { .. } | Because::Directed { .. } => {
                panic!("only distances were told")
            }
            Because::Composed { through, premises } => {
                let [a, b] = premises.map(earlier);
                assert_eq!(pair(a.0), pair(&[between[0].clone(), through.clone()]));
                assert_eq!(pair(b.0), pair(&[through.clone(), between[1].clone()]));
                let sum = compose(reference, Case::One, Mode::Sound, set(a.1), set(b.1));
                assert_eq!(sum.depth, depth);
            }
            Because::Both { premises } => {
                let [a, b] = premises.map(earlier);
                assert_eq!(pair(a.0), pair(between));
                assert_eq!(pair(b.0), pair(between));
                assert_eq!(set(a.1) & set(b.1), depth);
            }
        }
    }
}

/// Everything the laws say about one list of facts.
fn obeys(reference: &DepthReference, count: usize, facts: &[DistanceFact]) {
    let mut full = network(reference, count);
    let closure = full.constrain(facts.to_vec()).unwrap();
    let twin = naive(reference, count, facts);
    match (&closure, &twin) {
        (Closure::Inconsistent(proof), None) => {
            follows(reference, proof, facts);
            assert!(proof.conclusion().unwrap().statement.is_impossible());
            // What is refused leaves nothing behind.
            assert_eq!(full.depth(&name(0), &name(1)), Some(reference.all()));
            assert!(full.facts().is_empty());
        }
        (Closure::NotRefuted { narrowed }, Some(sets)) => {
            let mut changed = 0;
            for i in 0..count {
                for j in (0..count).filter(|&j| j != i) {
                    let set = full.depth(&name(i), &name(j)).unwrap();
                    assert_eq!(set, sets[i][j], "{i} {j}");
                    changed += usize::from(i < j && set != reference.all());
                }
            }
            assert_eq!(*narrowed, changed);
            // Closing again narrows nothing.
            let again = full.constrain(facts.to_vec()).unwrap();
            assert_eq!(again, Closure::NotRefuted { narrowed: 0 });
            let pairs = (0..count.min(4)).flat_map(|i| (i + 1..count.min(6)).map(move |j| (i, j)));
            for (i, j) in pairs {
                let why = full.explain(&name(i), &name(j)).unwrap();
                follows(reference, &why, facts);
                let last = why.conclusion().unwrap();
                let (between, depth) = distance(last);
                assert_eq!(*between, [name(i), name(j)]);
                assert_eq!(depth, reference.labels(sets[i][j]));
            }
        }
        _ => panic!("{closure:?} where the twin has {twin:?}"),
    }
    // One at a time, in the other order: the same network, or refused somewhere.
    let mut slow = network(reference, count);
    let mut refused = false;
    for fact in facts.iter().rev().cloned() {
        let before = slow.clone();
        if let Closure::Inconsistent(_) = slow.constrain([fact]).unwrap() {
            refused = true;
            for i in 0..count {
                for j in 0..count {
                    assert_eq!(
                        slow.depth(&name(i), &name(j)),
                        before.depth(&name(i), &name(j))
                    );
                }
            }
            break;
        }
    }
    assert_eq!(refused, twin.is_none());
    if let Some(sets) = twin {
        for (i, row) in sets.iter().enumerate() {
            for (j, &set) in row.iter().enumerate().filter(|&(j, _)| j != i) {
                assert_eq!(slow.depth(&name(i), &name(j)), Some(set));
            }
        }
        let pair = (name(0), name(count - 1));
        assert_eq!(
            slow.explain(&pair.0, &pair.1),
            full.explain(&pair.0, &pair.1)
        );
    }
}

proptest! {
    // With the cases of the next law more than 200 networks.
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// The queue, one fact at a time or all at once, and the naive loop come to one network.
    #[test]
    fn the_twins_agree(
        reference in systems(1500), count in 2usize..14,
        told in proptest::collection::vec((0usize..100, 0usize..100, any::<u32>()), 0..60),
    ) {
        obeys(&reference, count, &facts(&reference, count, &told));
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// The same beyond eight classes, where a set no longer fits a byte.
    #[test]
    fn the_twins_agree_on_many_classes(
        bounds in proptest::collection::btree_set(1u32..4000, 8..31), count in 2usize..9,
        told in proptest::collection::vec((0usize..100, 0usize..100, any::<u32>()), 0..30),
    ) {
        let reference = system(bounds);
        obeys(&reference, count, &facts(&reference, count, &told));
    }

    /// Distances between true points are never refuted, and stay in their sets.
    #[test]
    fn the_truth_is_never_refuted(
        reference in systems(1500),
        points in proptest::collection::vec((-900i64..900, -900i64..900), 2..12),
        told in proptest::collection::vec((0usize..100, 0usize..100, any::<u32>()), 0..60),
    ) {
        let class = |i: usize, j: usize| {
            let (a, b): ((i64, i64), (i64, i64)) = (points[i], points[j]);
            reference.qualify_mm((((a.0 - b.0).pow(2) + (a.1 - b.1).pow(2)) as u64).isqrt())
        };
        let place = |o: &ObjectId| o.as_str()[1..].parse::<usize>().unwrap();
        let mut network = network(&reference, points.len());
        let facts = facts(&reference, points.len(), &told).into_iter().map(|mut fact| {
            fact.depth |= class(place(&fact.between[0]), place(&fact.between[1])).into();
            fact
        });
        let closure = network.constrain(facts).unwrap();
        let refuted = matches!(closure, Closure::Inconsistent(_));
        prop_assert!(!refuted);
        for i in 0..points.len() {
            for j in (0..points.len()).filter(|&j| j != i) {
                prop_assert!(network.depth(&name(i), &name(j)).unwrap().contains(class(i, j)));
            }
        }
    }
}

#[test]
fn a_contradiction_is_told_as_a_tree() {
    let reference = DepthReference::robot_120();
    let class = |label| DepthSet::from(reference.class_named(label).unwrap());
    let mut network = network(&reference, 4);
    let told = [(0, 1, "vc"), (1, 2, "vc"), (2, 3, "vc")];
    for (i, j, label) in told {
        network.constrain([fact(i, j, class(label))]).unwrap();
    }
    let closure = network.constrain([fact(0, 3, class("vf"))]).unwrap();
    let Closure::Inconsistent(proof) = closure else {
        panic!("three steps of 60 cm do not make 250 cm");
    };
    let expected = "\
o000 - o002: nothing is left, both of
  o000 - o002: {vc, c, n}, through o001
    o000 - o001: {vc}, told: 0 1
    o001 - o002: {vc}, told: 1 2
  o000 - o002: {f, vf}, through o003
    o000 - o003: {vf}, told: 0 3
    o002 - o003: {vc}, told: 2 3
";
    let shown = proof.to_string();
    assert_eq!(shown, expected);
    let json = serde_json::to_string(&proof).unwrap();
    assert_eq!(serde_json::from_str::<Explanation>(&json).unwrap(), proof);
    assert!(
        json.contains(r#""because":{"by":"told","fact":"0 1"}"#),
        "{json}"
    );
    // Retracting one of the premises lets the refused fact in.
    let mut without = network.without(|fact| fact.source == FactSource::Told("1 2".into()));
    let closure = without.constrain([fact(0, 3, class("vf"))]).unwrap();
    assert!(matches!(closure, Closure::NotRefuted { .. }));
}

/// Not refuted is not consistent: of the six distances of four points in the plane the longest is
/// at least 1.41 times the shortest, yet every three of these may be 100 to 120 cm apart.
#[test]
fn four_points_can_be_impossible_and_not_refuted() {
    let reference = DepthReference::robot_120();
    let nearby = DepthSet::from(reference.class_named("n").unwrap());
    let pairs = (0..4).flat_map(|i| (i + 1..4).map(move |j| (i, j)));
    let mut network = network(&reference, 4);
    let closure = network.constrain(pairs.map(|(i, j)| fact(i, j, nearby)));
    assert_eq!(closure, Ok(Closure::NotRefuted { narrowed: 6 }));
}

#[test]
fn what_is_no_fact_is_refused() {
    let reference = DepthReference::drs1();
    let mut network = network(&reference, 2);
    let mut refuse = |fact| network.constrain([fact]).unwrap_err();
    assert_eq!(
        refuse(fact(0, 7, reference.all())),
        NotAFact::Unknown(name(7))
    );
    assert_eq!(
        refuse(fact(1, 1, reference.all())),
        NotAFact::Itself(name(1))
    );
    let none = NotAFact::Classes(name(0), name(1));
    assert_eq!(refuse(fact(0, 1, DepthSet::EMPTY)), none);
    assert_eq!(refuse(fact(0, 1, DepthReference::drs2().all())), none);
}

#[test]
fn gqr_reads_this() {
    let reference = DepthReference::drs1();
    let files = GqrCalculus::of(&reference);
    assert!(
        files.spec.ends_with("identity =\ncalculus_size 4\n"),
        "{}",
        files.spec
    );
    assert_eq!(files.converse, "= :: =\nc :: c\nn :: n\nf :: f\n");
    let composition = "\
= : = :: ( = )
= : c :: ( c )
= : n :: ( n )
= : f :: ( f )
c : = :: ( c )
c : c :: ( = c n f )
c : n :: ( c n f )
c : f :: ( c n f )
n : = :: ( n )
n : c :: ( c n f )
n : n :: ( = c n f )
n : f :: ( c n f )
f : = :: ( f )
f : c :: ( c n f )
f : n :: ( c n f )
f : f :: ( = c n f )
";
    assert_eq!(files.composition, composition);
    let mut network = network(&reference, 3);
    let class = |label| DepthSet::from(reference.class_named(label).unwrap());
    network
        .constrain([fact(0, 1, class("c") | class("n")), fact(2, 1, class("f"))])
        .unwrap();
    assert_eq!(
        network.to_gqr(),
        "2 # drs1 distances\n0 1 ( = c n )\n2 1 ( f )\n.\n"
    );
}
