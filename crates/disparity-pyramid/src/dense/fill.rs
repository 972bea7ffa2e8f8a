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
    Zip::indexed(&mut filled)
        .and(&field.known)
        .and(&field.validity)
        .par_for_each(|(y, x), dx, known, validity| {
            if !known {
                let behind = is_hidden(*validity)
                    .then(|| field.background(x, y))
                    .flatten();
                *dx = behind
                    .or_else(|| median_around(field, x, y))
                    .unwrap_or(otherwise);
            }
        });
    filled
}

/// The median of the nearest known shifts in sixteen directions; of two in the middle the farther.
fn median_around(field: &PartialField, x: usize, y: usize) -> Option<f32> {
    let mut found = [0.0; DIRECTIONS.len()];
    let mut count = 0;
    for (step_x, step_y) in DIRECTIONS {
        let mut at = (y, x);
        loop {
            at = (
                at.0.wrapping_add_signed(step_y),
                at.1.wrapping_add_signed(step_x),
            );
            match field.known.get(at) {
                None => break,
                Some(false) => {}
                Some(true) => {
                    found[count] = field.dx[at];
                    count += 1;
                    break;
                }
            }
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
