//! Which places are called singular, and that rows alone are rows alone.
mod dots;
mod texture;

use disparity_pyramid::{MatchParams, Validity, estimate};
use dots::Dots;
use texture::respond;
use v1_gabor::Size;

const SIZE: Size = Size {
    width: 120,
    height: 96,
};

fn params(singularity_tau: f32) -> MatchParams {
    MatchParams {
        singularity_tau: Some(singularity_tau),
        ..MatchParams::default()
    }
}

/// A test so lenient that nothing fails it changes nothing; one so strict that everything fails it
/// leaves no answer, and says that it was not for want of energy.
#[test]
fn the_test_takes_nothing_or_everything() {
    let dots = Dots { seed: 2 };
    let eyes = respond(SIZE, |x, y| dots.at(x, y), |x, y| dots.at(x + 3.0, y));
    let without = estimate(&eyes, MatchParams::default()).expect("one bank");
    assert_eq!(estimate(&eyes, params(1e4)), Ok(without));
    let field = estimate(&eyes, params(1e-6)).expect("one bank");
    let validity = field.validity();
    let singular = validity.iter().filter(|v| **v == Validity::Singular);
    let singular = singular.count() as f64 / SIZE.area() as f64;
    // Dots leave an orientation or two silent here and there, and the search stays at 0.
    assert!(singular > 0.95, "{singular}");
    assert_eq!(field.density(), 0.0);
}

/// A blank wall has no energy, whatever the test for singularities says of it.
#[test]
fn a_blank_wall_is_not_singular() {
    let eyes = respond(SIZE, |_, _| 0.5, |_, _| 0.5);
    let field = estimate(&eyes, params(1.75)).expect("one bank");
    assert!(field.validity().iter().all(|v| *v == Validity::NoEnergy));
}

/// Where two textures part, responses cancel: the singular places that a real test leaves without an
/// answer are few, and where it answers it is right.
#[test]
fn what_is_left_is_right() {
    let dots = Dots { seed: 4 };
    let eyes = respond(SIZE, |x, y| dots.at(x, y), |x, y| dots.at(x + 3.3, y - 0.4));
    let field = estimate(&eyes, params(1.75)).expect("one bank");
    assert!(field.density() > 0.8, "{}", field.density());
    let places = (16..SIZE.height - 16).flat_map(|y| (16..SIZE.width - 16).map(move |x| (x, y)));
    for found in places.filter_map(|(x, y)| field.at(x, y)) {
        // What is found without noise, with room for the neighbours that are no longer heard.
        assert!(
            (found.dx + 3.3).abs() < 0.1 && (found.dy - 0.4).abs() < 0.1,
            "{found:?}"
        );
    }
}

#[test]
fn a_tau_that_is_none_is_refused() {
    let eyes = respond(SIZE, |_, _| 0.5, |_, _| 0.5);
    for tau in [0.0, -1.0, f32::NAN] {
        let refused = estimate(&eyes, params(tau)).expect_err("no such test");
        assert!(refused.to_string().contains("singularity_tau"), "{refused}");
    }
}

/// Held at 0 the vertical shift is 0 everywhere, and the horizontal one is found.
#[test]
fn rows_alone_hold_the_vertical_shift() {
    let dots = Dots { seed: 6 };
    let eyes = respond(SIZE, |x, y| dots.at(x, y), |x, y| dots.at(x + 4.6, y));
    for base in [MatchParams::default(), MatchParams::as_published()] {
        let params = MatchParams {
            rows_only: true,
            ..base
        };
        let field = estimate(&eyes, params).expect("one bank");
        assert!(field.dy().iter().all(|dy| *dy == 0.0));
        let found = field.at(60, 48).expect("dots are seen");
        assert!((found.dx + 4.6).abs() < 0.05, "{found:?}");
    }
}

/// Upright bars have one orientation, which along rows is enough.
#[test]
fn bars_are_enough_along_rows() {
    let bars = |x: f64| 0.5 + 0.2 * (1.5 * x).sin() as f32 + 0.1 * (0.9 * x).cos() as f32;
    let eyes = respond(SIZE, |x, _| bars(x), |x, _| bars(x + 0.7));
    let params = MatchParams {
        rows_only: true,
        ..MatchParams::default()
    };
    let field = estimate(&eyes, params).expect("one bank");
    let found = field.at(60, 48).expect("bars are seen");
    assert!((found.dx + 0.7).abs() < 0.05, "{found:?}");
}
