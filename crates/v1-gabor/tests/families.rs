//! What every family owes, measured in its spectrum: gain, band and DC; and what the steerable and
//! the spherical ones promise beyond that.
use std::f32::consts::PI;

use ndarray::{Array2, Axis};
use num_complex::Complex32;
use proptest::prelude::*;
use rustfft::FftPlanner;
use v1_gabor::{
    BadParams, Family, FilterBank, GaborParams, LumaImage, MonogenicBank, MonogenicParams, Size,
    SteerableOrder, SteerableParams,
};

/// Bins of a spectrum along either axis; 512 resolve 0.012 rad/px.
const BINS: usize = 512;
const SIZE: Size = Size {
    width: 64,
    height: 48,
};
const SECOND: SteerableParams = steerable(SteerableOrder::Second);
const FOURTH: SteerableParams = steerable(SteerableOrder::Fourth);

const fn steerable(order: SteerableOrder) -> SteerableParams {
    SteerableParams {
        order,
        orientations: 8,
        scales: 1,
        peak_frequency: PI / 2.0,
        radius: 5,
    }
}

fn gabor() -> GaborParams {
    GaborParams {
        scales: 1,
        ..GaborParams::default()
    }
}

/// `H(w) = sum_k h(k) exp(j w.k)` at `w = 2 pi (column, row) / BINS`: the inverse transform's sign.
fn spectrum(filter: &Array2<Complex32>) -> Array2<Complex32> {
    let mut plane = Array2::zeros((BINS, BINS));
    let radius = filter.dim().0 / 2;
    for ((y, x), &tap) in filter.indexed_iter() {
        plane[[(y + BINS - radius) % BINS, (x + BINS - radius) % BINS]] = tap;
    }
    let fft = FftPlanner::new().plan_fft_inverse(BINS);
    for axis in [Axis(1), Axis(0)] {
        for mut lane in plane.lanes_mut(axis) {
            let mut line = lane.to_vec();
            fft.process(&mut line);
            for (to, from) in lane.iter_mut().zip(line) {
                *to = from;
            }
        }
    }
    plane
}

/// What a gain along one axis says of a family, with its bins running from 0 to the Nyquist
/// frequency.
struct Band {
    peak: f32,
    octaves: f32,
}

fn band(gain: impl Fn(usize) -> f32) -> Band {
    let omega = |bin: usize| 2.0 * PI * bin as f32 / BINS as f32;
    let gains: Vec<f32> = (0..=BINS / 2).map(gain).collect();
    let peak = (0..gains.len())
        .max_by(|&a, &b| gains[a].total_cmp(&gains[b]))
        .expect("a gain at every bin");
    let half = gains[peak] / 2.0;
    let lower = (0..peak)
        .rev()
        .find(|&bin| gains[bin] < half)
        .expect("a band-pass");
    let upper = (peak..gains.len())
        .find(|&bin| gains[bin] < half)
        .expect("a band below Nyquist");
    let crossing = |a: usize, b: usize| {
        omega(a) + (half - gains[a]) / (gains[b] - gains[a]) * (omega(b) - omega(a))
    };
    Band {
        peak: omega(peak),
        octaves: (crossing(upper - 1, upper) / crossing(lower, lower + 1)).log2(),
    }
}

/// Gain 1 at the nominal peak, the measured peak and band where the parameters say, no DC, and
/// next to nothing behind.
#[test]
fn gain_band_and_dc_are_as_planned() {
    // How far the measured peak may lie from the nominal one, in octaves, and the band from its
    // width; and the gain behind. Sampling lets the wide second-order pair fold at the Nyquist
    // frequency: its odd part has to vanish there and its even part doubles.
    let families: [(Family, f32, f32, f32); 3] = [
        (gabor().into(), 0.02, 0.06, 0.012),
        (FOURTH.into(), 0.05, 0.06, 0.02),
        (SECOND.into(), 0.08, 0.14, 0.02),
    ];
    for (family, peak_off, octaves_off, behind) in families {
        let bank = FilterBank::plan(family, SIZE).unwrap();
        let params = bank.params();
        let bin = (params.peak_frequency * BINS as f32 / (2.0 * PI)).round() as usize;
        for q in 0..params.orientations {
            let dc = spectrum(&bank.filter(q))[[0, 0]].norm();
            // 121 taps of at most 0.2 rounded to f32.
            assert!(dc < 1e-6, "{family:?}, orientation {q}: DC {dc}");
        }
        for (q, along_x) in [(0, true), (4, false)] {
            let spectrum = spectrum(&bank.filter(q));
            let at = |bin: usize| {
                let place = if along_x { [0, bin] } else { [bin, 0] };
                spectrum[place]
            };
            assert!((at(bin) - 1.0).norm() < 1e-4, "{family:?}: {}", at(bin));
            let behind_gain = at(BINS - bin).norm();
            assert!(behind_gain < behind, "{family:?}: {behind_gain} behind");
            let band = band(|bin| at(bin).norm());
            let octave = (band.peak / params.peak_frequency).log2();
            assert!(
                octave.abs() < peak_off,
                "{family:?}: peak {octave} octaves off"
            );
            assert!(
                (band.octaves - params.bandwidth).abs() < octaves_off,
                "{family:?}: {} octaves",
                band.octaves
            );
        }
    }
}

/// Every orientation is the same filter turned: its gain at the peak, across it and behind it does
/// not depend on the direction.
#[test]
fn steering_turns_the_filter() {
    for params in [SECOND, FOURTH] {
        for orientations in [4, 7, 8, 32] {
            let params = SteerableParams {
                orientations,
                ..params
            };
            let bank = FilterBank::plan(params, SIZE).unwrap();
            let transfer = |q: usize, turned: f32, radial: f32| -> Complex32 {
                let theta = q as f32 * PI / orientations as f32 + turned;
                let omega = radial * params.peak_frequency;
                let taps = bank.filter(q);
                let terms = taps.indexed_iter().map(|((y, x), tap)| {
                    let (x, y) = (x as f32 - 5.0, y as f32 - 5.0);
                    tap * Complex32::cis(omega * (x * theta.cos() + y * theta.sin()))
                });
                terms.sum()
            };
            for (turned, radial) in [(0.0, 1.0), (0.5, 1.0), (PI / 2.0, 1.0), (0.0, 0.7)] {
                let first = transfer(0, turned, radial);
                for q in 1..orientations {
                    let off = (transfer(q, turned, radial) - first).norm();
                    // Folding at the Nyquist frequency along the axes, a square window, and a printed
                    // H4 that is separable only approximately: 0.036 at most was measured.
                    assert!(off < 0.045, "{params:?} {q}: {off} at {turned}, {radial}");
                }
            }
        }
    }
}

/// Seven and eleven products carry any number of orientations; here, 32 are linear combinations of
/// as many as the order has: the filter at any angle follows from those at the first few.
#[test]
fn a_second_order_pair_is_steered_by_its_basis() {
    let bank = |orientations| {
        FilterBank::plan(
            SteerableParams {
                orientations,
                ..SECOND
            },
            SIZE,
        )
        .unwrap()
    };
    // The even part at theta from those at 0, 60 and 120 degrees: 1/3 (1 + 2 cos 2 (theta - t)).
    let (few, many) = (bank(6), bank(32));
    for q in 0..32 {
        let theta = q as f32 * PI / 32.0;
        let mut steered = Array2::<f32>::zeros((11, 11));
        for third in 0..3 {
            let at = third as f32 * PI / 3.0;
            let weight = (1.0 + 2.0 * (2.0 * (theta - at)).cos()) / 3.0;
            steered.scaled_add(weight, &few.filter(2 * third).mapv(|tap| tap.re));
        }
        let expected = many.filter(q).mapv(|tap| tap.re);
        for (a, b) in steered.iter().zip(&expected) {
            // Sums of three taps below 0.2.
            assert!((a - b).abs() < 1e-6, "orientation {q}: {a} {b}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// A grating moved by `shift` turns the phase by frequency times shift, in every family.
    #[test]
    fn a_shift_is_a_phase(q in 0usize..8, shift in -0.95f32..0.95, phase in -PI..PI) {
        for family in [Family::from(gabor()), SECOND.into(), FOURTH.into()] {
            let bank = FilterBank::plan(family, SIZE).unwrap();
            let wave = bank.params().wave_vectors()[q];
            let grating = |moved: f32| {
                let plane = Array2::from_shape_fn(SIZE.dim(), |(y, x)| {
                    let at = wave.x * x as f32 + wave.y * y as f32 - PI / 2.0 * moved;
                    0.5 + 0.3 * (at + phase).cos()
                });
                let responses = bank.respond(&LumaImage::new(plane).unwrap()).unwrap();
                responses.scales()[0].at(q, 30, 24)
            };
            let turned = (grating(0.0) * grating(shift).conj()).arg();
            let off = (turned - PI / 2.0 * shift + PI).rem_euclid(2.0 * PI) - PI;
            // Twice the gain behind the filter, at most 2.2 %.
            prop_assert!(off.abs() < 0.06, "{family:?}: {off} rad");
        }
    }

    /// A spherical filter gives a grating's amplitude, phase and direction, whatever the direction.
    #[test]
    fn the_monogenic_response_is_the_gratings(theta in 0.0f32..PI, phase in -PI..PI) {
        let bank = monogenic();
        let at = |x: f32, y: f32| PI / 2.0 * (x * theta.cos() + y * theta.sin()) + phase;
        let plane = Array2::from_shape_fn(SIZE.dim(), |(y, x)| {
            0.5 + 0.2 * at(x as f32, y as f32).cos()
        });
        let responses = bank.respond(&LumaImage::new(plane).unwrap()).unwrap();
        let response = responses.scales()[0].at(31, 23);
        let expected = Complex32::from_polar(0.1, at(31.0, 23.0));
        // What the replicated borders send 23 px inwards.
        prop_assert!((response.along(theta) - expected).norm() < 0.005);
        prop_assert!((response.amplitude() - 0.1).abs() < 0.005);
        if expected.im.abs() > 0.03 {
            let found = response.theta_rad().unwrap();
            let off = (found - theta + PI / 2.0).rem_euclid(PI) - PI / 2.0;
            prop_assert!(off.abs() < 0.1, "{found} for {theta}");
        }
    }
}

fn monogenic() -> MonogenicBank {
    let params = MonogenicParams {
        scales: 1,
        ..MonogenicParams::default()
    };
    MonogenicBank::plan(params, SIZE).expect("one scale fits")
}

/// The impulse response of the spherical filter has the planned band, no DC, and a Riesz transform
/// of the same gain.
#[test]
fn the_spherical_band_is_as_planned() {
    let size = Size {
        width: 127,
        height: 127,
    };
    let params = MonogenicParams {
        scales: 1,
        ..MonogenicParams::default()
    };
    let bank = MonogenicBank::plan(params, size).unwrap();
    let mut impulse = Array2::zeros(size.dim());
    impulse[[63, 63]] = 1.0;
    let responses = bank.respond(&LumaImage::new(impulse).unwrap()).unwrap();
    let planes = &responses.scales()[0];
    let even = spectrum(&planes.even().mapv(Complex32::from));
    let along_x = spectrum(&planes.along_x().mapv(Complex32::from));
    let along_y = spectrum(&planes.along_y().mapv(Complex32::from));
    assert!(even[[0, 0]].norm() < 1e-3);
    let found = band(|bin| even[[0, bin]].norm());
    assert!((found.peak / params.peak_frequency).log2().abs() < 0.02);
    assert!((found.octaves - 1.0).abs() < 0.02, "{}", found.octaves);
    for (x, y) in [(128, 0), (0, 128), (90, 90), (100, 40)] {
        let riesz = along_x[[y, x]].norm().hypot(along_y[[y, x]].norm());
        // The impulse response is cut off 63 px out.
        assert!((riesz - even[[y, x]].norm()).abs() < 2e-3);
        let wave = (x as f32).hypot(y as f32) * 2.0 * PI / BINS as f32;
        assert!((even[[y, x]].norm() - params.radial_gain(wave)).abs() < 2e-3);
    }
}

/// A blank wall has no response, and small and slender images are no exception.
#[test]
fn spherical_filters_take_any_size() {
    for (width, height) in [(1, 1), (7, 3), (1000, 2)] {
        let size = Size { width, height };
        let bank = MonogenicBank::plan(MonogenicParams::default().fitted_to(size), size).unwrap();
        let image = LumaImage::new(Array2::from_elem(size.dim(), 0.5)).unwrap();
        let responses = bank.respond(&image).unwrap();
        assert_eq!(responses.size(), size);
        // Rounding of a transform of values of one half.
        assert!(responses.scales()[0].even().iter().all(|e| e.abs() < 1e-5));
    }
}

#[test]
fn bad_combinations_are_refused_with_the_reason() {
    let refused = |family: Family| FilterBank::plan(family, SIZE).unwrap_err();
    let too_fast = SteerableParams {
        peak_frequency: 2.2,
        ..SECOND
    };
    assert!(matches!(refused(too_fast.into()), BadParams::Band { .. }));
    let too_narrow = SteerableParams {
        radius: 4,
        ..FOURTH
    };
    assert!(matches!(
        refused(too_narrow.into()),
        BadParams::Radius { least: 5, .. }
    ));
    let too_few = SteerableParams {
        orientations: 3,
        ..FOURTH
    };
    assert_eq!(refused(too_few.into()), BadParams::Orientations(3));
    let too_deep = SteerableParams {
        scales: 9,
        ..FOURTH
    };
    assert!(matches!(
        refused(too_deep.into()),
        BadParams::TooManyScales { .. }
    ));
    let wide = MonogenicParams {
        bandwidth: 4.0,
        scales: 1,
        ..MonogenicParams::default()
    };
    assert!(matches!(
        MonogenicBank::plan(wide, SIZE),
        Err(BadParams::Band { .. })
    ));
}
