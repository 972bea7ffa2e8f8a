//! Phase is position: what a grating's phase says, and what a shift or a change of contrast does.
use std::f32::consts::PI;

use ndarray::Array2;
use num_complex::Complex32;
use proptest::prelude::*;
use v1_gabor::{FilterBank, GaborParams, LumaImage, Size, V1Responses};

const SIZE: Size = Size {
    width: 48,
    height: 40,
};

fn respond(luma: impl Fn(f32, f32) -> f32) -> V1Responses {
    let params = GaborParams {
        scales: 1,
        ..GaborParams::default()
    };
    let bank = FilterBank::plan(params, SIZE).expect("one scale fits");
    let plane = Array2::from_shape_fn(SIZE.dim(), |(y, x)| luma(x as f32, y as f32));
    let image = LumaImage::new(plane).expect("the luma is finite");
    bank.respond(&image)
        .expect("the image has the planned size")
}

fn wrapped(angle: f32) -> f32 {
    (angle + PI).rem_euclid(2.0 * PI) - PI
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// A grating at the peak of one filter has, in that filter, the phase of the grating and half
    /// its amplitude.
    #[test]
    fn a_grating_answers_with_its_own_phase(
        q in 0usize..8, phase in -PI..PI, amplitude in 0.05f32..1.0, mean in 0.0f32..1.0,
    ) {
        let wave = GaborParams::default().wave_vectors()[q];
        let at = |x: f32, y: f32| wave.x * x + wave.y * y + phase;
        let responses = respond(|x, y| mean + amplitude * at(x, y).cos());
        for (x, y) in [(20, 17), (24, 20), (31, 25)] {
            let response = responses.scales()[0].at(q, x, y);
            let expected = Complex32::from_polar(amplitude / 2.0, at(x as f32, y as f32));
            // The filter's small answer to the mirrored half of the cosine: below 2 % of it, see
            // `the_gain_is_one_at_the_peak_and_small_behind_it`.
            prop_assert!((response - expected).norm() < 0.02 * amplitude + 1e-5);
        }
    }

    /// A grating moved by `shift` turns its phase by the frequency times the shift: equation 2.
    #[test]
    fn a_shift_is_a_phase(q in 0usize..8, shift in -0.95f32..0.95) {
        let wave = GaborParams::default().wave_vectors()[q];
        let (nx, ny) = (wave.x / (PI / 2.0), wave.y / (PI / 2.0));
        let grating = |x: f32, y: f32| (wave.x * x + wave.y * y).cos();
        let still = respond(grating);
        let moved = respond(|x, y| grating(x - shift * nx, y - shift * ny));
        let (still, moved) = (still.scales()[0].at(q, 24, 20), moved.scales()[0].at(q, 24, 20));
        let measured = (still * moved.conj()).arg() / (PI / 2.0);
        // Twice the mirrored half's 2 % as an angle, over the frequency.
        prop_assert!(wrapped((measured - shift) * PI / 2.0).abs() < 0.05);
    }

    /// A gain scales amplitudes, an offset changes nothing, and neither moves a phase.
    #[test]
    fn contrast_leaves_phase_alone(gain in 0.2f32..3.0, offset in -0.5f32..0.5) {
        let scene = |x: f32, y: f32| {
            0.5 + 0.2 * (0.9 * x + 0.3 * y).sin() + 0.1 * (1.7 * y - 0.4 * x).cos()
        };
        let plain = respond(scene);
        let changed = respond(|x, y| gain * scene(x, y) + offset);
        for q in 0..8 {
            let (a, b) = (plain.scales()[0].at(q, 21, 18), changed.scales()[0].at(q, 21, 18));
            // f32 sums of values up to 3.5.
            prop_assert!((a * gain - b).norm() < 1e-5, "{a} {b}");
        }
    }
}

/// The rows of a bank do not depend on how they are split over threads.
#[test]
fn any_number_of_threads_gives_the_same_bits() {
    let size = Size {
        width: 130,
        height: 91,
    };
    let bank = FilterBank::plan(GaborParams::default().fitted_to(size), size).unwrap();
    let plane = Array2::from_shape_fn(size.dim(), |(y, x)| {
        ((x * x + 3 * y * x) % 97) as f32 / 97.0
    });
    let image = LumaImage::new(plane).unwrap();
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| bank.respond(&image).unwrap())
    };
    let one = with(1);
    for threads in [2, 3, 8] {
        assert_eq!(one, with(threads));
    }
}

/// Whatever size an image has, one scale of it works; scales it cannot carry are refused by name.
#[test]
fn small_and_slender_images() {
    for (width, height) in [(1, 1), (7, 3), (10_000, 2)] {
        let size = Size { width, height };
        let one = GaborParams {
            scales: 1,
            ..GaborParams::default()
        };
        let image = LumaImage::new(Array2::from_elem(size.dim(), 0.5)).unwrap();
        let responses = FilterBank::plan(one, size)
            .unwrap()
            .respond(&image)
            .unwrap();
        assert_eq!(responses.size(), size);
        let refused = FilterBank::plan(GaborParams::default(), size)
            .unwrap_err()
            .to_string();
        assert!(refused.contains("at most 1"), "{refused}");
    }
}
