use ndarray::{Array2, ArrayView2};

/// Least mean of the squared difference between neighbours on a row, in grey levels squared: two
/// levels of 256 a pixel.
const LEAST_SQUARED_STEP: f64 = 4.0;

/// Which pixels `[[y, x]]` of a picture (red, green, blue from 0 to 255) stand in texture: the
/// squared difference to the right neighbour, averaged over the channels and over the 3 x 3
/// pixels around, is at least four grey levels squared.
///
/// The last column has no right neighbour and counts as its left one; outside the picture nothing
/// is averaged.
pub(crate) fn textured(rgb: ArrayView2<'_, [u8; 3]>) -> Array2<bool> {
    let (height, width) = rgb.dim();
    let steps = Array2::from_shape_fn((height, width), |(y, x)| {
        let x = x.min(width.saturating_sub(2));
        let right = (x + 1).min(width - 1);
        let squares = rgb[[y, x]]
            .iter()
            .zip(rgb[[y, right]])
            .map(|(&here, there)| {
                let step = f64::from(here) - f64::from(there);
                step * step
            });
        squares.sum::<f64>() / 3.0
    });
    Array2::from_shape_fn((height, width), |(y, x)| {
        let around = steps.slice(ndarray::s![
            y.saturating_sub(1)..(y + 2).min(height),
            x.saturating_sub(1)..(x + 2).min(width)
        ]);
        around.sum() / around.len() as f64 >= LEAST_SQUARED_STEP
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_grey_levels_a_pixel_are_texture() {
        let ramp = |step: u8| Array2::from_shape_fn((4, 9), |(_, x)| [100 + step * x as u8; 3]);
        assert!(textured(ramp(2).view()).iter().all(|&textured| textured));
        assert!(textured(ramp(1).view()).iter().all(|&textured| !textured));
        // The mean over the channels: one channel at 4 levels squared by three is 16/3.
        let red = Array2::from_shape_fn((4, 9), |(_, x)| [100 + 4 * x as u8, 100, 100]);
        assert!(textured(red.view()).iter().all(|&textured| textured));
    }

    #[test]
    fn an_edge_reaches_one_pixel_to_either_side() {
        let edge = Array2::from_shape_fn((3, 8), |(_, x)| [if x < 4 { 0 } else { 90 }; 3]);
        let row = textured(edge.view()).row(1).to_vec();
        // The step is counted at column 3, the left one of its two.
        let want = [false, false, true, true, true, false, false, false];
        assert_eq!(row, want);
    }

    #[test]
    fn one_column_is_without_texture() {
        let column = Array2::from_shape_fn((5, 1), |(y, _)| [50 * y as u8; 3]);
        assert!(textured(column.view()).iter().all(|&textured| !textured));
    }
}
