//! Laws of networks of distances and directions together: true points are never refuted and stay in
//! every set and every line of every proof; the order of the facts plays no part; both kinds of facts
//! narrow each other.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod systems;

use allocentric_qsr::{
    Because, Closure, ConstraintNetwork, Depth, DepthReference, DepthSet, DirectionFact,
    DistanceFact, Explanation, FactSource, NotAFact, ObjectId, Orientation, OrientationSet,
    PlaceNetwork, Rule, Statement,
};
use proptest::prelude::*;
use systems::systems;

type Point = (i64, i64);

fn name(k: usize) -> ObjectId {
    ObjectId::new(format!("o{k}"))
}

fn place(object: &ObjectId) -> usize {
    object.as_str()[1..].parse().unwrap()
}

fn class(reference: &DepthReference, a: Point, b: Point) -> Depth {
    let squared = ((a.0 - b.0).pow(2) + (a.1 - b.1).pow(2)) as u64;
    reference.qualify_mm(squared.isqrt())
}

/// The label of `to` at `at`, against the way from `first` to `second`.
fn label(first: Point, second: Point, at: Point, to: Point) -> Orientation {
    let front = (second.0 - first.0, second.1 - first.1);
    let way = (to.0 - at.0, to.1 - at.1);
    Orientation::of_offset(
        front.0 * way.0 + front.1 * way.1,
        front.0 * way.1 - front.1 * way.0,
    )
}

/// A set of labels with the true one, and those that bits name.
fn vague(truth: Orientation, bits: u32) -> OrientationSet {
    let others = Orientation::ALL.into_iter().enumerate();
    let others: OrientationSet = others
        .filter(|(k, _)| bits >> k & 1 == 1)
        .map(|(_, label)| label)
        .collect();
    others | truth.into()
}

/// True facts about points, as vague as their bits say.
fn true_facts(
    reference: &DepthReference,
    points: &[Point],
    distances: &[(usize, usize, u32)],
    directions: &[(usize, usize, usize, u32, u32)],
) -> (Vec<DistanceFact>, Vec<DirectionFact>) {
    let at = |k: usize| k % points.len();
    let distances = distances.iter().filter_map(|&(i, j, bits)| {
        let (i, j) = (at(i), at(j));
        let others: DepthSet = reference
            .all()
            .iter()
            .enumerate()
            .filter(|(k, _)| bits >> k & 1 == 1)
            .map(|(_, class)| class)
            .collect();
        (i != j).then(|| DistanceFact {
            between: [name(i), name(j)],
            depth: others | class(reference, points[i], points[j]).into(),
            source: FactSource::Told(format!("{i} {j}")),
        })
    });
    let directions = directions.iter().filter_map(|&(b, c, d, p, psi)| {
        let (b, c, d) = (at(b), at(c), at(d));
        let (from, to, third) = (points[b], points[c], points[d]);
        (from != to && d != b && d != c).then(|| DirectionFact {
            observer: name(b),
            reference: name(c),
            object: name(d),
            at_reference: vague(label(from, to, to, third), p),
            at_observer: vague(label(from, to, from, third), psi),
            source: FactSource::Told(format!("{b} {c} {d}")),
        })
    });
    (distances.collect(), directions.collect())
}

/// Whether every line of a proof is true of the points, and follows what it names.
fn is_true(reference: &DepthReference, points: &[Point], why: &Explanation) -> Result<(), String> {
    for (at, step) in why.steps.iter().enumerate() {
        let holds = match &step.statement {
            Statement::Distance { between, depth } => {
                let [a, b] = between.each_ref().map(|object| points[place(object)]);
                let truth = reference.short(class(reference, a, b)).to_owned();
                depth.contains(&truth)
            }
            Statement::Direction {
                observer,
                reference: middle,
                object,
                at_reference,
                at_observer,
            } => {
                let [b, c, d] = [observer, middle, object].map(|object| points[place(object)]);
                at_reference.contains(label(b, c, c, d)) && at_observer.contains(label(b, c, b, d))
            }
        };
        let premises: Vec<usize> = match &step.because {
            Because::Composed { premises, .. } | Because::Both { premises } => premises.to_vec(),
            Because::Directed { premises, .. } => premises.clone(),
            _ => Vec::new(),
        };
        if !holds || premises.iter().any(|&premise| premise >= at) {
            return Err(format!("line {at} of\n{why}\n{:?}", step.statement));
        }
    }
    Ok(())
}

fn points() -> impl Strategy<Value = Vec<Point>> {
    // Few values, so that rays, right angles and equal points are common.
    let point = prop_oneof![
        (-4i64..5, -4i64..5).prop_map(|(x, z)| (x * 100, z * 100)),
        (-900i64..900, -900i64..900),
    ];
    proptest::collection::vec(point, 3..7)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// What is true is never refuted, and neither is any line of the reasons.
    #[test]
    fn the_truth_is_never_refuted(
        reference in systems(1500), points in points(),
        distances in proptest::collection::vec((0usize..9, 0usize..9, any::<u32>()), 0..8),
        directions in proptest::collection::vec((0usize..9, 0usize..9, 0usize..9, any::<u32>(), any::<u32>()), 0..7),
    ) {
        // Sharp facts are as likely as vague ones.
        let sharpen = |bits: u32| if bits.is_multiple_of(2) { 0 } else { bits & bits >> 9 };
        let distances: Vec<_> = distances.iter().map(|&(i, j, b)| (i, j, sharpen(b))).collect();
        let directions: Vec<_> =
            directions.iter().map(|&(b, c, d, p, q)| (b, c, d, sharpen(p), sharpen(q))).collect();
        let (distances, directions) = true_facts(&reference, &points, &distances, &directions);
        let count = points.len();
        let mut network = PlaceNetwork::new(&reference, (0..count).map(name));
        let closure = network.constrain(distances.clone(), directions.clone()).unwrap();
        if let Closure::Inconsistent(proof) = &closure {
            prop_assert!(false, "{points:?}\n{proof}");
        }
        for i in 0..count {
            for j in (0..count).filter(|&j| j != i) {
                let truth = class(&reference, points[i], points[j]);
                prop_assert!(network.depth(&name(i), &name(j)).unwrap().contains(truth));
                if let Some(why) = network.explain(&name(i), &name(j)) {
                    prop_assert_eq!(is_true(&reference, &points, &why), Ok(()));
                }
                // Where two points are one, no fact has told a way between them.
                for k in (0..count).filter(|&k| k != i && k != j && points[i] != points[j]) {
                    let places = network.places(&name(i), &name(j), &name(k)).unwrap();
                    let truth = label(points[i], points[j], points[j], points[k]);
                    prop_assert!(places.orientation.contains(truth), "{i} {j} {k} {points:?}");
                    if let Some(why) = network.explain_direction(&name(i), &name(j), &name(k)) {
                        prop_assert_eq!(is_true(&reference, &points, &why), Ok(()));
                    }
                }
            }
        }
        // One fact at a time, backwards: the same network and the same reasons.
        let mut slow = PlaceNetwork::new(&reference, (0..count).map(name));
        for fact in directions.into_iter().rev() {
            slow.constrain([], [fact]).unwrap();
        }
        for fact in distances.iter().rev().cloned() {
            slow.constrain([fact], []).unwrap();
        }
        for i in 0..count {
            for j in 0..count {
                prop_assert_eq!(slow.depth(&name(i), &name(j)), network.depth(&name(i), &name(j)));
                prop_assert_eq!(slow.explain(&name(i), &name(j)), network.explain(&name(i), &name(j)));
            }
        }
        // It says no less than distances alone.
        let mut plain = ConstraintNetwork::new(&reference, (0..count).map(name));
        plain.constrain(distances).unwrap();
        for i in 0..count {
            for j in (0..count).filter(|&j| j != i) {
                let both = network.depth(&name(i), &name(j)).unwrap();
                prop_assert!(both.is_subset(plain.depth(&name(i), &name(j)).unwrap()));
            }
        }
    }
}

fn told(network: &mut PlaceNetwork, reference: &DepthReference, words: &[&str]) -> Closure {
    let (mut distances, mut directions) = (Vec::new(), Vec::new());
    for words in words {
        if let Ok(direction) = DirectionFact::read(words) {
            directions.push(direction);
        } else {
            let fact = allocentric_qsr::ToldFact::read(words, reference).unwrap();
            distances.push(DistanceFact {
                between: fact.between,
                depth: fact.depth,
                source: FactSource::Told((*words).to_owned()),
            });
        }
    }
    network.constrain(distances, directions).unwrap()
}

fn of_names(reference: &DepthReference, names: &[&str]) -> PlaceNetwork {
    PlaceNetwork::new(reference, names.iter().map(|&name| name.into()))
}

/// Distances and a direction tell a distance that neither tells alone, and the proof says so.
#[test]
fn a_right_angle_tells_a_distance() {
    let reference = DepthReference::robot_120();
    let mut network = of_names(&reference, &["door", "cup", "lamp"]);
    let facts = [
        "cup within n of door",
        "lamp within n of cup",
        "lamp l of cup seen from door",
    ];
    let (door, cup, lamp) = ("door".into(), "cup".into(), "lamp".into());
    told(&mut network, &reference, &facts[..2]);
    let depth = |network: &PlaceNetwork| {
        let depth = network.depth(&door, &lamp).unwrap();
        reference.labels(depth).join(" ")
    };
    assert_eq!(depth(&network), "vc c n f");
    told(&mut network, &reference, &facts[2..]);
    assert_eq!(depth(&network), "f");
    let why = network.explain(&door, &lamp).unwrap().to_string();
    for part in [
        "door - lamp: {f}, for no other triangle has",
        "told: lamp l of cup seen from door",
        "told: cup within n of door",
    ] {
        assert!(why.contains(part), "no '{part}' in\n{why}");
    }
    // And the distances tell the direction: nearer than a right angle allows, it lies behind.
    let mut network = of_names(&reference, &["door", "cup", "lamp"]);
    told(&mut network, &reference, &facts[..2]);
    told(
        &mut network,
        &reference,
        &["lamp within vc of door", "lamp left of cup seen from door"],
    );
    let places = network.places(&door, &cup, &lamp).unwrap();
    assert_eq!(places.orientation.labels(), ["bl"]);
    let why = network.explain_direction(&door, &cup, &lamp).unwrap();
    let why_text = why.to_string();
    assert!(why_text.contains("no other triangle"), "{why_text}");
    let json = serde_json::to_string(&why).unwrap();
    assert_eq!(serde_json::from_str::<Explanation>(&json).unwrap(), why);
}

/// Two steps to the left are a turn back, whatever their lengths.
#[test]
fn directions_are_composed_with_directions() {
    let reference = DepthReference::robot_120();
    let mut network = of_names(&reference, &["a", "b", "c", "d"]);
    told(
        &mut network,
        &reference,
        &["c l of b seen from a", "d l of c seen from b"],
    );
    let places = network
        .places(&"a".into(), &"b".into(), &"d".into())
        .unwrap();
    // c is straight to the left of b and d straight back from there: ahead of b is ruled out.
    assert_eq!(places.orientation.labels(), ["bl"]);
    let why = network
        .explain_direction(&"a".into(), &"b".into(), &"d".into())
        .unwrap();
    assert!(why.steps.iter().any(|step| matches!(
        step.because,
        Because::Directed {
            rule: Rule::Chain,
            ..
        }
    )));
}

#[test]
fn a_contradiction_of_directions_is_proved() {
    let reference = DepthReference::robot_120();
    let mut network = of_names(&reference, &["door", "cup", "lamp"]);
    let first = told(
        &mut network,
        &reference,
        &["cup within c of door", "lamp within vc of door"],
    );
    assert!(matches!(first, Closure::NotRefuted { .. }));
    // Beyond the cup is farther than the cup.
    let beyond = told(
        &mut network,
        &reference,
        &["lamp front of cup seen from door"],
    );
    let Closure::Inconsistent(proof) = beyond else {
        panic!("what is beyond the cup is not nearer than it");
    };
    assert!(proof.conclusion().unwrap().statement.is_impossible());
    assert!(
        proof
            .to_string()
            .contains("told: lamp front of cup seen from door")
    );
    // The network stands as it was, and takes what can be.
    let before = told(
        &mut network,
        &reference,
        &["lamp back of cup seen from door"],
    );
    assert!(matches!(before, Closure::NotRefuted { .. }));
}

#[test]
fn what_is_no_direction_is_refused() {
    let reference = DepthReference::robot_120();
    let mut network = of_names(&reference, &["a", "b", "c"]);
    let fact = |observer: &str, reference: &str, object: &str| DirectionFact {
        observer: observer.into(),
        reference: reference.into(),
        object: object.into(),
        at_reference: Orientation::Left.into(),
        at_observer: OrientationSet::ALL,
        source: FactSource::Told(String::new()),
    };
    let mut refused = |fact| network.constrain([], [fact]).unwrap_err();
    assert_eq!(refused(fact("a", "b", "x")), NotAFact::Unknown("x".into()));
    assert_eq!(refused(fact("a", "a", "b")), NotAFact::Itself("a".into()));
    assert_eq!(refused(fact("a", "b", "b")), NotAFact::Itself("b".into()));
    let impossible = DirectionFact {
        at_observer: Orientation::BackRight.into(),
        ..fact("a", "b", "c")
    };
    assert_eq!(
        refused(impossible),
        NotAFact::Labels("c".into(), "b".into())
    );
    for words in [
        "c left of b",
        "c up of b seen from a",
        "c left b seen from a",
    ] {
        assert!(DirectionFact::read(words).is_err(), "{words}");
    }
}
