use ndarray::{Array2, ArrayView2, s};

/// A step of the truth between neighbours that is a depth discontinuity, in pixels.
const JUMP_PX: f32 = 2.0;
/// How far a discontinuity reaches, in pixels: the 9 x 9 window about each of its pixels.
const REACH: usize = 4;

/// Which pixels `[[y, x]]` lie on a continuous surface: outside the 9 x 9 windows about both sides
/// of every step of the true disparity above two pixels.
///
/// A step is one between two known neighbours on a row or a column; where one of them is unknown
/// (NaN) no step is seen.
pub(crate) fn continuous(truth: ArrayView2<'_, f32>) -> Array2<bool> {
    let (height, width) = truth.dim();
    let mut mask = Array2::from_elem(truth.dim(), true);
    let mut exclude = |y: usize, x: usize| {
        let rows = y.saturating_sub(REACH)..(y + REACH + 1).min(height);
        let columns = x.saturating_sub(REACH)..(x + REACH + 1).min(width);
        mask.slice_mut(s![rows, columns]).fill(false);
    };
    for ((y, x), &here) in truth.indexed_iter() {
        for neighbour in [[y, x + 1], [y + 1, x]] {
            // A difference with an unknown is NaN, and no NaN is above two pixels.
            let jumps = truth
                .get(neighbour)
                .is_some_and(|&there| (here - there).abs() > JUMP_PX);
            if jumps {
                exclude(y, x);
                exclude(neighbour[0], neighbour[1]);
            }
        }
    }
    mask
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_step_keeps_four_pixels_off_on_either_side() {
        let truth = Array2::from_shape_fn((3, 20), |(_, x)| if x < 10 { 5.0 } else { 8.0 });
        let row = continuous(truth.view()).row(1).to_vec();
        for (x, continuous) in row.into_iter().enumerate() {
            // Columns 9 and 10 are the step.
            assert_eq!(continuous, !(5..=14).contains(&x), "column {x}");
        }
    }

    #[test]
    fn a_step_between_rows_is_a_step() {
        let truth = Array2::from_shape_fn((20, 3), |(y, _)| if y < 10 { 5.0 } else { 8.0 });
        let column = continuous(truth.view()).column(1).to_vec();
        for (y, continuous) in column.into_iter().enumerate() {
            assert_eq!(continuous, !(5..=14).contains(&y), "row {y}");
        }
    }

    #[test]
    fn slopes_and_unknowns_are_no_steps() {
        let slope = Array2::from_shape_fn((4, 12), |(_, x)| 2.0 * x as f32);
        assert!(
            continuous(slope.view())
                .iter()
                .all(|&continuous| continuous)
        );
        let mut hole = Array2::from_elem((4, 12), 3.0);
        hole[[2, 6]] = f32::NAN;
        assert!(continuous(hole.view()).iter().all(|&continuous| continuous));
    }
}
