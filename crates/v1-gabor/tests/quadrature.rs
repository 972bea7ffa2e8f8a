//! What a bank of quadrature filters owes: no DC, equal energy in both parts, every orientation
//! the same filter turned.
use std::f64::consts::PI;

use num_complex::Complex64;
use v1_gabor::{FilterBank, GaborParams, Size};

const SIZE: Size = Size {
    width: 32,
    height: 32,
};

fn banks() -> impl Iterator<Item = FilterBank> {
    [4, 6, 7, 8, 12, 32].into_iter().map(|orientations| {
        let params = GaborParams {
            orientations,
            scales: 1,
            ..GaborParams::default()
        };
        FilterBank::plan(params, SIZE).expect("these orientations make a bank")
    })
}

/// `H(w) = sum_k h(k) exp(j w.k)`, straight from the taps.
fn transfer(bank: &FilterBank, orientation: usize, wave: (f64, f64)) -> Complex64 {
    let radius = bank.params().radius as f64;
    let filter = bank.filter(orientation);
    filter
        .indexed_iter()
        .map(|((y, x), tap)| {
            let angle = wave.0 * (x as f64 - radius) + wave.1 * (y as f64 - radius);
            Complex64::new(f64::from(tap.re), f64::from(tap.im)) * Complex64::cis(angle)
        })
        .sum()
}

#[test]
fn no_filter_answers_to_a_constant() {
    for bank in banks() {
        for q in 0..bank.params().orientations {
            let dc = transfer(&bank, q, (0.0, 0.0)).norm();
            // 121 taps of at most 0.07 rounded to f32: 121 * 0.07 * 6e-8.
            assert!(dc < 5e-7, "orientation {q}: DC {dc}");
        }
    }
}

#[test]
fn the_gain_is_one_at_the_peak_and_small_behind_it() {
    for bank in banks() {
        for (q, wave) in bank.params().wave_vectors().into_iter().enumerate() {
            let wave = (f64::from(wave.x), f64::from(wave.y));
            let at_peak = transfer(&bank, q, wave);
            assert!((at_peak - 1.0).norm() < 1e-5, "orientation {q}: {at_peak}");
            // The mirrored lobe of a Gaussian of this width, 2 omega0 sigma = 7 deviations away,
            // would be 1e-11; cutting the envelope off at 2.2 sigma leaves up to 0.009.
            let behind = transfer(&bank, q, (-wave.0, -wave.1)).norm();
            assert!(behind < 0.012, "orientation {q}: {behind}");
        }
    }
}

#[test]
fn even_and_odd_parts_carry_equal_energy() {
    for bank in banks() {
        for q in 0..bank.params().orientations {
            let filter = bank.filter(q);
            let even: f32 = filter.iter().map(|tap| tap.re * tap.re).sum();
            let odd: f32 = filter.iter().map(|tap| tap.im * tap.im).sum();
            // The cosine parts lose their mean, which is 0.1 % of their energy.
            assert!(
                (even / odd - 1.0).abs() < 0.005,
                "orientation {q}: {even} / {odd}"
            );
        }
    }
}

#[test]
fn every_orientation_is_the_same_filter_turned() {
    for bank in banks() {
        let omega = f64::from(bank.params().peak_frequency);
        for angle in [0.0, 0.3, -0.7] {
            for radial in [0.6, 1.0, 1.4] {
                let gain = |q: usize| {
                    let theta = q as f64 * PI / bank.params().orientations as f64 + angle;
                    let wave = (radial * omega * theta.cos(), radial * omega * theta.sin());
                    transfer(&bank, q, wave).norm()
                };
                for q in 1..bank.params().orientations {
                    // A square window of 2.2 deviations is not quite isotropic: 0.045 at most
                    // over a finer sweep, on the flank of the band.
                    assert!(
                        (gain(q) - gain(0)).abs() < 0.05,
                        "orientation {q}, {angle} rad and {radial} octaves off: {} against {}",
                        gain(q),
                        gain(0)
                    );
                }
            }
        }
    }
}

#[test]
fn the_band_is_an_octave_wide() {
    for bank in banks() {
        let omega = f64::from(bank.params().peak_frequency);
        // One octave of bandwidth at half gain: from 2/3 to 4/3 of the peak frequency.
        for edge in [2.0 / 3.0, 4.0 / 3.0] {
            let gain = transfer(&bank, 0, (edge * omega, 0.0)).norm();
            // The cut of the envelope and the missing mean move the edges a little.
            assert!(
                (gain - 0.5).abs() < 0.03,
                "gain {gain} at {edge} of the peak"
            );
        }
    }
}
