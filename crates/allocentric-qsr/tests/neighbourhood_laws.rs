//! Conceptual neighbourhoods: what follows what while a point moves.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod systems;

use allocentric_qsr::{DepthReference, DepthSet, Orientation, OrientationSet};
use proptest::prelude::*;
use systems::systems;

#[test]
fn the_nine_labels_have_the_neighbours_of_the_picture() {
    let of = |label| Orientation::named(label).unwrap().neighbours().labels();
    assert_eq!(of("fl"), ["sf", "l", "n"]);
    assert_eq!(of("sf"), ["fl", "fr", "n"]);
    assert_eq!(of("br"), ["n", "r", "sb"]);
    assert_eq!(of("n"), ["fl", "sf", "fr", "l", "r", "bl", "sb", "br"]);
}

#[test]
fn neighbours_are_mutual_and_share_the_symmetries() {
    for a in Orientation::ALL {
        assert!(!a.neighbours().contains(a));
        assert_eq!(a.neighbours().converse(), a.converse().neighbours());
        assert_eq!(a.neighbours().mirrored(), a.mirrored().neighbours());
        for b in Orientation::ALL {
            assert_eq!(a.neighbours().contains(b), b.neighbours().contains(a));
        }
    }
    let reference = DepthReference::robot_120();
    let close = reference.class_named("c").unwrap();
    assert_eq!(reference.labels(reference.neighbours(close)), ["vc", "n"]);
    assert_eq!(
        reference.labels(reference.neighbourhood(close.into())),
        ["vc", "c", "n"]
    );
    assert_eq!(reference.neighbourhood(DepthSet::EMPTY), DepthSet::EMPTY);
}

proptest! {
    /// A point that moves in steps so small that no sign jumps over zero passes from label to
    /// neighbour only. On whole numbers a step of one along one axis at a time is such a step, and
    /// so is a step along both that ends on both axes.
    #[test]
    fn motion_passes_through_neighbours(start in (-3i32..4, -3i32..4), steps in proptest::collection::vec(0usize..4, 1..40)) {
        let (mut ahead, mut leftward) = start;
        let mut label = Orientation::of_offset(ahead, leftward);
        for step in steps {
            let (a, l) = [(1, 0), (-1, 0), (0, 1), (0, -1)][step];
            (ahead, leftward) = (ahead + a, leftward + l);
            let next = Orientation::of_offset(ahead, leftward);
            prop_assert!(next == label || label.neighbours().contains(next));
            prop_assert!(OrientationSet::from(label).neighbourhood().contains(next));
            label = next;
        }
    }

    /// A distance that grows without jumps goes from class to class.
    #[test]
    fn growing_passes_through_neighbours(reference in systems(300)) {
        let mut class = reference.qualify_mm(0);
        for mm in 1..400 {
            let next = reference.qualify_mm(mm);
            prop_assert!(next == class || reference.neighbours(class).contains(next));
            class = next;
        }
        prop_assert_eq!(class, reference.last());
    }
}
