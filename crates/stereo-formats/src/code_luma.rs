//! The luma of colours of 8 bits, for pictures that come faster than files.

use ndarray::{Array2, ArrayView2};
use pulp::{Arch, Simd, WithSimd};

/// Luma by the weights of ITU-R BT.601, from 0 (black) to 1 (white), of the codes as stored (gamma and all).
///
/// The weights are thousandths, so their sum is a whole number below 2^24, which `f32` holds exactly, and the luma is
/// the number nearest to the true one.
#[must_use]
pub fn luma_of_codes(codes: ArrayView2<'_, [u8; 3]>) -> Array2<f32> {
    let Some(packed) = codes.as_slice() else {
        return codes.mapv(luma);
    };
    let mut plane = Array2::zeros(codes.dim());
    if let Some(plane) = plane.as_slice_mut() {
        luma_into(packed, plane);
    }
    plane
}

/// The same, pixel by pixel into a plane that is there: as many as both have.
pub fn luma_into(codes: &[[u8; 3]], plane: &mut [f32]) {
    Arch::new().dispatch(Codes { codes, plane });
}

struct Codes<'a> {
    codes: &'a [[u8; 3]],
    plane: &'a mut [f32],
}

impl WithSimd for Codes<'_> {
    type Output = ();

    // The loop is compiled for the machine's vectors.
    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (plane, codes) in self.plane.iter_mut().zip(self.codes) {
            *plane = luma(*codes);
        }
    }
}

#[inline(always)]
fn luma([red, green, blue]: [u8; 3]) -> f32 {
    let thousandths = 299 * i32::from(red) + 587 * i32::from(green) + 114 * i32::from(blue);
    thousandths as f32 / 255_000.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::rec_601;

    /// Every colour of 8 bits has the luma that a sum in `f64` gives, to the bit.
    #[test]
    fn every_colour_has_the_luma_of_the_wide_sum() {
        for red in 0..=255 {
            let codes =
                Array2::from_shape_fn((256, 256), |(green, blue)| [red, green as u8, blue as u8]);
            let wide = codes.mapv(|rgb| rec_601(rgb, 255.0));
            assert_eq!(luma_of_codes(codes.view()), wide, "red {red}");
            // Of columns, which do not lie side by side.
            assert_eq!(luma_of_codes(codes.t()), wide.t(), "red {red}");
        }
    }
}
