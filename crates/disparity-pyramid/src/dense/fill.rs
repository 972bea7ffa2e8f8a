use ndarray::{Array2, Zip};

use crate::dense::partial_field::{PartialField, is_hidden};

/// Directions in which a missed pixel looks for known ones: (x, y) steps, sixteen of them.
const DIRECTIONS: [(isize, isize); 16] = [
    (1, 0),
    (2, 1),
    (1, 1),
    (1, 2),
    (0, 1),
    (-1, 2),
    (-1, 1),
    (-2, 1),
    (-1, 0),
    (-2, -1),
    (-1, -1),
    (-1, -2),
    (0, -1),
    (1, -2),
    (1, -1),
    (2, -1),
];

/// The field with a shift everywhere: a hidden pixel takes what lies behind it on its row, any other
/// the median of the nearest known shifts around it, `otherwise` if nothing at all is known there.
pub(crate) fn fill(field: &PartialField, otherwise: f32) -> Array2<f32> {
    let mut filled = field.dx.clone();
    Zip::indexed(filled.rows_mut()).par_for_each(|y, mut filled| {
        let behind = field.backgrounds(y);
        for (x, dx) in filled.iter_mut().enumerate() {
            if !field.known[[y, x]] {
                let behind = behind[x].filter(|_| is_hidden(field.validity[[y, x]]));
                *dx = behind
                    .or_else(|| median_around(field, x, y))
                    .unwrap_or(otherwise);
            }
        }
    });
    filled
}

/// The median of the nearest known shifts in sixteen directions; of two in the middle the farther.
fn median_around(field: &PartialField, x: usize, y: usize) -> Option<f32> {
    let (height, width) = field.dx.dim();
    let (Some(dx), Some(known)) = (field.dx.as_slice(), field.known.as_slice()) else {
        unreachable!("planes are made in row-major order")
    };
    let here = y * width + x;
    let mut found = [0.0; DIRECTIONS.len()];
    let mut count = 0;
    for (step_x, step_y) in DIRECTIONS {
        // Steps that stay within the image.
        let within = |at: usize, length: usize, step: isize| match step {
            0 => usize::MAX,
            1.. => (length - 1 - at) / step.unsigned_abs(),
            _ => at / step.unsigned_abs(),
        };
        let steps = within(x, width, step_x).min(within(y, height, step_y));
        let stride = step_y * width as isize + step_x;
        let places = (1..=steps).map(|step| here.wrapping_add_signed(stride * step as isize));
        if let Some(place) = places.into_iter().find(|place| known[*place]) {
            found[count] = dx[place];
            count += 1;
        }
    }
    let found = &mut found[..count];
    found.sort_by(f32::total_cmp);
    found.get(count / 2).copied()
}

#[cfg(test)]
mod tests {
    use ndarray::Array2;

    use super::*;
    use crate::Validity;

    #[test]
    fn hidden_pixels_take_the_background_and_missed_ones_their_surroundings() {
        let dx = Array2::from_shape_fn((5, 9), |(_, x)| if x < 4 { -2.0 } else { -7.0 });
        let mut validity = Array2::from_elem((5, 9), Validity::Valid);
        validity[[2, 4]] = Validity::Occluded;
        validity[[2, 6]] = Validity::Inconsistent;
        let mut field = PartialField::new(dx, validity);
        field.dx[[2, 4]] = 99.0;
        field.dx[[2, 6]] = 99.0;
        let filled = fill(&field, 0.0);
        assert_eq!((filled[[2, 4]], filled[[2, 6]]), (-2.0, -7.0));
        assert_eq!(filled[[0, 4]], -7.0);
    }

    #[test]
    fn where_nothing_is_known_there_is_a_last_word() {
        let nothing = Array2::from_elem((3, 4), Validity::NoEnergy);
        let field = PartialField::new(Array2::from_elem((3, 4), -5.0), nothing);
        assert!(fill(&field, -1.0).iter().all(|dx| *dx == -1.0));
    }
}
