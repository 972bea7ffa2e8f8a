//! Laws of the inference: it ends, narrows only, and does not care about order.
#![allow(clippy::unwrap_used, reason = "what a law sets up by hand exists")]

mod systems;

use std::f64::consts::FRAC_PI_2;

use allocentric_qsr::{
    Case, DepthReference, Inference, Mode, ObjectId, QualitativeScene, Reason, Sighting, compose,
};
use proptest::prelude::*;
use systems::systems;

fn sighting(object: &str, distance_m: f64, bearing_rad: f64) -> Sighting {
    Sighting {
        object: object.into(),
        distance_m,
        bearing_rad,
        sigma_distance_m: 0.01,
        sigma_bearing_rad: 0.005,
    }
}

fn sightings() -> impl Strategy<Value = Vec<Sighting>> {
    proptest::collection::vec((0.05..3.0f64, 0.0..3.1f64), 0..7).prop_map(|seen| {
        let name = |k: usize| format!("o{k}");
        seen.into_iter()
            .enumerate()
            .map(|(k, (distance, bearing))| sighting(&name(k), distance, bearing))
            .collect()
    })
}

proptest! {
    /// The order of the sightings makes no difference to either calculus.
    #[test]
    fn order_makes_no_difference(reference in systems(3000), mut seen in sightings()) {
        let scene = |seen: &[Sighting]| QualitativeScene::qualify(seen.to_vec(), &reference).unwrap();
        let first = scene(&seen);
        seen.reverse();
        let second = scene(&seen);
        for mode in [Mode::Published, Mode::Sound] {
            prop_assert_eq!(Inference::of_scene(&first, mode), Inference::of_scene(&second, mode));
        }
    }

    /// The fixpoint is one: CASE 1 through any third object adds nothing, or is in dispute.
    #[test]
    fn nothing_new_comes(reference in systems(3000), seen in sightings()) {
        let scene = QualitativeScene::qualify(seen, &reference).unwrap();
        for mode in [Mode::Published, Mode::Sound] {
            let inference = Inference::of_scene(&scene, mode);
            let names: Vec<ObjectId> = scene.places().map(|place| place.object.clone()).collect();
            let depth = |a: &ObjectId, b: &ObjectId| inference.relation(a, b).unwrap().places.depth;
            for a in &names {
                for b in names.iter().filter(|b| *b != a) {
                    prop_assert_eq!(depth(a, b), depth(b, a));
                    for c in names.iter().filter(|c| *c != a && *c != b) {
                        let sum = compose(&reference, Case::One, mode, depth(a, c), depth(c, b)).depth;
                        let left = sum & depth(a, b);
                        prop_assert!(left == depth(a, b) || left.is_empty());
                        if left.is_empty() {
                            let disputed = inference.disputes().iter().any(|dispute| {
                                dispute.through == *c
                                    && dispute.between.contains(a)
                                    && dispute.between.contains(b)
                            });
                            prop_assert!(disputed);
                        }
                    }
                }
            }
        }
    }
}

/// The published step from the observer to the objects is CASE 3 of their classes.
#[test]
fn the_published_step_is_case_3() {
    let reference = DepthReference::robot_120();
    let seen = [
        sighting("cup", 0.7, FRAC_PI_2),
        sighting("box", 1.1, FRAC_PI_2 + 0.3),
    ];
    let scene = QualitativeScene::qualify(seen, &reference).unwrap();
    let inference = Inference::of_scene(&scene, Mode::Published);
    let relation = inference.relation(&"cup".into(), &"box".into()).unwrap();
    // c and n differ by less than 60 cm.
    assert_eq!(reference.labels(relation.places.depth), ["vc"]);
    assert_eq!(relation.places.orientation.labels(), ["fl", "l", "bl"]);
    assert_eq!(relation.mode, Mode::Published);
    let reason = Reason::Composed {
        look: Some(1),
        through: vec![],
    };
    assert_eq!(relation.reason, reason);
    let back = inference.relation(&"box".into(), &"cup".into()).unwrap();
    assert_eq!(back.places.orientation.labels(), ["fr", "r", "br"]);
}
