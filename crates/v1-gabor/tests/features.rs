//! What energy, amplitude, phase, dominant orientation, instantaneous frequency, singularities and
//! phase congruency owe: one law each.
use std::f32::consts::PI;

use ndarray::Array2;
use num_complex::Complex32;
use proptest::prelude::*;
use v1_gabor::{FilterBank, GaborParams, LumaImage, Responses, Size, V1Responses};

const SIZE: Size = Size {
    width: 48,
    height: 40,
};

fn respond_with(scales: usize, luma: impl Fn(f32, f32) -> f32) -> V1Responses {
    let params = GaborParams {
        scales,
        ..GaborParams::default()
    };
    let bank = FilterBank::plan(params, SIZE).expect("the scales fit");
    let plane = Array2::from_shape_fn(SIZE.dim(), |(y, x)| luma(x as f32, y as f32));
    let image = LumaImage::new(plane).expect("the luma is finite");
    bank.respond(&image)
        .expect("the image has the planned size")
}

fn respond(luma: impl Fn(f32, f32) -> f32) -> Responses {
    respond_with(1, luma).scales()[0].clone()
}

/// A plane wave of this direction and frequency.
fn grating(theta: f32, frequency: f32, phase: f32) -> impl Fn(f32, f32) -> f32 {
    move |x, y| 0.5 + 0.3 * (frequency * (x * theta.cos() + y * theta.sin()) + phase).cos()
}

fn scene(x: f32, y: f32) -> f32 {
    0.5 + 0.2 * (0.9 * x + 0.3 * y).sin() + 0.1 * (1.7 * y - 0.4 * x).cos()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    /// Amplitude and phase are the polar form of the response, and energy is amplitude squared.
    #[test]
    fn amplitude_and_phase_rebuild_the_response(q in 0usize..8, frequency in 0.8f32..2.2) {
        let responses = respond(grating(0.4, frequency, 0.0));
        let energy = responses.energy(q);
        let amplitude = responses.amplitude(q);
        let phase = responses.local_phase(q);
        for ((y, x), &rho) in amplitude.indexed_iter() {
            let rebuilt = Complex32::from_polar(rho, phase[[y, x]]);
            // The rounding of a sine, on amplitudes below 0.2.
            prop_assert!((rebuilt - responses.at(q, x, y)).norm() < 1e-6);
            prop_assert!((rho * rho - energy[[y, x]]).abs() < 1e-7);
        }
    }

    /// A grating moved by a fraction of its period keeps its energy.
    #[test]
    fn energy_does_not_see_position(q in 0usize..8, phase in -PI..PI) {
        let wave = GaborParams::default().wave_vectors()[q];
        let theta = wave.y.atan2(wave.x);
        let still = respond(grating(theta, PI / 2.0, 0.0)).energy(q)[[20, 24]];
        let moved = respond(grating(theta, PI / 2.0, phase)).energy(q)[[20, 24]];
        // Twice the mirrored half's 1.2 % of the amplitude, on either side, squared.
        prop_assert!((moved / still - 1.0).abs() < 0.1, "{still} {moved}");
    }

    /// A grating's direction is found wherever it lies between the filters, and turns with it.
    #[test]
    fn the_dominant_orientation_is_the_gratings(
        theta in 0.0f32..PI, frequency in 1.2f32..1.9, phase in -PI..PI,
    ) {
        let dominant = respond(grating(theta, frequency, phase)).dominant_orientation();
        let found = dominant.theta_rad[[20, 24]];
        let off = (found - theta + PI / 2.0).rem_euclid(PI) - PI / 2.0;
        // A square window of 2.2 deviations is not quite isotropic: 1.2 degrees at most.
        prop_assert!(off.abs() < 0.03, "{found} instead of {theta}");
        prop_assert!((0.0..PI).contains(&found));
        prop_assert!((0.6..1.0).contains(&dominant.strength[[20, 24]]));
    }

    /// Two crossed gratings of one strength have no dominant orientation.
    #[test]
    fn crossed_gratings_are_undecided(q in 0usize..4) {
        let waves = GaborParams::default().wave_vectors();
        let dominant = respond(|x, y| {
            let cosine = |q: usize| (waves[q].x * x + waves[q].y * y).cos();
            0.5 + 0.2 * (cosine(q) + cosine(q + 4))
        }).dominant_orientation();
        // Half of the 5 % by which the filters' gains off their axes differ, and the mirrored lobes.
        prop_assert!(dominant.strength[[20, 24]] < 0.06);
    }

    /// The phase of a grating turns at the grating's own frequency, not at the filter's.
    #[test]
    fn the_instantaneous_frequency_is_the_gratings(
        q in 0usize..8, frequency in 1.2f32..1.9, turned in -0.15f32..0.15,
    ) {
        let wave = GaborParams::default().wave_vectors()[q];
        let theta = wave.y.atan2(wave.x) + turned;
        let found = respond(grating(theta, frequency, 0.3)).instantaneous_frequency(q);
        for (x, y) in [(20, 17), (24, 20), (31, 25)] {
            let off = (found.along_x[[y, x]] - frequency * theta.cos())
                .hypot(found.along_y[[y, x]] - frequency * theta.sin());
            // The mirrored lobe, at most 2 % of the response here, turns the other way: 2 omega
            // times 2 %; five taps of a carrier of 0.4 rad/px add 1e-3.
            prop_assert!(off < 0.1, "off by {off} rad/px");
        }
    }

    /// Gain and offset move no edge.
    #[test]
    fn phase_congruency_does_not_see_contrast(gain in 0.2f32..3.0, offset in -0.5f32..0.5) {
        let plain = respond_with(2, scene).phase_congruency(0.0);
        let changed = respond_with(2, |x, y| gain * scene(x, y) + offset).phase_congruency(0.0);
        for (a, b) in plain.iter().zip(&changed) {
            prop_assert!((0.0..=1.0).contains(a));
            // Responses of some 0.05 with errors of 1e-6.
            prop_assert!((a - b).abs() < 1e-3, "{a} {b}");
        }
    }
}

/// A constant image has no energy to speak of, no edge, and no phase worth keeping.
#[test]
fn nothing_is_claimed_of_a_blank_wall() {
    let responses = respond_with(2, |_, _| 0.0);
    let finest = &responses.scales()[0];
    assert!(finest.local_phase(3).iter().all(|phase| phase.is_nan()));
    assert!(
        finest
            .singularities(3, 1.75)
            .iter()
            .all(|&singular| singular)
    );
    let dominant = finest.dominant_orientation();
    assert!(dominant.theta_rad.iter().all(|theta| theta.is_nan()));
    assert!(dominant.strength.iter().all(|strength| strength.is_nan()));
    let frequency = finest.instantaneous_frequency(3);
    assert!(frequency.along_x.iter().all(|frequency| frequency.is_nan()));
    assert!(responses.phase_congruency(0.0).iter().all(|&pc| pc == 0.0));
}

/// One grating has no singularity; two that cancel have one at the middle of every beat, and none
/// where they support each other.
#[test]
fn singularities_lie_where_components_cancel() {
    let one = respond(grating(0.0, 1.5, 0.2));
    let inner = |mask: &Array2<bool>, x: usize| mask[[20, x]];
    let mask = one.singularities(0, 1.25);
    assert!((8..40).all(|x| !inner(&mask, x)));

    // At pi/2 +- 0.3 the filter's gain is the same within some per cent; the two cancel at x = 24
    // and agree half a beat, 5.2 px, to either side.
    let two = respond(|x, _| {
        let x = x - 24.0;
        0.5 + 0.2 * ((PI / 2.0 + 0.3) * x).cos() - 0.2 * ((PI / 2.0 - 0.3) * x).cos()
    });
    let mask = two.singularities(0, 1.25);
    assert!(inner(&mask, 24));
    assert!(!inner(&mask, 19) && !inner(&mask, 29));
}

/// Responses without singularities are silent where the test says so, and else the same.
#[test]
fn singular_responses_can_be_silenced() {
    let responses = respond_with(2, |x, y| 0.5 + 0.1 * (0.9 * x + 0.2 * x * y).sin());
    let silenced = responses.without_singularities(1.25);
    for (before, after) in responses.scales().iter().zip(silenced.scales()) {
        for q in 0..before.orientations() {
            let singular = before.singularities(q, 1.25);
            for ((y, x), &singular) in singular.indexed_iter() {
                let expected = if singular {
                    Complex32::ZERO
                } else {
                    before.at(q, x, y)
                };
                assert_eq!(after.at(q, x, y), expected);
            }
        }
    }
}

/// Next to a border shorter differences stand in, and slender images are no exception.
#[test]
fn features_reach_the_border() {
    for (width, height) in [(1, 1), (7, 3), (300, 2)] {
        let size = Size { width, height };
        let params = GaborParams::default().fitted_to(size);
        let bank = FilterBank::plan(params, size).unwrap();
        let plane = Array2::from_shape_fn(size.dim(), |(y, x)| scene(x as f32, y as f32));
        let responses = bank.respond(&LumaImage::new(plane).unwrap()).unwrap();
        let finest = &responses.scales()[0];
        assert_eq!(finest.singularities(0, 1.75).dim(), size.dim());
        assert_eq!(finest.instantaneous_frequency(2).along_x.dim(), size.dim());
        assert_eq!(finest.dominant_orientation().strength.dim(), size.dim());
        assert_eq!(responses.phase_congruency(0.0).dim(), size.dim());
    }
}

/// All scales agree on a step, wherever it lies, and disagree between two of them.
#[test]
fn phase_congruency_peaks_on_an_edge() {
    for edge in [20, 23, 26] {
        let responses = respond_with(2, |x, _| if x < edge as f32 { 0.2 } else { 0.8 });
        let congruency = responses.phase_congruency(1e-3);
        // The step lies half a pixel left of column `edge`.
        let on = congruency[[20, edge]].min(congruency[[20, edge - 1]]);
        assert!(on > 0.9, "{on} on the edge at {edge}");
        for x in [edge - 5, edge + 4] {
            let off = congruency[[20, x]];
            assert!(off < on - 0.1, "{off} five pixels from the edge at {edge}");
        }
        assert!(congruency[[20, 4]] == 0.0);
    }
}
