use ndarray::{Array2, ArrayView2};
use pulp::Simd;
use rayon::prelude::*;

use crate::Validity;
use crate::dense::guide::Guide;
use crate::vector::vector;

/// Pixels whose neighbours are asked side by side.
pub(crate) const LANES: usize = 16;

/// How much a filled shift counts, against one that is an answer.
const FILLED: f32 = 0.2;

/// What the neighbours of pixels are known by, in planes with a border: so that every neighbour can be
/// asked, and as many pixels side by side as there are lanes.
#[derive(Clone, Debug, Default)]
pub(crate) struct NeighbourPlanes {
    width: usize,
    height: usize,
    border: usize,
    stride: usize,
    /// Shifts in pixels; beyond the image those of its rim.
    pub(crate) dx: Vec<f32>,
    /// How much each shift counts. Nothing lies outside the image, so nobody trusts it.
    pub(crate) trust: Vec<f32>,
    /// The guide's channels, in steps of 8 bits.
    pub(crate) channels: Vec<Vec<f32>>,
}

impl NeighbourPlanes {
    /// Takes in all that stays as it is while shifts move: the colours of the guide, and how far each
    /// shift is to be trusted, by whether it is an answer and how well its phases agree.
    pub(crate) fn take_in(
        &mut self,
        guide: &Guide,
        validity: &Array2<Validity>,
        coherence: &Array2<f32>,
        border: usize,
    ) {
        let (height, width) = validity.dim();
        let stride = width.next_multiple_of(LANES) + 2 * border;
        if (self.width, self.height, self.border) != (width, height, border) {
            (self.width, self.height) = (width, height);
            (self.border, self.stride) = (border, stride);
            self.channels.clear();
            self.dx = vec![0.0; stride * (height + 2 * border)];
            self.trust = self.dx.clone();
        }
        let numbers = self.trust.len();
        let channels = guide.channels();
        self.channels.resize_with(channels, || vec![0.0; numbers]);
        for (channel, plane) in self.channels.iter_mut().enumerate() {
            let greys = guide.plane(channel).par_chunks_exact(width);
            let rows = plane.par_chunks_exact_mut(stride).skip(border);
            rows.zip(greys).for_each(|(row, greys)| {
                for (value, grey) in row[border..].iter_mut().zip(greys) {
                    *value = f32::from(*grey);
                }
            });
        }
        let (Some(validity), Some(coherence)) = (validity.as_slice(), coherence.as_slice()) else {
            unreachable!("planes are made in row-major order")
        };
        let evidence = validity
            .par_chunks_exact(width)
            .zip(coherence.par_chunks_exact(width));
        let rows = self.trust.par_chunks_exact_mut(stride).skip(border);
        rows.zip(evidence).for_each(|(row, (validity, coherence))| {
            let evidence = validity.iter().zip(coherence);
            for (trust, (validity, coherence)) in row[border..].iter_mut().zip(evidence) {
                let found = if validity.is_valid() { 1.0 } else { FILLED };
                *trust = found * (0.5 + 0.5 * coherence.clamp(0.0, 1.0));
            }
        });
    }

    /// Takes in the shifts as they are now.
    pub(crate) fn take_shifts(&mut self, dx: ArrayView2<'_, f32>) {
        let (width, border) = (self.width, self.border);
        let Some(dx) = dx.to_slice() else {
            unreachable!("planes are made in row-major order")
        };
        let last = self.height - 1;
        self.dx
            .par_chunks_exact_mut(self.stride)
            .enumerate()
            .for_each(|(place, row)| {
                let y = place.saturating_sub(border).min(last);
                let own = &dx[y * width..][..width];
                row[..border].fill(own[0]);
                row[border..border + width].copy_from_slice(own);
                row[border + width..].fill(own[width - 1]);
            });
    }

    /// Numbers to a row of a plane.
    #[inline(always)]
    pub(crate) const fn stride(&self) -> usize {
        self.stride
    }

    /// Where a pixel lies in the planes.
    #[inline(always)]
    pub(crate) const fn place(&self, x: usize, y: usize) -> usize {
        (y + self.border) * self.stride + self.border + x
    }

    /// How far the colours of pixels side by side from one place on lie from those from another on, in
    /// the channel that differs most.
    #[inline(always)]
    pub(crate) fn colour_step<S: Simd>(&self, simd: S, here: usize, there: usize) -> S::f32s {
        let mut most = simd.splat_f32s(0.0);
        for channel in &self.channels {
            let (here, there) = (vector(simd, channel, here), vector(simd, channel, there));
            most = simd.max_f32s(most, simd.abs_f32s(simd.sub_f32s(here, there)));
        }
        most
    }
}

/// `exp(-rate x)` for `x >= 0` to 0.02, without a call: `(1 - rate x / 16)^16`.
#[inline(always)]
pub(crate) fn fade<S: Simd>(simd: S, x: S::f32s, rate: f32) -> S::f32s {
    let base = simd.negate_mul_add_e_f32s(x, simd.splat_f32s(rate / 16.0), simd.splat_f32s(1.0));
    sixteenth_power(simd, simd.max_f32s(base, simd.splat_f32s(0.0)))
}

/// `x^16`.
#[inline(always)]
pub(crate) fn sixteenth_power<S: Simd>(simd: S, x: S::f32s) -> S::f32s {
    let square = simd.mul_f32s(x, x);
    let fourth = simd.mul_f32s(square, square);
    let eighth = simd.mul_f32s(fourth, fourth);
    simd.mul_f32s(eighth, eighth)
}

/// The weights of neighbours by their distance, `exp(-(u^2 + v^2) / (2 sigma^2))` with `sigma_px`, of all
/// `(u, v)` from `-radius` to `radius` in steps of `step`, row by row; of `thinned` ones every second, as
/// the fields of one colour lie on a chessboard, the pixel's own among them.
pub(crate) fn neighbours(
    radius: usize,
    (step, thinned): (usize, bool),
    sigma_px: f32,
) -> Vec<Neighbour> {
    let reach = (radius / step * step).cast_signed();
    let steps = || (-reach..=reach).step_by(step);
    let weight =
        |u: isize, v: isize| (-((u * u + v * v) as f32) / (2.0 * sigma_px * sigma_px)).exp();
    steps()
        .flat_map(|v| {
            let asked = move |u: &isize| !thinned || (u + v) / step.cast_signed() % 2 == 0;
            steps().filter(asked).map(move |u| Neighbour {
                u,
                v,
                weight: weight(u, v),
            })
        })
        .collect()
}

/// A neighbour's place, counted from the pixel in columns and rows, and its weight by distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Neighbour {
    pub(crate) u: isize,
    pub(crate) v: isize,
    pub(crate) weight: f32,
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use pulp::Scalar;

    use super::*;

    proptest! {
        #[test]
        fn fading_is_nearly_exponential(t in 0.0f32..40.0) {
            prop_assert!((fade(Scalar, 10.0 * t, 0.1) - (-t).exp()).abs() < 0.02);
        }
    }
}
