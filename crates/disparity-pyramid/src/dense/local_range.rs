use ndarray::{Array2, ArrayView2, Axis};
use rayon::prelude::*;

/// Pixels on either side that belong to the neighbourhood.
const REACH: usize = 2;

/// The largest difference between two shifts within 5 x 5 pixels of each pixel: small on one
/// surface, large at its end.
pub(crate) fn local_range(dx: ArrayView2<'_, f32>) -> Array2<f32> {
    let (height, width) = dx.dim();
    let mut range = Array2::zeros((height, width));
    range
        .axis_iter_mut(Axis(0))
        .into_par_iter()
        .enumerate()
        .for_each_init(
            || (vec![0.0f32; width], vec![0.0f32; width]),
            |(least, most), (y, mut range)| {
                least.fill(f32::INFINITY);
                most.fill(f32::NEG_INFINITY);
                for row in y.saturating_sub(REACH)..=(y + REACH).min(height - 1) {
                    for ((least, most), dx) in least.iter_mut().zip(&mut *most).zip(dx.row(row)) {
                        *least = least.min(*dx);
                        *most = most.max(*dx);
                    }
                }
                for (x, range) in range.iter_mut().enumerate() {
                    let span = x.saturating_sub(REACH)..(x + REACH + 1).min(width);
                    let lowest = least[span.clone()]
                        .iter()
                        .copied()
                        .fold(f32::INFINITY, f32::min);
                    let highest = most[span].iter().copied().fold(f32::NEG_INFINITY, f32::max);
                    *range = highest - lowest;
                }
            },
        );
    range
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
