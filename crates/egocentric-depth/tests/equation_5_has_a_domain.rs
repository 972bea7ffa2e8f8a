//! Equation 5 answers within its domain, as printed, and says where that ends.
use egocentric_depth::{OutOfDomain, equation_5};

/// The head of the paper at 1 m: the fixation point has no relative depth, and half the vergence
/// lies a little beyond twice the distance.
#[test]
fn the_papers_head_at_one_metre() {
    assert_eq!(equation_5(1.0, 0.27, 0.0), Ok(0.0));
    let vergence = 2.0 * 0.135f64.atan();
    let half_way = equation_5(1.0, 0.27, vergence / 2.0).unwrap();
    // Absolute depth b / 2 / tan(alpha / 2), from the tangent of the half angle.
    let exact = 0.135 / (0.135f64.atan() / 2.0).tan() - 1.0;
    assert!((half_way - exact).abs() < 1e-12);
    // Positive is farther, negative nearer.
    assert!(equation_5(1.0, 0.27, -0.05).unwrap() < 0.0);
}

/// Infinity and what lies behind the eyes are errors that name the limit.
#[test]
fn beyond_the_domain_is_an_error() {
    let vergence = 2.0 * 0.135f64.atan();
    for delta in [vergence, vergence + 0.1, f64::NAN] {
        assert!(matches!(
            equation_5(1.0, 0.27, delta),
            Err(OutOfDomain::NotNearerThanInfinity { .. })
        ));
    }
    assert!(matches!(
        equation_5(1.0, 0.27, vergence - std::f64::consts::PI),
        Err(OutOfDomain::NotInFront { .. })
    ));
    for (fixation, baseline) in [(0.0, 0.27), (f64::NAN, 0.27), (1.0, -0.27)] {
        assert!(matches!(
            equation_5(fixation, baseline, 0.0),
            Err(OutOfDomain::NoFixation { .. })
        ));
    }
}
