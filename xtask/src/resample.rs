use ndarray::{Array2, ArrayView2, Zip};

/// Lobes of the kernel on either side: 8 x 8 samples make one.
const LOBES: usize = 4;

/// The plane as it looks where `source` says which place each new pixel shows: Lanczos
/// interpolation with four lobes, borders repeated.
///
/// Four lobes keep the gain within 0.02 of one up to 0.6 of the Nyquist frequency at every sub-pixel
/// place, so a resampled picture is hardly blurred, which would be a change of its own. Weights are made to
/// sum to one, so that what is even stays even.
pub(crate) fn resample(
    plane: ArrayView2<'_, f32>,
    source: impl Fn(f64, f64) -> (f64, f64) + Sync,
) -> Array2<f32> {
    let mut out = Array2::zeros(plane.dim());
    Zip::indexed(&mut out).par_for_each(|(y, x), out| {
        let (u, v) = source(x as f64, y as f64);
        *out = sample(plane, u, v);
    });
    out
}

fn sample(plane: ArrayView2<'_, f32>, x: f64, y: f64) -> f32 {
    let (height, width) = plane.dim();
    let (columns, across) = taps(x, width);
    let (rows, down) = taps(y, height);
    let mut sum = 0.0;
    for (row, down) in rows.into_iter().zip(down) {
        let line = columns
            .iter()
            .zip(across)
            .map(|(&column, across)| across * f64::from(plane[[row, column]]));
        sum += down * line.sum::<f64>();
    }
    sum as f32
}

/// The samples that make the place `at` of a line of `length`, and their weights.
fn taps(at: f64, length: usize) -> ([usize; 2 * LOBES], [f64; 2 * LOBES]) {
    let first = at.floor() - (LOBES - 1) as f64;
    let last = (length - 1) as f64;
    let place = |tap: usize| (first + tap as f64).clamp(0.0, last) as usize;
    let weights: [f64; 2 * LOBES] = std::array::from_fn(|tap| lanczos(at - first - tap as f64));
    let total: f64 = weights.iter().sum();
    (
        std::array::from_fn(place),
        weights.map(|weight| weight / total),
    )
}

/// `sinc(t) sinc(t / LOBES)` within the lobes.
fn lanczos(t: f64) -> f64 {
    let lobes = LOBES as f64;
    if t.abs() >= lobes {
        return 0.0;
    }
    sinc(t) * sinc(t / lobes)
}

fn sinc(t: f64) -> f64 {
    let angle = std::f64::consts::PI * t;
    if angle.abs() < 1e-9 {
        1.0
    } else {
        angle.sin() / angle
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn whole_places_are_the_samples_themselves() {
        let plane = Array2::from_shape_fn((9, 12), |(y, x)| (x * x + 3 * y) as f32);
        let same = resample(plane.view(), |x, y| (x, y));
        // Sines of whole multiples of pi are zero to 1e-15, not exactly.
        assert!((&same - &plane).iter().all(|apart| apart.abs() < 1e-4));
    }

    proptest! {
        /// A wave of six pixels is shifted, not blurred; what is even stays even.
        #[test]
        fn a_wave_is_shifted(shift in 0.0f64..1.0) {
            let wave = |x: f64| (std::f64::consts::TAU * x / 6.0).sin();
            let plane = Array2::from_shape_fn((1, 60), |(_, x)| wave(x as f64) as f32);
            let moved = resample(plane.view(), |x, y| (x + shift, y));
            for x in 8..50 {
                // One per cent of the amplitude is the kernel's ripple at a third of the Nyquist
                // frequency.
                let want = wave(x as f64 + shift);
                prop_assert!((f64::from(moved[[0, x]]) - want).abs() < 0.01);
            }
            let even = Array2::from_elem((5, 5), 0.7f32);
            let moved = resample(even.view(), |x, y| (x + shift, y - shift));
            prop_assert!(moved.iter().all(|luma| (luma - 0.7).abs() < 1e-6));
        }
    }
}
