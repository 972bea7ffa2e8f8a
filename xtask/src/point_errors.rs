use serde::Serialize;
use stereo_formats::points::PointPair;

/// How far a vector field lies from sparse truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct PointErrors {
    /// Points that have an answer.
    pub(crate) answered: usize,
    /// Median length of the difference of the vectors, px.
    pub(crate) endpoint_median: f64,
    /// Its mean, px.
    pub(crate) endpoint_mean: f64,
    /// Mean absolute error along x, px.
    pub(crate) along_x: f64,
    /// Mean absolute error along y, px.
    pub(crate) along_y: f64,
    /// Per cent of the answered points that err by at most 2 px in both components.
    pub(crate) within_2: f64,
}

impl PointErrors {
    /// Compares a field, asked at pixels, with points of the left eye: between pixels it is read
    /// bilinearly, and has an answer where all four have one. `None` if it answers nowhere.
    pub(crate) fn of(
        points: &[PointPair],
        field: impl Fn(usize, usize) -> Option<(f32, f32)>,
    ) -> Option<Self> {
        let mut misses = Vec::new();
        for point in points {
            let (x, y) = point.left_px;
            if let Some((dx, dy)) = between((x, y), &field) {
                let (true_dx, true_dy) = point.disparity_px();
                misses.push((dx - true_dx, dy - true_dy));
            }
        }
        if misses.is_empty() {
            return None;
        }
        let count = misses.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| misses.iter().map(of).sum::<f64>() / count;
        let mut lengths: Vec<f64> = misses.iter().map(|(x, y)| x.hypot(*y)).collect();
        lengths.sort_unstable_by(f64::total_cmp);
        Some(Self {
            answered: misses.len(),
            endpoint_median: lengths[lengths.len() / 2],
            endpoint_mean: mean(&|(x, y)| x.hypot(*y)),
            along_x: mean(&|(x, _)| x.abs()),
            along_y: mean(&|(_, y)| y.abs()),
            within_2: 100.0 * mean(&|(x, y)| f64::from(u8::from(x.abs() <= 2.0 && y.abs() <= 2.0))),
        })
    }
}

/// The field between pixels; outside the image there is none.
fn between(
    (x, y): (f64, f64),
    field: &impl Fn(usize, usize) -> Option<(f32, f32)>,
) -> Option<(f64, f64)> {
    if x < 0.0 || y < 0.0 {
        return None;
    }
    let (left, above) = (x.floor(), y.floor());
    let (beyond_x, beyond_y) = (x - left, y - above);
    let mut sum = (0.0, 0.0);
    for (i, j) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
        let across = if i == 0 { 1.0 - beyond_x } else { beyond_x };
        let down = if j == 0 { 1.0 - beyond_y } else { beyond_y };
        // On a whole pixel its neighbours, which may lie outside, have no part.
        if across * down > 0.0 {
            let (dx, dy) = field(left as usize + i, above as usize + j)?;
            sum.0 += across * down * f64::from(dx);
            sum.1 += across * down * f64::from(dy);
        }
    }
    Some(sum)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_field_is_read_between_its_pixels() {
        let point = |x: f64, y: f64, dx: f64| PointPair {
            left_px: (x, y),
            right_px: (x + dx, y),
            depth_m: None,
        };
        // dx is the column, unknown beyond column 4.
        let field = |x: usize, _: usize| (x < 5).then_some((x as f32, 0.0));
        let points = [
            point(1.5, 1.0, 1.5),
            point(4.0, 0.0, 8.0),
            point(4.5, 0.0, 0.0),
        ];
        let errors = PointErrors::of(&points, field).unwrap();
        assert_eq!(errors.answered, 2);
        assert_eq!((errors.along_x, errors.along_y), (2.0, 0.0));
        assert_eq!(errors.within_2, 50.0);
        assert_eq!(PointErrors::of(&points[2..], field), None);
    }
}
