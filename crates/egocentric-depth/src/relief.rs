use crate::rotation::dot;

/// One match as a point of the left eye: where its line of sight crosses `z = 1`, the inverse of its
/// depth there, and its weight.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Relief {
    pub(crate) x: f64,
    pub(crate) y: f64,
    /// In pixels of parallax: focal length times baseline over depth.
    pub(crate) parallax_px: f64,
    pub(crate) weight: f64,
}

impl Relief {
    /// How much nearer than a plane the point is, in pixels of parallax.
    pub(crate) fn off(&self, plane: [f64; 3]) -> f64 {
        self.parallax_px - dot(plane, [1.0, self.x, self.y])
    }
}

/// Rounds of reweighting: the majority's plane stands out within a few.
const ROUNDS: usize = 20;

/// The part of the weight that lies farther than `off_px` from one plane of the world, by parallax.
///
/// `None` without three points.
pub(crate) fn off_plane(points: &[Relief], off_px: f64) -> Option<f64> {
    let plane = plane_of(points, off_px, None)?;
    let total: f64 = points.iter().map(|point| point.weight).sum();
    let off: f64 = points
        .iter()
        .filter(|point| point.off(plane).abs() > off_px)
        .map(|point| point.weight)
        .sum();
    // An empty sum is -0.
    Some(off.abs() / total)
}

/// The plane of the world that most of the points lie on to about `off_px` of parallax: `[p, q, r]`
/// with `parallax = p + q x + r y`.
///
/// The inverse depth of a plane is linear in `x` and `y`, whatever the eyes' pose, so the plane is a
/// line fit: least squares, reweighted by Cauchy's function, from `start` or from all points alike.
/// `None` without three points.
pub(crate) fn plane_of(
    points: &[Relief],
    off_px: f64,
    start: Option<[f64; 3]>,
) -> Option<[f64; 3]> {
    let mut plane = start;
    for _ in 0..ROUNDS {
        let mut sums = [[0.0; 4]; 3];
        for point in points {
            let row = [1.0, point.x, point.y];
            let agreed = plane.map_or(1.0, |plane| {
                let miss = point.off(plane) / off_px;
                1.0 / (1.0 + miss * miss)
            });
            let weight = point.weight * agreed;
            for i in 0..3 {
                for j in 0..3 {
                    sums[i][j] += weight * row[i] * row[j];
                }
                sums[i][3] += weight * row[i] * point.parallax_px;
            }
        }
        plane = Some(solve(sums)?);
    }
    plane
}

/// The plane through three points; `None` if they lie on one line of the image.
pub(crate) fn plane_through(points: [Relief; 3]) -> Option<[f64; 3]> {
    let [a, b, c] = points.map(|point| [1.0, point.x, point.y, point.parallax_px]);
    solve([a, b, c])
}

/// Three equations, by Cramer's rule; `None` if they are one.
fn solve(rows: [[f64; 4]; 3]) -> Option<[f64; 3]> {
    let column = |j: usize| rows.map(|row| row[j]);
    let determinant = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| dot(a, crate::rotation::cross(b, c));
    let (a, b, c, right) = (column(0), column(1), column(2), column(3));
    let whole = determinant(a, b, c);
    let scale = rows[0][0] * rows[1][1] * rows[2][2];
    (whole.abs() > 1e-9 * scale.abs()).then(|| {
        [
            determinant(right, b, c) / whole,
            determinant(a, right, c) / whole,
            determinant(a, b, right) / whole,
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scene(parallax_px: impl Fn(f64, f64) -> f64) -> Vec<Relief> {
        let mut points = Vec::new();
        for i in 0..20 {
            for j in 0..20 {
                let (x, y) = (f64::from(i) / 20.0 - 0.5, f64::from(j) / 20.0 - 0.5);
                let parallax_px = parallax_px(x, y);
                points.push(Relief {
                    x,
                    y,
                    parallax_px,
                    weight: 1.0,
                });
            }
        }
        points
    }

    /// A slanted wall has nothing off its plane, a box before it has its own share.
    #[test]
    fn a_box_stands_out_of_its_wall() {
        let wall = scene(|x, y| 20.0 + 5.0 * x - 3.0 * y);
        assert_eq!(off_plane(&wall, 0.5), Some(0.0));
        let with_box = scene(|x, y| 20.0 + 5.0 * x + if x > 0.2 && y > 0.0 { 6.0 } else { 0.0 });
        let off = off_plane(&with_box, 0.5).unwrap();
        // Five columns of nine rows, of 400 points.
        assert_eq!(off, 0.1125);
        assert_eq!(off_plane(&wall[..20], 0.5), None);
        assert_eq!(off_plane(&[], 0.5), None);
    }
}
