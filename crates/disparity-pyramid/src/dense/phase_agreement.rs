use rayon::prelude::*;
use v1_gabor::{Binocular, Responses};

use crate::SearchRange;
use crate::dense::padding::Padding;
use crate::dense::pixel_cost::{LANES, PixelCost};

/// Orientations of the bank that the cost is taken from: more change nothing.
pub(crate) const COST_ORIENTATIONS: usize = 4;

/// Even and odd parts of all orientations.
const PARTS: usize = 2 * COST_ORIENTATIONS;

/// The largest modulus of a coded response. The sum over the orientations of the product of two of
/// them, rounding of the parts included, stays within 15 bits.
const FULL: f32 = 89.0;

/// The energy of position-shifted binocular cells:
/// `C(x, dx) = 1 - sum_q Re(u_q^L(x) conj u_q^R(x + dx))`, from 0 (all phases agree) to 2.
///
/// The responses are normalised channel by channel, `u_q = Q_q / sqrt(|Q_q|^2 + eps) / sqrt K`, to
/// nearly pure phase: a gain or an offset between the cameras drops out. No angle is computed; the
/// real part of the product is the cosine of the phase difference. Sixteen shifts are compared side
/// by side in 16-bit integers, which hold the sum exactly.
#[derive(Debug)]
pub(crate) struct PhaseAgreement {
    eyes: Binocular<NormalisedResponses>,
    padding: Padding,
}

/// Normalised responses `[[y, part, padded x]]`, in units of 1 / (2 FULL).
#[derive(Clone, Debug)]
struct NormalisedResponses {
    stride: usize,
    parts: Vec<i16>,
}

impl PhaseAgreement {
    /// Takes the finest responses of both eyes, of [`COST_ORIENTATIONS`] orientations each.
    pub(crate) fn new(
        eyes: Binocular<&Responses>,
        silent_energy: f32,
        search: SearchRange,
    ) -> Self {
        let padding = Padding::of(search);
        Self {
            eyes: eyes.map(|eye| NormalisedResponses::of(eye, silent_energy, padding)),
            padding,
        }
    }
}

impl PixelCost for PhaseAgreement {
    #[inline(always)]
    fn costs(&self, x: usize, y: usize, costs: &mut [u8]) {
        let reference = self.eyes.left.pixel(self.padding.place(x), y);
        let first = self.padding.first(x);
        let others: [&[[i16; LANES]]; PARTS] = std::array::from_fn(|part| {
            let run = self.eyes.right.row(y, part);
            run[first..first + costs.len()].as_chunks().0
        });
        let blocks = costs.as_chunks_mut::<LANES>().0;
        for part in others {
            // Known lengths keep the loop below free of checks.
            assert_eq!(part.len(), blocks.len());
        }
        for (block, costs) in blocks.iter_mut().enumerate() {
            let mut agreement = [0i16; LANES];
            for part in 0..PARTS {
                let other = &others[part][block];
                for lane in 0..LANES {
                    let product = reference[part].wrapping_mul(other[lane]);
                    agreement[lane] = agreement[lane].wrapping_add(product);
                }
            }
            for lane in 0..LANES {
                // From 0 to 2 in 16 bits, of which the upper 7 are kept.
                costs[lane] = (i16::MAX.wrapping_sub(agreement[lane]) as u16 >> 9) as u8;
            }
        }
    }

    fn from_the_other_eye(&self) -> Self {
        Self {
            eyes: Binocular {
                left: self.eyes.right.mirrored(self.padding),
                right: self.eyes.left.mirrored(self.padding),
            },
            padding: self.padding,
        }
    }
}

impl NormalisedResponses {
    fn of(responses: &Responses, silent_energy: f32, padding: Padding) -> Self {
        let size = responses.size();
        let stride = padding.stride(size.width);
        let mut parts = vec![0; size.height * PARTS * stride];
        parts
            .par_chunks_mut(PARTS * stride)
            .enumerate()
            .for_each(|(y, rows)| {
                for x in 0..size.width {
                    let pixel = responses.pixel(x, y);
                    for q in 0..COST_ORIENTATIONS {
                        let (even, odd) = (pixel.even[q], pixel.odd[q]);
                        let energy = even * even + odd * odd;
                        // Silence over silence is silence.
                        let gain = FULL / (energy + silent_energy).max(f32::MIN_POSITIVE).sqrt();
                        let place = padding.place(x);
                        rows[q * stride + place] = (even * gain).round() as i16;
                        rows[(COST_ORIENTATIONS + q) * stride + place] =
                            (odd * gain).round() as i16;
                    }
                }
                for row in rows.chunks_mut(stride) {
                    padding.replicate(row);
                }
            });
        Self { stride, parts }
    }

    #[inline(always)]
    fn row(&self, y: usize, part: usize) -> &[i16] {
        let start = (y * PARTS + part) * self.stride;
        &self.parts[start..start + self.stride]
    }

    #[inline(always)]
    fn pixel(&self, place: usize, y: usize) -> [i16; PARTS] {
        std::array::from_fn(|part| self.parts[(y * PARTS + part) * self.stride + place])
    }

    fn mirrored(&self, padding: Padding) -> Self {
        let mut mirrored = self.clone();
        mirrored
            .parts
            .par_chunks_mut(self.stride)
            .for_each(|row| padding.mirror(row));
        mirrored
    }
}
