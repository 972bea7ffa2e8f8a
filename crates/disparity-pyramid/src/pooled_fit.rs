use ndarray::{Array2, Zip, azip};
use num_complex::Complex32;
use v1_gabor::MonogenicPlanes;

use crate::shifts::Shifts;
use crate::{MatchParams, Validity};

/// Standard deviation of the neighbourhood of a fit, in pixels of the scale.
const SIGMA_PX: f32 = 2.0;

/// Where the neighbourhood ends: at three deviations a weight is a hundredth.
const RADIUS: usize = 6;

/// Least determinant of the normal equations relative to the square of their trace; below it the
/// neighbourhood has one orientation, and its shift along the bars is anyone's guess.
const LEAST_DETERMINANT: f32 = 1e-3;

/// The same along the rows, where these are all there is: the part of the trace.
const LEAST_ALONG_ROWS: f32 = 1e-2;

/// A residual of half the carrier's period or more is another period's.
const MOST_STEP_PX: f32 = std::f32::consts::PI;

/// The sums of a weighted least-squares fit at every pixel.
struct Normal {
    xx: Array2<f32>,
    xy: Array2<f32>,
    yy: Array2<f32>,
    rx: Array2<f32>,
    ry: Array2<f32>,
    squares: Array2<f32>,
}

/// One warp over monogenic responses.
///
/// Where the left eye sees the orientation `n = r / |r|`, both eyes' responses along it are those of
/// an oriented quadrature pair, and their phase difference (equation 2) is the component of the
/// remaining shift along `n`. Each component enters equation 3 with the weight `b |r|^2`, `b` being
/// the balance of the eyes' amplitudes, so that its matrix is the structure tensor `sum r r^T`:
/// on the crest of a line, where `r` vanishes and `n` means nothing, nothing enters. The sums are
/// those over a neighbourhood.
pub(crate) fn pooled_refine(
    (left, right): (&MonogenicPlanes, &MonogenicPlanes),
    omega: f32,
    shifts: &mut Shifts,
    parent_dy: Option<&Array2<f32>>,
    params: &MatchParams,
) {
    let dim = shifts.dx.dim();
    let zeros = || Array2::<f32>::zeros(dim);
    let mut normal = Normal {
        xx: zeros(),
        xy: zeros(),
        yy: zeros(),
        rx: zeros(),
        ry: zeros(),
        squares: zeros(),
    };
    for ((y, x), validity) in shifts.validity.indexed_iter_mut() {
        let at = (x as f32 + shifts.dx[[y, x]], y as f32 + shifts.dy[[y, x]]);
        let response = left.at(x, y);
        let riesz = response.along_x.hypot(response.along_y);
        if !inside(at, dim) {
            *validity = Validity::OutOfView;
            continue;
        }
        *validity = Validity::NoEnergy;
        // On an exact crest any direction does, as it enters with no weight.
        let n = if riesz > 0.0 {
            (response.along_x / riesz, response.along_y / riesz)
        } else {
            (1.0, 0.0)
        };
        let seen = Complex32::new(response.even, riesz);
        let warped = read_along(right, n, omega, at);
        let energies = (seen.norm_sqr(), warped.norm_sqr());
        if energies.0.min(energies.1) <= params.energy_threshold {
            continue;
        }
        *validity = Validity::Valid;
        let product = seen * warped.conj();
        let component_px = product.arg() / omega;
        let balance = product.norm() / (0.5 * (energies.0 + energies.1));
        let weight = balance * riesz * riesz;
        let pixel = [y, x];
        normal.xx[pixel] = weight * n.0 * n.0;
        normal.xy[pixel] = weight * n.0 * n.1;
        normal.yy[pixel] = weight * n.1 * n.1;
        normal.rx[pixel] = weight * component_px * n.0;
        normal.ry[pixel] = weight * component_px * n.1;
        normal.squares[pixel] = weight * component_px * component_px;
    }
    let normal = normal.pooled();
    let verdicts = Array2::from_shape_fn(dim, |(y, x)| {
        let pixel = [y, x];
        let validity = shifts.validity[pixel];
        if !validity.is_valid() {
            return Err(validity);
        }
        let pull = parent_dy.map_or(0.0, |parent_dy| parent_dy[pixel] - shifts.dy[pixel]);
        let fit = if params.rows_only {
            normal.solve_row(pixel)
        } else {
            normal.solve(pixel, params.vertical_prior, pull)
        };
        let (ux, uy, residual) = fit.ok_or(Validity::Incoherent)?;
        if ux.hypot(uy) >= MOST_STEP_PX {
            return Err(Validity::Incoherent);
        }
        let at = (
            x as f32 + shifts.dx[pixel] + ux,
            y as f32 + shifts.dy[pixel] + uy,
        );
        if inside(at, dim) {
            Ok((ux, uy, residual))
        } else {
            Err(Validity::OutOfView)
        }
    });
    azip!((
        verdict in &verdicts,
        dx in &mut shifts.dx,
        dy in &mut shifts.dy,
        validity in &mut shifts.validity,
        residual in &mut shifts.residual,
    ) match *verdict {
        Ok((ux, uy, left_over)) => {
            *dx += ux;
            *dy += uy;
            *residual = left_over;
        }
        Err(reason) => *validity = reason,
    });
}

impl Normal {
    fn pooled(self) -> Self {
        Self {
            xx: pool(&self.xx),
            xy: pool(&self.xy),
            yy: pool(&self.yy),
            rx: pool(&self.rx),
            ry: pool(&self.ry),
            squares: pool(&self.squares),
        }
    }

    /// The shift of one pixel (equation 3) and the root mean square of what it leaves, in pixels;
    /// `None` if one orientation is all there is.
    fn solve(&self, pixel: [usize; 2], prior: f32, pull: f32) -> Option<(f32, f32, f32)> {
        let (xx, xy, yy) = (self.xx[pixel], self.xy[pixel], self.yy[pixel]);
        let (rx, ry) = (self.rx[pixel], self.ry[pixel]);
        let trace = xx + yy;
        if !(trace > 0.0 && xx * yy - xy * xy > LEAST_DETERMINANT * trace * trace) {
            return None;
        }
        let ridge = prior * trace;
        let (pulled_yy, pulled_ry) = (yy + ridge, ry + ridge * pull);
        let determinant = xx * pulled_yy - xy * xy;
        let ux = (pulled_yy * rx - xy * pulled_ry) / determinant;
        let uy = (xx * pulled_ry - xy * rx) / determinant;
        let explained = 2.0 * (rx * ux + ry * uy) - (xx * ux + 2.0 * xy * uy) * ux - yy * uy * uy;
        let left_over = (self.squares[pixel] - explained).max(0.0) / trace;
        Some((ux, uy, left_over.sqrt()))
    }

    /// The same with the vertical component held: `None` if the neighbourhood is horizontal bars.
    fn solve_row(&self, pixel: [usize; 2]) -> Option<(f32, f32, f32)> {
        let (xx, rx) = (self.xx[pixel], self.rx[pixel]);
        let trace = xx + self.yy[pixel];
        if !(trace > 0.0 && xx > LEAST_ALONG_ROWS * trace) {
            return None;
        }
        let ux = rx / xx;
        let left_over = (self.squares[pixel] - rx * ux).max(0.0) / trace;
        Some((ux, 0.0, left_over.sqrt()))
    }
}

/// Whether a place lies between the pixels of an image of `(rows, columns)`.
fn inside((x, y): (f32, f32), (rows, columns): (usize, usize)) -> bool {
    x >= 0.0 && y >= 0.0 && x <= (columns - 1) as f32 && y <= (rows - 1) as f32
}

/// The response along the direction `n` at a place between pixels, each neighbour first turned by
/// the carrier's phase from it to the place: `sum_i w_i G(x_i) exp(-j omega n.(x_i - x'))`.
fn read_along(
    planes: &MonogenicPlanes,
    n: (f32, f32),
    omega: f32,
    (x, y): (f32, f32),
) -> Complex32 {
    let size = planes.size();
    let (left, above) = (x as usize, y as usize);
    let (right, below) = (
        (left + 1).min(size.width - 1),
        (above + 1).min(size.height - 1),
    );
    let (fx, fy) = (x - left as f32, y - above as f32);
    let neighbours = [
        (left, above, (1.0 - fx) * (1.0 - fy), 0.0),
        (right, above, fx * (1.0 - fy), n.0),
        (left, below, (1.0 - fx) * fy, n.1),
        (right, below, fx * fy, n.0 + n.1),
    ];
    let sum: Complex32 = neighbours
        .iter()
        .map(|&(x, y, weight, along)| {
            let response = planes.at(x, y);
            let odd = response.along_x * n.0 + response.along_y * n.1;
            Complex32::new(response.even, odd) * Complex32::cis(-omega * along) * weight
        })
        .sum();
    // What all four turns have in common.
    sum * Complex32::cis(omega * (n.0 * fx + n.1 * fy))
}

/// Sums under a Gaussian; outside the plane nothing is summed.
fn pool(plane: &Array2<f32>) -> Array2<f32> {
    let weight = |offset: usize| (-((offset * offset) as f32) / (2.0 * SIGMA_PX * SIGMA_PX)).exp();
    let weights: [f32; RADIUS + 1] = std::array::from_fn(weight);
    let (height, width) = plane.dim();
    let mut down = Array2::<f32>::zeros((height, width));
    for y in 0..height {
        for row in y.saturating_sub(RADIUS)..(y + RADIUS + 1).min(height) {
            let weight = weights[row.abs_diff(y)];
            Zip::from(down.row_mut(y))
                .and(plane.row(row))
                .for_each(|sum, &value| *sum += weight * value);
        }
    }
    Array2::from_shape_fn((height, width), |(y, x)| {
        (x.saturating_sub(RADIUS)..(x + RADIUS + 1).min(width))
            .map(|column| weights[column.abs_diff(x)] * down[[y, column]])
            .sum()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Components of one shift along several directions give the shift back.
    #[test]
    fn components_give_the_shift() {
        let shift = (0.7f32, -0.4f32);
        let of = |number: &dyn Fn(f32, f32, f32) -> f32| {
            let sum = (0..5u8).map(|i| {
                let (y, x) = (0.9 * f32::from(i)).sin_cos();
                number(x, y, shift.0 * x + shift.1 * y)
            });
            Array2::from_elem((1, 1), sum.sum())
        };
        let normal = Normal {
            xx: of(&|x, _, _| x * x),
            xy: of(&|x, y, _| x * y),
            yy: of(&|_, y, _| y * y),
            rx: of(&|x, _, d| d * x),
            ry: of(&|_, y, d| d * y),
            squares: of(&|_, _, d| d * d),
        };
        let (ux, uy, left_over) = normal.solve([0, 0], 0.0, 0.0).unwrap();
        // Sums of five products near one.
        assert!((ux - shift.0).abs() < 1e-5 && (uy - shift.1).abs() < 1e-5);
        assert!(left_over < 2e-3, "{left_over}");
        // A heavy prior leaves the component along x alone and takes the vertical one away, as
        // rows alone do.
        let (ux, uy, _) = normal.solve([0, 0], 1e6, 0.0).unwrap();
        assert!(uy.abs() < 1e-4);
        let row = normal.solve_row([0, 0]).unwrap();
        assert!((row.0 - ux).abs() < 1e-4 && row.1 == 0.0, "{row:?}");
    }

    #[test]
    fn one_orientation_tells_no_shift() {
        let one = |number| Array2::from_elem((1, 1), number);
        let normal = Normal {
            xx: one(1.0),
            xy: one(0.5),
            yy: one(0.25),
            rx: one(0.3),
            ry: one(0.15),
            squares: one(0.09),
        };
        assert_eq!(normal.solve([0, 0], 0.0, 0.0), None);
    }
}
