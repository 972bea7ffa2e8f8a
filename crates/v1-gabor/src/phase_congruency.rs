use ndarray::Array2;
use num_complex::Complex32;

use crate::{Responses, V1Responses, WaveVector};

impl V1Responses {
    /// How well the phases of all scales agree at every pixel of the finest one, `[[y, x]]`, 0 to 1:
    /// high on edges and lines of any contrast (Morrone & Owens 1987, Kovesi 1999).
    ///
    /// `PC = sum_q max(0, |sum_s G_qs| - T) / sum_q sum_s |G_qs|`, with `s` over scales and `T` the
    /// `noise`, in units of luma: the length of `sum_s G_qs` that noise alone reaches. 0 where
    /// nothing exceeds it. With `T = 0` neither gain nor offset of the image matters.
    ///
    /// Coarser responses are read between their pixels after demodulation, as the carrier would
    /// suffer from interpolation. One scale agrees with itself everywhere: take two or more.
    #[must_use]
    pub fn phase_congruency(&self, noise: f32) -> Array2<f32> {
        let waves = self.params().wave_vectors();
        Array2::from_shape_fn(self.size().dim(), |(y, x)| {
            let (mut agreed, mut total) = (0.0f32, 0.0f32);
            for (q, &wave) in waves.iter().enumerate() {
                let mut sum = Complex32::ZERO;
                let mut step = 1.0;
                for responses in self.scales() {
                    let response = between(responses, q, wave, x as f32 / step, y as f32 / step);
                    sum += response;
                    total += response.norm();
                    step *= 2.0;
                }
                agreed += (sum.norm() - noise).max(0.0);
            }
            // A sum of lengths can round to less than the length of the sum.
            if total > 0.0 {
                (agreed / total).min(1.0)
            } else {
                0.0
            }
        })
    }
}

/// A response between pixels: `sum_i w_i G(x_i) exp(-j k.(x_i - x))`, `w_i` bilinear, the last
/// pixel repeated beyond the border.
fn between(responses: &Responses, q: usize, wave: WaveVector, x: f32, y: f32) -> Complex32 {
    let size = responses.size();
    let (left, top) = (x.floor() as usize, y.floor() as usize);
    let (right, bottom) = (x - x.floor(), y - y.floor());
    let mut sum = Complex32::ZERO;
    for (row, by_y) in [(top, 1.0 - bottom), (top + 1, bottom)] {
        for (column, by_x) in [(left, 1.0 - right), (left + 1, right)] {
            let weight = by_x * by_y;
            if weight > 0.0 {
                let (column, row) = (column.min(size.width - 1), row.min(size.height - 1));
                let turn = wave.x * (column as f32 - x) + wave.y * (row as f32 - y);
                sum += responses.at(q, column, row) * Complex32::cis(-turn) * weight;
            }
        }
    }
    sum
}
