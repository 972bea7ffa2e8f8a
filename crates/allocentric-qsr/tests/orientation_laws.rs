//! Laws of the nine orientations.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use allocentric_qsr::{Orientation, OrientationSet};
use proptest::prelude::*;

/// The intervals of Figure 5, in degrees.
#[test]
fn the_bearings_are_those_of_figure_5() {
    let at = |degrees: f64| {
        Orientation::of_bearing(degrees.to_radians())
            .unwrap()
            .short()
    };
    for (degrees, label) in [
        (135.0, "fl"),
        (90.0, "sf"),
        (45.0, "fr"),
        (180.0, "l"),
        (0.0, "r"),
        (225.0, "bl"),
        (270.0, "sb"),
        (315.0, "br"),
        (-90.0, "sb"),
        (360.0, "r"),
        (450.0, "sf"),
        (89.999, "fr"),
        (90.001, "fl"),
    ] {
        assert_eq!(at(degrees), label, "at {degrees} degrees");
    }
    assert!(Orientation::of_bearing(f64::NAN).is_err());
    assert!(OrientationSet::of_arc(1.0, 0.9).is_err());
    assert!(OrientationSet::of_arc(0.0, f64::INFINITY).is_err());
}

#[test]
fn the_order_is_the_papers() {
    let labels = OrientationSet::ALL.labels();
    assert_eq!(labels, ["fl", "sf", "fr", "l", "n", "r", "bl", "sb", "br"]);
    for orientation in Orientation::ALL {
        assert_eq!(Orientation::named(orientation.short()), Some(orientation));
        assert_eq!(Orientation::named(orientation.name()), Some(orientation));
    }
}

/// An error that straddles an axis admits both quadrants; the label to read is chosen apart.
#[test]
fn a_straddled_axis_is_a_set_and_one_label() {
    let set = OrientationSet::of_arc(FRAC_PI_2 - 0.01, FRAC_PI_2 + 0.02).unwrap();
    assert_eq!(set.labels(), ["fl", "sf", "fr"]);
    let read = |bearing| Orientation::read(bearing, 0.1).unwrap();
    assert_eq!(read(FRAC_PI_2 + 0.09), Orientation::StraightFront);
    assert_eq!(read(FRAC_PI_2 + 0.11), Orientation::FrontLeft);
    assert_eq!(read(-0.05), Orientation::Right);
    assert_eq!(read(TAU - 0.05), Orientation::Right);
    assert_eq!(read(-PI), Orientation::Left);
}

#[test]
fn as_data_a_set_is_its_labels() {
    let set = OrientationSet::of_arc(0.1, 2.0).unwrap();
    assert_eq!(serde_json::to_string(&set).unwrap(), r#"["fl","sf","fr"]"#);
    let read: OrientationSet = serde_json::from_str(r#"["fr","fl","sf"]"#).unwrap();
    assert_eq!(read, set);
    assert!(serde_json::from_str::<OrientationSet>(r#"["fr","fr"]"#).is_err());
    assert!(serde_json::from_str::<OrientationSet>(r#"["front"]"#).is_err());
}

proptest! {
    /// Every bearing of an arc has its label in the set of the arc, and every label of the set
    /// has a bearing on the arc.
    #[test]
    fn an_arc_has_the_labels_of_its_bearings(from in -10.0..10.0f64, wide in 0.0..7.0f64) {
        let set = OrientationSet::of_arc(from, from + wide).unwrap();
        let mut met = OrientationSet::EMPTY;
        for step in 0..=2000 {
            let bearing = from + wide * f64::from(step) / 2000.0;
            let label = Orientation::of_bearing(bearing).unwrap();
            prop_assert!(set.contains(label));
            met |= label.into();
        }
        // Sampling meets no ray, but a ray is on the arc where both its quadrants are.
        for (ray, beside) in [("sf", ["fl", "fr"]), ("l", ["fl", "bl"]), ("sb", ["bl", "br"]), ("r", ["br", "fr"])] {
            let named = |label| Orientation::named(label).unwrap();
            if beside.into_iter().all(|label| met.contains(named(label))) {
                met |= named(ray).into();
            }
        }
        // Arcs that end within a step of an axis differ in what samples can meet, and a wide arc
        // may reach both quadrants the other way round.
        let near_axis = |b: f64| (b / FRAC_PI_2 - (b / FRAC_PI_2).round()).abs() < 0.01;
        prop_assume!(!near_axis(from) && !near_axis(from + wide) && wide < PI);
        prop_assert_eq!(set, met);
    }

    /// What bears v to u and u to the front bears v to the front; exact on whole numbers.
    #[test]
    fn turns_add(u in (-4i32..5, -4i32..5), v in (-4i32..5, -4i32..5)) {
        let first = Orientation::of_offset(u.0, u.1);
        let second = Orientation::of_offset(u.0 * v.0 + u.1 * v.1, u.0 * v.1 - u.1 * v.0);
        prop_assume!(first != Orientation::None);
        prop_assert!(first.turned(second).contains(Orientation::of_offset(v.0, v.1)));
    }
}

#[test]
fn converse_and_mirror_are_involutions() {
    for orientation in Orientation::ALL {
        assert_eq!(orientation.converse().converse(), orientation);
        assert_eq!(orientation.mirrored().mirrored(), orientation);
        assert_eq!(
            orientation.converse().mirrored(),
            orientation.mirrored().converse()
        );
    }
    assert_eq!(Orientation::FrontLeft.converse(), Orientation::BackRight);
    assert_eq!(Orientation::FrontLeft.mirrored(), Orientation::FrontRight);
    assert_eq!(Orientation::None.converse(), Orientation::None);
}
