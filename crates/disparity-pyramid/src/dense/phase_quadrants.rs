use rayon::prelude::*;
use v1_gabor::{Binocular, FilterBank, LumaImage, WrongSize};

use crate::SearchRange;
use crate::dense::bands::bands;
use crate::dense::bank_rows::BankRows;
use crate::dense::padding::Padding;
use crate::dense::phase_agreement::COST_ORIENTATIONS;
use crate::dense::pixel_cost::{PixelCost, RowCost};
use crate::dense::wide::Wide;

/// Least amplitude of an orientation that is heard.
const HEARD_AMPLITUDE: f32 = 1e-3;

/// One bit of each orientation's two.
const HALF: u8 = 0b0101_0101;

/// The Hamming distance of the phases' quadrants: a rough phase agreement from two bytes a pixel.
///
/// An orientation that is silent in either eye says nothing, and costs one bit of its two.
#[derive(Clone, Debug, Default)]
pub(crate) struct PhaseQuadrants {
    eyes: Binocular<QuadrantCodes>,
    padding: Padding,
    /// What a unit of cost is: four bits that differ.
    unit: u8,
}

/// Codes `[[y, padded x]]`: two bits an orientation, the signs of its even and its odd part, and
/// whether it is heard.
#[derive(Clone, Debug, Default)]
struct QuadrantCodes {
    stride: usize,
    quadrants: Vec<u8>,
    heard: Vec<u8>,
}

impl PhaseQuadrants {
    /// Takes in what a bank of [`COST_ORIENTATIONS`] orientations says of both eyes. `unit` is what a
    /// unit of cost is.
    ///
    /// # Errors
    /// [`WrongSize`] if the bank was planned for others.
    pub(crate) fn take_in(
        &mut self,
        bank: &FilterBank,
        eyes: Binocular<&LumaImage>,
        search: SearchRange,
        unit: u8,
        rooms: &mut Vec<BankRows>,
    ) -> Result<(), WrongSize> {
        self.padding = Padding::of(search);
        self.unit = unit;
        let Binocular { left, right } = &mut self.eyes;
        left.take_in(bank, eyes.left, self.padding, rooms)?;
        right.take_in(bank, eyes.right, self.padding, rooms)
    }
}

impl PixelCost for PhaseQuadrants {
    type Row<'a> = QuadrantRow<'a>;

    #[inline(always)]
    fn row(&self, y: usize) -> QuadrantRow<'_> {
        QuadrantRow {
            cost: self,
            start: y * self.eyes.left.stride,
        }
    }

    fn change_eyes(&mut self) {
        let Binocular { left, right } = &mut self.eyes;
        std::mem::swap(left, right);
        left.mirror(self.padding);
        right.mirror(self.padding);
    }
}

/// The codes of both eyes from one row on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QuadrantRow<'a> {
    cost: &'a PhaseQuadrants,
    start: usize,
}

impl RowCost for QuadrantRow<'_> {
    #[inline(always)]
    fn costs<W: Wide>(self, _: W, x: usize, first: usize, costs: &mut [u8]) {
        let PhaseQuadrants {
            eyes,
            padding,
            unit,
        } = self.cost;
        let (left, right) = (&eyes.left, &eyes.right);
        let place = self.start + padding.place(x);
        let (quadrants, heard) = (left.quadrants[place], left.heard[place]);
        let unit = u16::from(*unit);
        let first = self.start + padding.first(x) + first;
        let run = first..first + costs.len();
        let others = right.quadrants[run.clone()].iter().zip(&right.heard[run]);
        for (cost, (&other, &other_heard)) in costs.iter_mut().zip(others) {
            let both = heard & other_heard;
            let differing = ((quadrants ^ other) & both) | (!both & HALF);
            *cost = ((differing.count_ones() as u16 * unit) >> 2) as u8;
        }
    }
}

impl QuadrantCodes {
    fn take_in(
        &mut self,
        bank: &FilterBank,
        eye: &LumaImage,
        padding: Padding,
        rooms: &mut Vec<BankRows>,
    ) -> Result<(), WrongSize> {
        let size = bank.size();
        let stride = padding.stride(size.width);
        self.stride = stride;
        self.quadrants.resize(size.height * stride, 0);
        self.heard.resize(size.height * stride, 0);
        let (rooms, rows) = bands(rooms, size.height);
        let bands = self
            .quadrants
            .par_chunks_mut(rows * stride)
            .zip(self.heard.par_chunks_mut(rows * stride))
            .zip(rooms)
            .enumerate();
        bands.try_for_each(|(band, ((quadrants, heard), room))| {
            let codes = quadrants
                .chunks_exact_mut(stride)
                .zip(heard.chunks_exact_mut(stride));
            for (y, (quadrants, heard)) in (band * rows..).zip(codes) {
                let row = room.row(bank, eye, y)?;
                for (x, pixel) in row.chunks_exact(2 * COST_ORIENTATIONS).enumerate() {
                    let (mut quadrant, mut loud) = (0, 0);
                    for q in 0..COST_ORIENTATIONS {
                        let (even, odd) = (pixel[q], pixel[COST_ORIENTATIONS + q]);
                        let code = u8::from(even > 0.0) | u8::from(odd > 0.0) << 1;
                        let energy = even * even + odd * odd;
                        let heard = energy > HEARD_AMPLITUDE * HEARD_AMPLITUDE;
                        quadrant |= code << (2 * q);
                        loud |= (0b11 * u8::from(heard)) << (2 * q);
                    }
                    let place = padding.place(x);
                    (quadrants[place], heard[place]) = (quadrant, loud);
                }
                padding.replicate(quadrants);
                padding.replicate(heard);
            }
            Ok(())
        })
    }

    /// Exchanges left and right.
    fn mirror(&mut self, padding: Padding) {
        for plane in [&mut self.quadrants, &mut self.heard] {
            plane
                .par_chunks_mut(self.stride)
                .for_each(|row| padding.mirror(row));
        }
    }
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;
    use proptest::prelude::*;
    use v1_gabor::{GaborParams, Size};

    use super::*;
    use crate::dense::pixel_cost::LANES;
    use crate::dense::wide::Plain;

    /// The two signs of a response, whether it is heard, and whether a last bit could decide either.
    fn quadrant(even: f32, odd: f32) -> (bool, bool, bool, bool) {
        let amplitude = even.hypot(odd);
        let close = even.abs().min(odd.abs()) < 1e-6 || (amplitude - 1e-3).abs() < 1e-6;
        (even > 0.0, odd > 0.0, amplitude > 1e-3, close)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// Bits that are counted in bytes are those that differ orientation by orientation, with the eyes
        /// exchanged too.
        #[test]
        fn fast_and_plain_agree(
            width in 1usize..40, height in 1usize..5, least in -30i32..10, more in 0i32..40,
            unit in 5u8..=30, contrast in 0usize..2, seed: u64,
        ) {
            let size = Size { width, height };
            let mut state = seed | 1;
            // With little contrast many orientations are silent.
            let contrast = [1.0, 0.01][contrast];
            let mut see = || {
                LumaImage::new(Array2::from_shape_simple_fn(size.dim(), || {
                    state ^= state << 13;
                    state ^= state >> 7;
                    state ^= state << 17;
                    contrast * ((state >> 20) % 256) as f32 / 255.0
                }))
                .unwrap()
            };
            let (left, right) = (see(), see());
            let params =
                GaborParams { orientations: COST_ORIENTATIONS, scales: 1, ..GaborParams::default() };
            let bank = FilterBank::plan(params, size).unwrap();
            let search = SearchRange::new(least, least + more).unwrap();
            let eyes = Binocular { left: &left, right: &right };
            let mut cost = PhaseQuadrants::default();
            cost.take_in(&bank, eyes, search, unit, &mut Vec::new()).unwrap();
            let (left, right) = (bank.respond(&left).unwrap(), bank.respond(&right).unwrap());
            let mut costs = vec![0; search.shifts().next_multiple_of(LANES)];
            for changed in [false, true] {
                if changed {
                    cost.change_eyes();
                }
                for y in 0..height {
                    for x in 0..width {
                        cost.row(y).costs(Plain, x, 0, &mut costs);
                        for (dx, cost) in (least..=least + more).zip(&costs) {
                            let seen = (x as i32 + dx).clamp(0, width as i32 - 1) as usize;
                            let (own, other) = match changed {
                                false => ((&left, x), (&right, seen)),
                                true => ((&right, width - 1 - x), (&left, width - 1 - seen)),
                            };
                            let (mut bits, mut close) = (0, false);
                            for q in 0..COST_ORIENTATIONS {
                                let [own, other] = [own, other].map(|(eye, x)| {
                                    let heard = eye.scales()[0].at(q, x, y);
                                    quadrant(heard.re, heard.im)
                                });
                                close |= own.3 || other.3;
                                bits += match own.2 && other.2 {
                                    true => u16::from(own.0 != other.0) + u16::from(own.1 != other.1),
                                    false => 1,
                                };
                            }
                            let want = bits * u16::from(unit) / 4;
                            prop_assert!(u16::from(*cost) == want || close, "{cost}, {want}");
                        }
                    }
                }
            }
        }
    }
}
