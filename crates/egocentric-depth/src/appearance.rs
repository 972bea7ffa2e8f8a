use ndarray::{Array2, ArrayView2, s};

/// How far on either side of a pixel colours are averaged: over the speckles of a texture.
const REACH: usize = 2;

/// Where the colours of a picture change.
#[derive(Clone, Debug)]
pub(crate) struct Contrast {
    /// Mean colours of 5 x 5 pixels, each channel from 0 to 1.
    mean: Array2<[f32; 3]>,
}

impl Contrast {
    pub(crate) fn of(rgb: ArrayView2<'_, [u8; 3]>) -> Self {
        let (height, width) = rgb.dim();
        let window =
            |at: usize, length: usize| at.saturating_sub(REACH)..(at + REACH + 1).min(length);
        let along_rows = Array2::from_shape_fn((height, width), |(y, x)| {
            mean(
                rgb.slice(s![y, window(x, width)])
                    .iter()
                    .map(|rgb| rgb.map(|c| f32::from(c) / 255.0)),
            )
        });
        let mean = Array2::from_shape_fn((height, width), |(y, x)| {
            mean(along_rows.slice(s![window(y, height), x]).iter().copied())
        });
        Self { mean }
    }

    /// How the colours on either side of the step from one pixel to another differ, from 0 to 1. The
    /// pixels lie on one row or one column.
    pub(crate) fn across(&self, (x, y): (usize, usize), (to_x, to_y): (usize, usize)) -> f32 {
        let (height, width) = self.mean.dim();
        let back = |from: usize, to: usize| match from.cmp(&to) {
            std::cmp::Ordering::Less => from.saturating_sub(REACH),
            std::cmp::Ordering::Equal => from,
            std::cmp::Ordering::Greater => from + REACH,
        };
        let here = [back(y, to_y).min(height - 1), back(x, to_x).min(width - 1)];
        let there = [back(to_y, y).min(height - 1), back(to_x, x).min(width - 1)];
        let (a, b) = (self.mean[here], self.mean[there]);
        let square: f32 = a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum();
        (square / 3.0).sqrt()
    }
}

fn mean(colours: impl Iterator<Item = [f32; 3]>) -> [f32; 3] {
    let (mut sum, mut count) = ([0.0; 3], 0.0f32);
    for colour in colours {
        for (sum, channel) in sum.iter_mut().zip(colour) {
            *sum += channel;
        }
        count += 1.0;
    }
    sum.map(|sum| sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_change_at_an_edge_and_nowhere_else() {
        let picture =
            Array2::from_shape_fn((9, 30), |(_, x)| if x < 15 { [0u8; 3] } else { [255; 3] });
        let contrast = Contrast::of(picture.view());
        assert_eq!(contrast.across((5, 4), (6, 4)), 0.0);
        assert_eq!(contrast.across((14, 4), (14, 5)), 0.0);
        let right = contrast.across((14, 4), (15, 4));
        // Of the five columns about 12 none is white, of those about 17 all are.
        assert_eq!(right, 1.0);
        assert_eq!(contrast.across((15, 4), (14, 4)), right);
        assert_eq!(contrast.across((29, 8), (28, 8)), 0.0);
    }
}
