use ndarray::{Array2, ArrayView2};
use rayon::prelude::*;

/// Pixels on either side that belong to the neighbourhood.
const REACH: usize = 2;

/// The largest difference between two shifts within 5 x 5 pixels of each pixel: small on one
/// surface, large at its end.
pub(crate) fn local_range(dx: ArrayView2<'_, f32>) -> Array2<f32> {
    let (height, width) = dx.dim();
    let mut range = Array2::zeros((height, width));
    let dx = dx.to_slice().expect(CONTIGUOUS);
    range
        .as_slice_mut()
        .expect(CONTIGUOUS)
        .par_chunks_mut(width)
        .enumerate()
        .for_each_init(
            || {
                let columns = width + 2 * REACH;
                let least = vec![f32::INFINITY; columns];
                (least, vec![f32::NEG_INFINITY; columns], vec![0.0; width])
            },
            |(least, most, lowest), (y, range)| {
                least[REACH..][..width].fill(f32::INFINITY);
                most[REACH..][..width].fill(f32::NEG_INFINITY);
                for row in y.saturating_sub(REACH)..=(y + REACH).min(height - 1) {
                    let columns = least[REACH..].iter_mut().zip(&mut most[REACH..]);
                    let row = &dx[row * width..(row + 1) * width];
                    for ((least, most), dx) in columns.zip(row) {
                        *least = lesser(*least, *dx);
                        *most = -lesser(-*most, -*dx);
                    }
                }
                lowest.fill(f32::INFINITY);
                range.fill(f32::NEG_INFINITY);
                for offset in 0..=2 * REACH {
                    for (lowest, least) in lowest.iter_mut().zip(&least[offset..]) {
                        *lowest = lesser(*lowest, *least);
                    }
                    for (range, most) in range.iter_mut().zip(&most[offset..]) {
                        *range = -lesser(-*range, -*most);
                    }
                }
                for (range, lowest) in range.iter_mut().zip(lowest) {
                    *range -= *lowest;
                }
            },
        );
    range
}

const CONTIGUOUS: &str = "planes are made in row-major order";

/// The lesser of two numbers: one instruction, since no shift is NaN.
#[inline(always)]
fn lesser(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_is_felt_two_pixels_away() {
        let dx = Array2::from_shape_fn((6, 12), |(_, x)| if x < 6 { -1.0 } else { -4.0 });
        for ((_, x), range) in local_range(dx.view()).indexed_iter() {
            assert_eq!(
                *range,
                if (4..8).contains(&x) { 3.0 } else { 0.0 },
                "column {x}"
            );
        }
    }
}
