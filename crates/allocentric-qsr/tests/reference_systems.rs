//! Reference systems: what divides the distances, and what does not.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod systems;

use allocentric_qsr::{BadReference, BaseRelation, DepthClass, DepthReference};
use proptest::prelude::*;
use systems::{presets, systems};

fn class(short: &str, name: &str, from_mm: u32) -> DepthClass {
    DepthClass {
        short: short.into(),
        name: name.into(),
        from_mm,
    }
}

#[test]
fn presets_are_the_papers() {
    let robot = DepthReference::robot_150();
    let bounds: Vec<u32> = robot.classes().iter().map(|c| c.from_mm).collect();
    assert_eq!(bounds, [0, 600, 1000, 1500, 2500]);
    assert_eq!(robot.labels(robot.all()), ["vc", "c", "n", "f", "vf"]);
    assert_eq!(DepthReference::robot_120().classes()[3].from_mm, 1200);
    assert_eq!(
        DepthReference::drs2().name_of(DepthReference::drs2().last()),
        "further_than_double"
    );
    assert_eq!(DepthReference::preset("drs3"), None);
    for reference in presets() {
        assert_eq!(DepthReference::preset(reference.name()), Some(reference));
    }
}

#[test]
fn bounds_belong_to_the_class_they_begin() {
    // The literal of a bound is the bound, whatever its decimals do in binary.
    for reference in presets() {
        for (k, class) in reference.classes().iter().enumerate() {
            let bound_m: f64 = format!("{}e-3", class.from_mm).parse().unwrap();
            assert_eq!(reference.qualify(bound_m).unwrap().index(), k);
            if k > 0 {
                assert_eq!(
                    reference.qualify(bound_m.next_down()).unwrap().index(),
                    k - 1
                );
            }
        }
        assert_eq!(reference.qualify(f64::INFINITY), Ok(reference.last()));
        assert!(reference.qualify(-0.1).is_err());
        assert!(reference.qualify(f64::NAN).is_err());
    }
}

#[test]
fn classes_that_divide_nothing_are_refused() {
    let new = |classes: Vec<DepthClass>| DepthReference::new("x", classes).unwrap_err();
    assert_eq!(new(vec![]), BadReference::Empty);
    assert_eq!(new(vec![class("a", "a", 5)]), BadReference::First(5));
    let order = new(vec![
        class("a", "a", 0),
        class("b", "b", 9),
        class("c", "c", 9),
    ]);
    assert!(matches!(
        order,
        BadReference::Order {
            from_mm: 9,
            before_mm: 9,
            ..
        }
    ));
    let twice = new(vec![class("a", "near", 0), class("a", "far", 9)]);
    assert_eq!(twice, BadReference::Label("a".into()));
    let blank = new(vec![class("a b", "near", 0)]);
    assert_eq!(blank, BadReference::Label("a b".into()));
    let many = (0..33)
        .map(|k| class(&format!("k{k}"), &format!("n{k}"), k))
        .collect();
    assert_eq!(new(many), BadReference::TooMany(33));
    for text in [
        "",
        "name = 3",
        "name = 'x'\nclass = []",
        "name = 'x'\nbounds = [0]\nclass = []",
    ] {
        assert!(DepthReference::from_toml(text).is_err(), "{text}");
    }
}

#[test]
fn the_fine_system_refines_the_coarse() {
    let (fine, coarse) = (DepthReference::drs2(), DepthReference::drs1());
    let coarser = fine.coarsening(&coarse).unwrap();
    let labels: Vec<&str> = coarser.iter().map(|&d| coarse.short(d)).collect();
    assert_eq!(labels, ["c", "c", "c", "n", "f", "f", "f"]);
    assert_eq!(coarse.coarsening(&fine), None);
}

proptest! {
    /// A system written as TOML or JSON is read as the same system.
    #[test]
    fn a_system_outlives_its_text(reference in systems(5000)) {
        let text = toml::to_string(&reference).unwrap();
        prop_assert_eq!(&DepthReference::from_toml(&text).unwrap(), &reference);
        let json = serde_json::to_string(&reference).unwrap();
        prop_assert_eq!(&serde_json::from_str::<DepthReference>(&json).unwrap(), &reference);
    }

    /// Every distance has one class, and the classes ascend with it.
    #[test]
    fn classes_ascend(reference in systems(5000), near in 0.0..6.0f64, more in 0.0..6.0f64) {
        let (first, second) = (reference.qualify(near).unwrap(), reference.qualify(near + more).unwrap());
        prop_assert!(first <= second);
    }

    /// No text makes the reader panic.
    #[test]
    fn any_text_is_read_or_refused(text in ".{0,200}") {
        let _ = DepthReference::from_toml(&text);
    }
}
