use rayon::prelude::*;
use v1_gabor::{Binocular, FilterBank, LumaImage, WrongSize};

use crate::SearchRange;
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
#[derive(Debug)]
pub(crate) struct PhaseQuadrants {
    eyes: Binocular<QuadrantCodes>,
    padding: Padding,
    /// What a unit of cost is: four bits that differ.
    unit: u8,
}

/// Codes `[[y, padded x]]`: two bits an orientation, the signs of its even and its odd part, and
/// whether it is heard.
#[derive(Clone, Debug)]
struct QuadrantCodes {
    stride: usize,
    quadrants: Vec<u8>,
    heard: Vec<u8>,
}

impl PhaseQuadrants {
    /// What a bank of [`COST_ORIENTATIONS`] orientations says of both eyes. `unit` is what a unit of
    /// cost is.
    ///
    /// # Errors
    /// [`WrongSize`] if the bank was planned for others.
    pub(crate) fn new(
        bank: &FilterBank,
        eyes: Binocular<&LumaImage>,
        search: SearchRange,
        unit: u8,
    ) -> Result<Self, WrongSize> {
        let padding = Padding::of(search);
        Ok(Self {
            eyes: eyes.try_map(|eye| QuadrantCodes::of(bank, eye, padding))?,
            padding,
            unit,
        })
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

    fn seen_by_the_other_eye(&self) -> Self {
        Self {
            eyes: Binocular {
                left: self.eyes.right.mirrored(self.padding),
                right: self.eyes.left.mirrored(self.padding),
            },
            ..*self
        }
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
    fn of(bank: &FilterBank, eye: &LumaImage, padding: Padding) -> Result<Self, WrongSize> {
        let size = bank.size();
        let stride = padding.stride(size.width);
        let mut quadrants = vec![0; size.height * stride];
        let mut heard = vec![0; size.height * stride];
        (
            quadrants.par_chunks_mut(stride),
            heard.par_chunks_mut(stride),
        )
            .into_par_iter()
            .enumerate()
            .try_for_each_init(
                || BankRows::of(bank),
                |space, (y, (quadrants, heard))| {
                    let row = space.row(bank, eye, y)?;
                    for (x, pixel) in row.chunks_exact(2 * COST_ORIENTATIONS).enumerate() {
                        let place = padding.place(x);
                        for q in 0..COST_ORIENTATIONS {
                            let (even, odd) = (pixel[q], pixel[COST_ORIENTATIONS + q]);
                            let code = u8::from(even > 0.0) | u8::from(odd > 0.0) << 1;
                            let loud = even * even + odd * odd > HEARD_AMPLITUDE * HEARD_AMPLITUDE;
                            quadrants[place] |= code << (2 * q);
                            heard[place] |= (0b11 * u8::from(loud)) << (2 * q);
                        }
                    }
                    padding.replicate(quadrants);
                    padding.replicate(heard);
                    Ok(())
                },
            )?;
        Ok(Self {
            stride,
            quadrants,
            heard,
        })
    }

    fn mirrored(&self, padding: Padding) -> Self {
        let mut mirrored = self.clone();
        for plane in [&mut mirrored.quadrants, &mut mirrored.heard] {
            plane
                .par_chunks_mut(self.stride)
                .for_each(|row| padding.mirror(row));
        }
        mirrored
    }
}
