use ndarray::{Array2, ArrayView2, Zip};
use v1_gabor::LumaImage;

use crate::DisparityField;

/// Which row of the right image belongs to each row of the left one, for a pair that is not quite
/// rectified: `y_R = offset + shear x_R + scale y_L`.
///
/// Two cameras that are turned a little against one another, zoom differently or sit at different
/// heights see points of one row on such lines, whatever the depth. Eyes that converge strongly
/// need the relative orientation instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowAlignment {
    offset_px: f64,
    shear: f64,
    scale: f64,
    residual_px: f64,
}

impl RowAlignment {
    /// A pair whose residual vertical disparity is above this is poorly matched row by row, in
    /// pixels.
    pub const MOST_RESIDUAL_PX: f64 = 0.2;

    /// The lines that the valid vertical disparities of a vector field agree on: least squares,
    /// reweighted by Cauchy's function. `None` if fewer than a hundred pixels are valid, or they
    /// lie on a line.
    #[must_use]
    pub fn fit(field: &DisparityField) -> Option<Self> {
        const ROUNDS: usize = 15;
        const CAUCHY_PX: f64 = 0.15;
        const LEAST_PIXELS: usize = 100;
        let size = field.size();
        // The centre, so that offset and slopes do not mix.
        let (centre_x, centre_y) = (size.width as f64 / 2.0, size.height as f64 / 2.0);
        let mut points = Vec::new();
        for ((y, x), dx) in field.dx().indexed_iter() {
            if field.validity()[[y, x]].is_valid() {
                let dy = f64::from(field.dy()[[y, x]]);
                points.push((
                    x as f64 + f64::from(*dx) - centre_x,
                    y as f64 - centre_y,
                    dy,
                ));
            }
        }
        if points.len() < LEAST_PIXELS {
            return None;
        }
        // dy = c0 + c1 u + c2 v with (u, v) from the centre.
        let mut line = [median(points.iter().map(|point| point.2)), 0.0, 0.0];
        let mut residual = 0.0;
        for _ in 0..ROUNDS {
            let mut sums = [[0.0; 4]; 3];
            let (mut squares, mut weights) = (0.0, 0.0);
            for &(u, v, dy) in &points {
                let row = [1.0, u, v];
                let miss = dy - line[0] - line[1] * u - line[2] * v;
                let weight = 1.0 / (1.0 + (miss / CAUCHY_PX).powi(2));
                squares += weight * miss * miss;
                weights += weight;
                for i in 0..3 {
                    for j in 0..3 {
                        sums[i][j] += weight * row[i] * row[j];
                    }
                    sums[i][3] += weight * row[i] * dy;
                }
            }
            residual = squares / weights;
            line = solve(sums)?;
        }
        let [level, shear, slope] = line;
        Some(Self {
            offset_px: level - shear * centre_x - slope * centre_y,
            shear,
            scale: 1.0 + slope,
            residual_px: residual.sqrt(),
        })
    }

    /// Root mean square of the vertical disparity that the lines leave, in pixels, by the weights
    /// of the fit: the noise of the vector field's own `dy` is part of it.
    #[must_use]
    pub const fn residual_px(&self) -> f64 {
        self.residual_px
    }

    /// The row of the right image, between pixels, that belongs to row `y_left` at column `x_right`.
    #[must_use]
    pub fn row(&self, x_right: f64, y_left: f64) -> f64 {
        self.offset_px + self.shear * x_right + self.scale * y_left
    }

    /// The right luma with its rows moved to the left ones.
    #[must_use]
    pub fn align_luma(&self, right: &LumaImage) -> LumaImage {
        let aligned = self.align(right.plane(), |luma| luma);
        // Finite samples and weights that sum to one give finite samples.
        LumaImage::new(aligned).unwrap_or_else(|_| right.clone())
    }

    /// The right colours with their rows moved to the left ones.
    #[must_use]
    pub fn align_rgb(&self, right: ArrayView2<'_, [u8; 3]>) -> Array2<[u8; 3]> {
        let channel = |channel: usize| self.align(right, |rgb| f32::from(rgb[channel]));
        let (red, green, blue) = (channel(0), channel(1), channel(2));
        let byte = |value: f32| value.round() as u8;
        Zip::from(&red)
            .and(&green)
            .and(&blue)
            .map_collect(|red, green, blue| [byte(*red), byte(*green), byte(*blue)])
    }

    /// Reads every column at its lines, between rows by Catmull and Rom's cubic; borders replicate.
    fn align<T: Copy + Sync>(
        &self,
        right: ArrayView2<'_, T>,
        value: impl Fn(T) -> f32 + Sync,
    ) -> Array2<f32> {
        let (height, width) = right.dim();
        let mut aligned = Array2::zeros((height, width));
        Zip::indexed(&mut aligned).par_for_each(|(y, x), out| {
            let row = self.row(x as f64, y as f64);
            let above = row.floor();
            let t = (row - above) as f32;
            let taps = [
                t * (-0.5 + t * (1.0 - 0.5 * t)),
                1.0 + t * t * (-2.5 + 1.5 * t),
                t * (0.5 + t * (2.0 - 1.5 * t)),
                t * t * (-0.5 + 0.5 * t),
            ];
            let reads = taps.iter().zip(-1i64..).map(|(tap, step)| {
                let row = (above as i64 + step).clamp(0, height as i64 - 1);
                tap * value(right[[row as usize, x]])
            });
            *out = reads.sum();
        });
        aligned
    }
}

fn median(values: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len() / 2;
    let (_, median, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    *median
}

/// The solution of three equations `[a | b]`, by elimination with pivots; `None` if there is not one.
fn solve(mut rows: [[f64; 4]; 3]) -> Option<[f64; 3]> {
    for column in 0..3 {
        let pivot = (column..3).max_by(|a, b| {
            let size = |row: &usize| rows[*row][column].abs();
            size(a).total_cmp(&size(b))
        })?;
        rows.swap(column, pivot);
        let lead = rows[column][column];
        if lead.abs() < 1e-9 {
            return None;
        }
        for row in 0..3 {
            if row != column {
                let factor = rows[row][column] / lead;
                for i in column..4 {
                    rows[row][i] -= factor * rows[column][i];
                }
            }
        }
    }
    Some([0, 1, 2].map(|i| rows[i][3] / rows[i][i]))
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;
    use proptest::prelude::*;

    use super::*;
    use crate::Validity;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        /// Lines are found again among as many as a quarter of wild pixels.
        #[test]
        fn lines_are_found(
            offset in -5.0f64..5.0, shear in -0.03f64..0.03, scale in 0.97f64..1.03, wild in 4usize..9,
        ) {
            let shape = (60, 80);
            let dx = Array2::from_shape_fn(shape, |(y, x)| -3.0 - ((x * 7 + y * 3) % 11) as f32);
            let dy = Array2::from_shape_fn(shape, |(y, x)| {
                let seen = x as f64 + f64::from(dx[[y, x]]);
                let off = if (x + 3 * y).is_multiple_of(wild) { 9.0 } else { 0.0 };
                (offset + shear * seen + scale * y as f64 - y as f64 + off) as f32
            });
            let confidence = Array2::zeros(shape);
            let validity = Array2::from_elem(shape, Validity::Valid);
            let field = DisparityField::new(dx, dy, confidence, validity).unwrap();
            let found = RowAlignment::fit(&field).unwrap();
            for (x, y) in [(0.0, 0.0), (79.0, 0.0), (0.0, 59.0), (79.0, 59.0)] {
                let want = offset + shear * x + scale * y;
                prop_assert!((found.row(x, y) - want).abs() < 0.02, "{found:?}");
            }
        }
    }

    #[test]
    fn too_little_is_no_alignment() {
        let shape = (30, 30);
        let zeros = || Array2::zeros(shape);
        let nothing = Array2::from_elem(shape, Validity::NoEnergy);
        let field = DisparityField::new(zeros(), zeros(), zeros(), nothing).unwrap();
        assert_eq!(RowAlignment::fit(&field), None);
    }

    /// A ramp that is moved and squeezed is put back, away from the border exactly.
    #[test]
    fn rows_are_put_back() {
        let lines = RowAlignment {
            offset_px: 1.3,
            shear: 0.01,
            scale: 1.02,
            residual_px: 0.0,
        };
        // Right row r shows what belongs to the left row (r - offset - shear x) / scale.
        let right = Array2::from_shape_fn((40, 20), |(y, x)| {
            ((y as f64 - 1.3 - 0.01 * x as f64) / 1.02) as f32
        });
        let aligned = lines.align_luma(&LumaImage::new(right).unwrap());
        for ((y, x), luma) in aligned.plane().indexed_iter() {
            if (2..35).contains(&y) {
                assert!((luma - y as f32).abs() < 1e-3, "{luma} at {x}, {y}");
            }
        }
    }
}
