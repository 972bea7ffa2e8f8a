//! Laws of the published composition, for every reference system.

mod systems;

use allocentric_qsr::{
    BaseRelation, Case, Depth, DepthReference, DepthSet, Mode, compose, compose_over_base,
};
use proptest::prelude::*;
use systems::systems;

fn cell(reference: &DepthReference, case: Case, first: Depth, second: Depth) -> DepthSet {
    let composed = compose(
        reference,
        case,
        Mode::Published,
        first.into(),
        second.into(),
    );
    assert_eq!(composed.mode, Mode::Published);
    composed.depth
}

fn pairs(reference: &DepthReference) -> Vec<(Depth, Depth)> {
    let all = reference.all();
    all.iter()
        .flat_map(|i| all.iter().map(move |j| (i, j)))
        .collect()
}

proptest! {
    /// The third side does not care which of the other two comes first.
    #[test]
    fn composition_is_symmetric(reference in systems(3000)) {
        for (i, j) in pairs(&reference) {
            for case in [Case::One, Case::Two, Case::Three, Case::Four] {
                prop_assert_eq!(cell(&reference, case, i, j), cell(&reference, case, j, i));
            }
        }
    }

    /// The last class takes in every other, and with itself gives everything in CASE 1.
    #[test]
    fn the_last_class_absorbs(reference in systems(3000)) {
        let last = reference.last();
        for i in reference.all().iter() {
            let sum = cell(&reference, Case::One, i, last);
            prop_assert_eq!(sum, if i == last { reference.all() } else { last.into() });
            prop_assert_eq!(cell(&reference, Case::Three, i, last), last.into());
        }
    }

    /// Below the last class, CASE 1 is an unbroken run whose ends are the classes of the least
    /// difference and of the largest sum, and CASE 2 and 3 give one class of that run.
    #[test]
    fn below_the_last_class_the_bounds_are_difference_and_sum(reference in systems(3000)) {
        let last = reference.last();
        let low = |depth: Depth| u64::from(reference.classes()[depth.index()].from_mm);
        let high = |depth: Depth| u64::from(reference.classes()[depth.index() + 1].from_mm);
        for (i, j) in pairs(&reference).into_iter().filter(|&(i, j)| i != last && j != last) {
            let sum = cell(&reference, Case::One, i, j);
            let gap = low(i).max(low(j)).saturating_sub(high(i).min(high(j)));
            let ends = (sum.iter().min().unwrap(), sum.iter().max().unwrap());
            prop_assert_eq!(ends.0, reference.qualify_mm(gap));
            prop_assert_eq!(ends.1, reference.qualify_mm(high(i) + high(j)));
            prop_assert_eq!(sum, DepthSet::run(ends.0, ends.1));
            let difference = cell(&reference, Case::Two, i, j);
            prop_assert_eq!(difference, cell(&reference, Case::Three, i, j));
            prop_assert_eq!(difference.len(), 1);
            prop_assert!(difference.is_subset(sum));
        }
    }

    /// A finer system says at least as much, as long as no class is last in the coarser one:
    /// there absorption speaks, and two systems absorb at different distances.
    #[test]
    fn a_finer_system_says_no_less(
        bounds in proptest::collection::btree_set(1u32..3000, 1..8),
        keep in proptest::collection::vec(any::<bool>(), 8),
    ) {
        let fine = systems::system(bounds.iter().copied());
        let kept = bounds.iter().zip(&keep).filter(|(_, keep)| **keep).map(|(b, _)| *b);
        let coarse = systems::system(kept);
        let coarser = fine.coarsening(&coarse).unwrap();
        let coarsen = |set: DepthSet| set.iter().map(|d| coarser[d.index()]).collect::<DepthSet>();
        for (i, j) in pairs(&fine) {
            let (wide_i, wide_j) = (coarser[i.index()], coarser[j.index()]);
            if wide_i != coarse.last() && wide_j != coarse.last() {
                let narrow = coarsen(cell(&fine, Case::One, i, j));
                prop_assert!(narrow.is_subset(cell(&coarse, Case::One, wide_i, wide_j)));
            }
        }
    }

    /// Sets compose member by member: a larger premise never says more, and nothing gives
    /// nothing.
    #[test]
    fn composition_is_monotone(reference in systems(3000), bits in any::<[u8; 4]>()) {
        let set = |bits: u8| {
            reference.all().iter().filter(|d| bits >> d.index() & 1 == 1).collect::<DepthSet>()
        };
        let (first, second) = (set(bits[0]), set(bits[1]));
        let (wider, second_wider) = (first | set(bits[2]), second | set(bits[3]));
        for mode in [Mode::Published, Mode::Sound] {
            for case in [Case::One, Case::Two, Case::Three, Case::Four] {
                let narrow = compose(&reference, case, mode, first, second).depth;
                let wide = compose(&reference, case, mode, wider, second_wider).depth;
                prop_assert!(narrow.is_subset(wide));
                let nothing = compose(&reference, case, mode, first, DepthSet::EMPTY).depth;
                prop_assert!(nothing.is_empty());
            }
        }
    }

    /// CASE 4 says nothing of any two classes, and something over a known base.
    #[test]
    fn case_4_needs_a_base(reference in systems(3000)) {
        for (i, j) in pairs(&reference) {
            prop_assert_eq!(cell(&reference, Case::Four, i, j), reference.all());
            for base in reference.all().iter() {
                let given = [base, i, j].map(DepthSet::from);
                let over = compose_over_base(
                    &reference, Mode::Published, given[0], given[1], given[2],
                );
                // Three single-class steps leave a single class.
                prop_assert_eq!(over.depth.len(), 1);
            }
        }
    }
}

/// Where the paper is not sound: the two examples of the design hold in numbers.
#[test]
fn the_published_answers_leave_out_what_is_true() {
    let fine = DepthReference::drs2();
    let class = |cm: f64| fine.qualify(cm / 100.0).unwrap();
    // 119 cm and 121 cm in opposite directions end 2 cm apart.
    let opposite = cell(&fine, Case::One, class(119.0), class(121.0));
    assert_eq!(fine.labels(opposite), ["fd"]);
    assert!(!opposite.contains(class(2.0)));
    // 41 cm and 28 cm in one direction end 13 cm apart.
    let same = cell(&fine, Case::Three, class(41.0), class(28.0));
    assert_eq!(fine.labels(same), ["ct"]);
    assert!(!same.contains(class(13.0)));
    for (case, first, second, third) in [
        (Case::One, 119.0, 121.0, 2.0),
        (Case::Three, 41.0, 28.0, 13.0),
    ] {
        let (first, second) = (class(first).into(), class(second).into());
        let sound = compose(&fine, case, Mode::Sound, first, second).depth;
        assert!(sound.contains(class(third)));
    }
}
