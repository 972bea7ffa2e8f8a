use std::f32::consts::FRAC_PI_2;

use pulp::{Arch, Simd, WithSimd};

/// Side of the blocks whose noise is compared, in pixels.
const BLOCK: usize = 16;

/// The standard deviation of a picture's noise, in its own steps of 8 bits.
///
/// The difference of two Laplacians, `[[1 -2 1] [-2 4 -2] [1 -2 1]]`, is blind to what is linear along either
/// axis and answers white noise with six times its standard deviation (Immerkaer 1996). Texture answers
/// too, so that the block that counts is the quieter one of five: the fifth part of all blocks is quieter
/// still. `room` is kept from one picture to the next.
pub(crate) fn noise_level(plane: &[u8], width: usize, room: &mut Vec<f32>) -> f32 {
    room.clear();
    let rows = plane.len() / width;
    let mut sums = [0; BLOCK];
    for top in (1..rows.saturating_sub(BLOCK)).step_by(BLOCK) {
        for left in (1..width.saturating_sub(BLOCK)).step_by(BLOCK) {
            let corner = (top - 1) * width + left - 1;
            Arch::new().dispatch(Block {
                pixels: &plane[corner..],
                width,
                sums: &mut sums,
            });
            let sum: u32 = sums.iter().map(|&sum| u32::from(sum)).sum();
            room.push(sum as f32 / (BLOCK * BLOCK) as f32);
        }
    }
    if room.is_empty() {
        return 0.0;
    }
    let fifth = room.len() / 5;
    let (_, mean, _) = room.select_nth_unstable_by(fifth, f32::total_cmp);
    // The mean of what is normal, taken without its sign, is sqrt(2 / pi) of its standard deviation.
    *mean * FRAC_PI_2.sqrt() / 6.0
}

/// One block of a plane, and a pixel more on each side.
struct Block<'a> {
    pixels: &'a [u8],
    width: usize,
    /// What the columns of the block come to.
    sums: &'a mut [u16; BLOCK],
}

impl WithSimd for Block<'_> {
    type Output = ();

    // The loops are compiled for the machine's vectors.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        *self.sums = [0; BLOCK];
        for y in 0..BLOCK {
            let rows = [0, 1, 2].map(|down| &self.pixels[(y + down) * self.width..][..BLOCK + 2]);
            let mut columns = [0i16; BLOCK + 2];
            for x in 0..BLOCK + 2 {
                let [above, here, below] = rows.map(|row| i16::from(row[x]));
                columns[x] = above - 2 * here + below;
            }
            for x in 0..BLOCK {
                let answer = columns[x] - 2 * columns[x + 1] + columns[x + 2];
                self.sums[x] += answer.unsigned_abs();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Noise of a known level upon a slope, beside a third of coarse texture: within a sixth of the level, which is
        /// what the fifth part of two hundred blocks lies below their mean, and half a step of rounding.
        #[test]
        fn noise_is_told_from_slopes_and_texture(level in 0.0f32..12.0, seed in 1u64..u64::MAX) {
            let (width, height) = (256, 192);
            let mut state = seed;
            let mut uniform = move || {
                state ^= state << 13;
                state ^= state >> 7;
                state ^= state << 17;
                (state >> 40) as f32 / (1 << 24) as f32 - 0.5
            };
            let plane: Vec<u8> = (0..width * height)
                .map(|place| {
                    let (x, y) = ((place % width) as f32, (place / width) as f32);
                    let texture = if x < 85.0 { 40.0 * (x * 0.9).sin() * (y * 1.1).cos() } else { 0.0 };
                    // The sum of twelve is nearly normal, with a variance of one.
                    let noise: f32 = (0..12).map(|_| uniform()).sum();
                    (110.0 + 0.1 * x + 0.07 * y + texture + level * noise).round() as u8
                })
                .collect();
            let found = noise_level(&plane, width, &mut Vec::new());
            prop_assert!((found - level).abs() < level / 6.0 + 0.5, "{found} for {level}");
        }
    }
}
