use num_complex::Complex32;

use crate::{Responses, WaveVector};

/// The gradient of `log u` of a demodulated response `u(x) = G(x) exp(-j k.x)`: the relative
/// change of its amplitude as real part and the change of its phase beyond the wave vector as
/// imaginary part, `rho'/rho + j (phi' - k)`, along x and along y, a pixel.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LogarithmicDerivative {
    pub(crate) x: Complex32,
    pub(crate) y: Complex32,
}

/// The logarithmic derivative of one orientation at one pixel; `None` where the response is 0.
///
/// The carrier goes before the derivative is taken: what is left varies slowly, so that five taps
/// see it well, and no phase needs unwrapping. Two pixels from a border and nearer, shorter
/// differences take over.
pub(crate) fn logarithmic_derivative(
    responses: &Responses,
    orientation: usize,
    wave: WaveVector,
    x: usize,
    y: usize,
) -> Option<LogarithmicDerivative> {
    let size = responses.size();
    let here = responses.at(orientation, x, y);
    let energy = here.norm_sqr();
    if energy <= 0.0 {
        return None;
    }
    let along_x = derivative(x, size.width, |column| {
        let offset = column as f32 - x as f32;
        responses.at(orientation, column, y) * Complex32::cis(-wave.x * offset)
    });
    let along_y = derivative(y, size.height, |row| {
        let offset = row as f32 - y as f32;
        responses.at(orientation, x, row) * Complex32::cis(-wave.y * offset)
    });
    Some(LogarithmicDerivative {
        x: along_x * here.conj() / energy,
        y: along_y * here.conj() / energy,
    })
}

/// The derivative at `place` of a sequence of `length` samples: `[1 -8 0 8 -1] / 12` where it
/// fits, else the central difference, else the one-sided one, and 0 for a single sample.
fn derivative(place: usize, length: usize, at: impl Fn(usize) -> Complex32) -> Complex32 {
    match (place, length - 1 - place) {
        (0, 0) => Complex32::ZERO,
        (0, _) => at(1) - at(0),
        (_, 0) => at(place) - at(place - 1),
        (1, _) | (_, 1) => (at(place + 1) - at(place - 1)) / 2.0,
        _ => {
            let near = at(place + 1) - at(place - 1);
            let far = at(place + 2) - at(place - 2);
            (near * 8.0 - far) / 12.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Five taps are exact for cubics, three for parabolas, two for lines.
        #[test]
        fn polynomials_have_their_derivative(a in -1.0f32..1.0, b in -1.0f32..1.0) {
            let slope = |place, degree: i32| {
                let at = |x: usize| Complex32::new(a, b) * (x as f32 / 8.0).powi(degree);
                derivative(place, 8, at)
            };
            let expected = |place: f32, degree: i32| {
                Complex32::new(a, b) * degree as f32 * (place / 8.0).powi(degree - 1) / 8.0
            };
            for (place, degree) in [(3, 3), (1, 2), (6, 2), (0, 1), (7, 1)] {
                // A few roundings of values up to 1.4.
                let error = slope(place, degree) - expected(place as f32, degree);
                prop_assert!(error.norm() < 1e-6, "{place}, {degree}: {error}");
            }
        }
    }
}
