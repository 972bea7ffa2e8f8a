use ndarray::Array2;
use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;
use v1_gabor::Size;

use crate::Validity;
use crate::grid::Grid;
use crate::shifts::Shifts;

/// Follows each valid shift to the other eye and back. Where the way does not come back to within
/// `tolerance_px`, the pixel is occluded if the other eye sees something nearer there, and
/// inconsistent if not. The way there is known at the pixels of a grid over an image of `size`, the way
/// back at those of one over the scale `scale`, 0 being that of the way there.
///
/// What is nearer has the larger `dx` seen from the right eye, so a way back that overshoots to the
/// right (`dx` there plus `dx` back above 0) belongs to something nearer.
///
/// The other eye's best guess counts even where it does not stand behind it: a guess that leads back
/// to the start is evidence however it came about. What is refused has no confidence any more.
pub(crate) fn check(
    (there, grid): (&mut Shifts, Grid),
    confidence: &mut Array2<f32>,
    (back, scale, back_grid): (&Shifts, usize, Grid),
    (size, tolerance_px): (Size, f32),
) {
    let width = grid.size.width;
    let (back_dx, back_dy) = (numbers(&back.dx), numbers(&back.dy));
    there
        .validity
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width)
        .zip(
            confidence
                .as_slice_mut()
                .expect(CONTIGUOUS)
                .par_chunks_mut(width),
        )
        .zip(numbers(&there.dx).par_chunks(width))
        .zip(numbers(&there.dy).par_chunks(width))
        .enumerate()
        .for_each(|(y, (((validity, confidence), dx), dy))| {
            Arch::new().dispatch(Row {
                y,
                grid,
                size,
                there: (dx, dy),
                back: (back_dx, back_dy),
                back_grid,
                scale,
                tolerance_px,
                validity,
                confidence,
            });
        });
}

/// Pixels that each step of the check treats before the next step begins, so that the steps but the
/// gathering are loops without a branch.
const CHUNK: usize = 64;

/// What the check of a row has to know.
struct Row<'a> {
    /// The row's number among those that are fitted.
    y: usize,
    grid: Grid,
    /// Of the image.
    size: Size,
    /// Where the way there leads from each pixel of the row, by component.
    there: (&'a [f32], &'a [f32]),
    /// Where the way back leads, by component, in pixels of its scale.
    back: (&'a [f32], &'a [f32]),
    back_grid: Grid,
    scale: usize,
    tolerance_px: f32,
    validity: &'a mut [Validity],
    confidence: &'a mut [f32],
}

impl WithSimd for Row<'_> {
    type Output = ();

    // The loops are compiled for the machine's vectors.
    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        let validity = std::mem::take(&mut self.validity);
        let confidence = std::mem::take(&mut self.confidence);
        let chunks = validity.chunks_mut(CHUNK).zip(confidence.chunks_mut(CHUNK));
        for (chunk, (validity, confidence)) in chunks.enumerate() {
            let start = chunk * CHUNK;
            let here = start..start + validity.len();
            let there = (&self.there.0[here.clone()], &self.there.1[here]);
            self.check(start, there, validity, confidence);
        }
    }
}

impl Row<'_> {
    /// Checks a few neighbouring pixels, the first one being at `x`.
    #[inline(always)]
    fn check(
        &self,
        x: usize,
        (dx, dy): (&[f32], &[f32]),
        validity: &mut [Validity],
        confidence: &mut [f32],
    ) {
        let Size { width, height } = self.size;
        let (most_x, most_y) = (width as f32 - 0.5, height as f32 - 0.5);
        let grow = 2.0f32.powi(self.scale as i32);
        let shrink = 1.0 / (grow * self.back_grid.step as f32);
        let back = self.back_grid.size;
        let y = (self.y * self.grid.step) as f32;
        let (mut places, mut inside) = ([0u32; CHUNK], [false; CHUNK]);
        let ends = places.iter_mut().zip(&mut inside).zip(dx.iter().zip(dy));
        for (i, ((place, inside), (&dx, &dy))) in ends.enumerate() {
            let (u, v) = (((x + i) * self.grid.step) as f32 + dx, y + dy);
            *inside = (u >= -0.5) & (v >= -0.5) & (u < most_x) & (v < most_y);
            let (column, row) = (
                nearest(u * shrink, back.width),
                nearest(v * shrink, back.height),
            );
            *place = row * back.width as u32 + column;
        }
        let (mut back_dx, mut back_dy) = ([0.0; CHUNK], [0.0; CHUNK]);
        let ends = back_dx
            .iter_mut()
            .zip(&mut back_dy)
            .zip(&places[..dx.len()]);
        for ((back_dx, back_dy), &place) in ends {
            *back_dx = self.back.0[place as usize];
            *back_dy = self.back.1[place as usize];
        }
        let (mut returns, mut nearer) = ([false; CHUNK], [false; CHUNK]);
        let ways = dx.iter().zip(dy).zip(back_dx.iter().zip(&back_dy));
        let found = returns.iter_mut().zip(&mut nearer);
        for ((returns, nearer), ((dx, dy), (back_dx, back_dy))) in found.zip(ways) {
            let (miss_x, miss_y) = (dx + grow * back_dx, dy + grow * back_dy);
            let miss = miss_x * miss_x + miss_y * miss_y;
            *returns = miss <= self.tolerance_px * self.tolerance_px;
            *nearer = miss_x > 0.0;
        }
        let found = inside.iter().zip(returns.iter().zip(&nearer));
        for (validity, (&inside, (&returns, &nearer))) in validity.iter_mut().zip(found) {
            let refusal = if nearer {
                Validity::Occluded
            } else {
                Validity::Inconsistent
            };
            let verdict = if returns { Validity::Valid } else { refusal };
            let verdict = if inside { verdict } else { Validity::OutOfView };
            // What is unknown already keeps its reason.
            *validity = if validity.is_valid() {
                verdict
            } else {
                *validity
            };
        }
        for (confidence, validity) in confidence.iter_mut().zip(validity) {
            *confidence = if validity.is_valid() {
                *confidence
            } else {
                0.0
            };
        }
    }
}

/// The whole number nearest to a place, of those below `length`; the ends for what lies beyond.
#[inline(always)]
fn nearest(at: f32, length: usize) -> u32 {
    // Adding 2^23 leaves the nearest whole number in the lowest bits.
    const ROUNDER: f32 = 8_388_608.0;
    let at = at.clamp(0.0, (length - 1) as f32);
    (at + ROUNDER).to_bits() - ROUNDER.to_bits()
}

const CONTIGUOUS: &str = "planes are made in row-major order";

fn numbers(plane: &Array2<f32>) -> &[f32] {
    plane.as_slice().expect(CONTIGUOUS)
}
