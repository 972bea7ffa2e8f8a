use ndarray::{Array2, Zip, s};
use v1_gabor::Size;

use crate::DisparityField;

/// The cells' grid is the finest whose longer side has at most so many blocks.
const LONGEST_SIDE: usize = 96;

/// Half-width of the neighbourhood that supports a cell, in blocks.
const RADIUS: usize = 4;

/// Rounds of the network. What an outline decides moves inwards by a neighbourhood a round.
const ROUNDS: usize = 80;

/// Keeps a cell that neither claims nor is contested at zero.
const SILENCE: f32 = 1e-9;

/// One field of several, found from different starts: at each place the one that both eyes can agree
/// upon. `None` without a field, or if they differ in size.
///
/// A pattern that repeats is matched, and found again from the other eye, with every shift a period
/// away from the true one: no window within it tells them apart. Its outline does, and that no place
/// is seen twice: what the left eye calls the second column, the right eye cannot call the first. So
/// the fields compete in a cooperative network (Marr & Poggio 1976, Zitnick & Kanade 2000). Blocks of
/// pixels are cells, one for each field, as active as their field's pixels are valid. Each round a
/// cell is supported by the cells of about its own shift around it, and inhibited by its strongest
/// rival on either line of sight: another shift of the same left block, or another that leads to the
/// same right block. An outline has no rival; what it claims frees the next period, and so inwards.
///
/// Among the fields chosen in a block and those beside it, a pixel takes the most confident. The
/// covariances come along if all fields have them.
#[must_use]
pub fn most_consistent(fields: &[DisparityField]) -> Option<DisparityField> {
    let size = fields.first()?.size();
    if fields.iter().any(|field| field.size() != size) {
        return None;
    }
    if let [only] = fields {
        return Some(only.clone());
    }
    let block = block_px(size);
    let cells: Vec<Cells> = fields.iter().map(|field| Cells::of(field, block)).collect();
    let chosen = cooperate(&cells, block as f32);
    let field_of = Array2::from_shape_fn(size.dim(), |(y, x)| {
        let (row, column) = (y / block, x / block);
        let rows = row.saturating_sub(1)..(row + 2).min(chosen.nrows());
        let columns = column.saturating_sub(1)..(column + 2).min(chosen.ncols());
        let near = chosen.slice(s![rows, columns]);
        near.iter().fold(chosen[[row, column]], |best, &other| {
            if fields[other].guess(x, y).confidence > fields[best].guess(x, y).confidence {
                other
            } else {
                best
            }
        })
    });
    let of = |plane: fn(&DisparityField) -> ndarray::ArrayView2<'_, f32>| {
        Array2::from_shape_fn(size.dim(), |pixel| plane(&fields[field_of[pixel]])[pixel])
    };
    let validity = Array2::from_shape_fn(size.dim(), |pixel| {
        fields[field_of[pixel]].validity()[pixel]
    });
    let covariances: Option<Vec<_>> = fields.iter().map(DisparityField::covariance).collect();
    let covariance =
        covariances.map(|of| Array2::from_shape_fn(size.dim(), |pixel| of[field_of[pixel]][pixel]));
    let field = DisparityField::trusted(
        of(DisparityField::dx),
        of(DisparityField::dy),
        of(DisparityField::confidence),
        validity,
    );
    Some(field.with_covariance(covariance))
}

/// Side of a block in pixels: the smallest power of two that leaves no more than [`LONGEST_SIDE`].
fn block_px(size: Size) -> usize {
    let longest = size.width.max(size.height);
    longest.div_ceil(LONGEST_SIDE).next_power_of_two()
}

/// One field's cells, `[[row, column]]` of blocks.
struct Cells {
    /// The part of each block's pixels that are valid.
    evidence: Array2<f32>,
    /// The mean shift of each block, in pixels.
    shift: Array2<(f32, f32)>,
    /// The right block that it leads to, if it is in view.
    target: Array2<Option<[usize; 2]>>,
}

impl Cells {
    fn of(field: &DisparityField, block: usize) -> Self {
        let (height, width) = field.dx().dim();
        let dim = (height.div_ceil(block), width.div_ceil(block));
        let mean = |(row, column): (usize, usize)| {
            let rows = row * block..((row + 1) * block).min(height);
            let columns = column * block..((column + 1) * block).min(width);
            let (mut count, mut valid, mut dx, mut dy) = (0.0, 0.0, 0.0, 0.0);
            for y in rows {
                for x in columns.clone() {
                    count += 1.0f32;
                    valid += f32::from(u8::from(field.validity()[[y, x]].is_valid()));
                    dx += field.dx()[[y, x]];
                    dy += field.dy()[[y, x]];
                }
            }
            (valid / count, (dx / count, dy / count))
        };
        let blocks = Array2::from_shape_fn(dim, mean);
        let moved = |at: usize, shift_px: f32, side: usize| {
            let to = (at as f32 + shift_px / block as f32).round();
            (to >= 0.0 && to < side as f32).then_some(to as usize)
        };
        let target = |(row, column): (usize, usize)| {
            let (dx, dy) = blocks[[row, column]].1;
            Some([moved(row, dy, dim.0)?, moved(column, dx, dim.1)?])
        };
        Self {
            evidence: blocks.mapv(|(valid, _)| valid),
            shift: blocks.mapv(|(_, shift)| shift),
            target: Array2::from_shape_fn(dim, target),
        }
    }

    /// The strongest of the cells that lead to each right block: its strength and its shift.
    fn claims(&self, strength: &Array2<f32>) -> Array2<(f32, (f32, f32))> {
        let mut claims = Array2::from_elem(strength.dim(), (0.0, (0.0, 0.0)));
        Zip::from(&self.target)
            .and(strength)
            .and(&self.shift)
            .for_each(|target, &strength, &shift| {
                if let Some(claim) = target.and_then(|target| claims.get_mut(target))
                    && strength > claim.0
                {
                    *claim = (strength, shift);
                }
            });
        claims
    }
}

/// Lets the cells of all fields support and inhibit one another; the field with the most support in
/// each block, the first one of several. Shifts nearer to each other than `near_px` are one.
fn cooperate(cells: &[Cells], near_px: f32) -> Array2<usize> {
    let apart = |a: (f32, f32), b: (f32, f32)| (a.0 - b.0).hypot(a.1 - b.1) > near_px;
    let dim = cells[0].evidence.dim();
    let fields = 0..cells.len();
    let mut support: Vec<Array2<f32>> = cells.iter().map(|c| mean_about(&c.evidence)).collect();
    for _ in 0..ROUNDS {
        // An exponent between one, at which no rival ever yields, and two, at which chance decides
        // before an outline is heard.
        let strength: Vec<_> = support
            .iter()
            .map(|support| support.mapv(|s| s.max(0.0).powf(1.5)))
            .collect();
        let claims: Vec<_> = cells
            .iter()
            .zip(&strength)
            .map(|(cells, strength)| cells.claims(strength))
            .collect();
        let active = |field: usize, at: [usize; 2]| {
            let (own, shift) = (strength[field][at], cells[field].shift[at]);
            let others = || fields.clone().filter(|&other| other != field);
            let left = others()
                .filter(|&other| apart(cells[other].shift[at], shift))
                .map(|other| strength[other][at]);
            let right = others().filter_map(|other| {
                let (claim, claimed) = claims[other][cells[field].target[at]?];
                apart(claimed, shift).then_some(claim)
            });
            let (left, right) = (left.fold(0.0, f32::max), right.fold(0.0, f32::max));
            cells[field].evidence[at] * own / (own + left + right + SILENCE)
        };
        let active: Vec<Array2<f32>> = fields
            .clone()
            .map(|field| Array2::from_shape_fn(dim, |(y, x)| active(field, [y, x])))
            .collect();
        let together = |field: usize, at: [usize; 2]| {
            let shift = cells[field].shift[at];
            fields
                .clone()
                .filter(|&other| !apart(cells[other].shift[at], shift))
                .map(|other| active[other][at])
                .fold(0.0, f32::max)
        };
        support = fields
            .clone()
            .map(|field| {
                mean_about(&Array2::from_shape_fn(dim, |(y, x)| {
                    together(field, [y, x])
                }))
            })
            .collect();
    }
    Array2::from_shape_fn(dim, |at| {
        fields.clone().fold(0, |best, field| {
            if support[field][at] > support[best][at] {
                field
            } else {
                best
            }
        })
    })
}

/// The mean over the square of [`RADIUS`] about each place, as far as it lies inside.
fn mean_about(plane: &Array2<f32>) -> Array2<f32> {
    let along = |plane: &Array2<f32>| {
        let (height, width) = plane.dim();
        let mut means = Array2::zeros((width, height));
        for (row, mut out) in plane.rows().into_iter().zip(means.columns_mut()) {
            let mut sums = vec![0.0f32; width + 1];
            for x in 0..width {
                sums[x + 1] = sums[x] + row[x];
            }
            for x in 0..width {
                let (first, end) = (x.saturating_sub(RADIUS), (x + RADIUS + 1).min(width));
                out[x] = (sums[end] - sums[first]) / (end - first) as f32;
            }
        }
        means
    };
    // Twice along rows, turned each time.
    along(&along(plane))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Validity;

    #[test]
    fn the_mean_is_the_mean() {
        let plane = Array2::from_shape_fn((13, 21), |(y, x)| ((7 * y + 3 * x * x) % 11) as f32);
        let means = mean_about(&plane);
        for ((y, x), &mean) in means.indexed_iter() {
            let rows = y.saturating_sub(RADIUS)..(y + RADIUS + 1).min(13);
            let columns = x.saturating_sub(RADIUS)..(x + RADIUS + 1).min(21);
            let slow = plane.slice(s![rows, columns]).mean().unwrap();
            // Sums of 21 numbers up to 10, in f32.
            assert!((mean - slow).abs() < 1e-4);
        }
    }

    /// Of two shifts that fit everywhere within a pattern the one wins that also fits its outline.
    #[test]
    fn the_outline_decides() {
        let dim = (96, 96);
        let field = |dx: f32, valid: &dyn Fn(usize) -> bool| {
            let validity = Array2::from_shape_fn(dim, |(_, x)| {
                if valid(x) {
                    Validity::Valid
                } else {
                    Validity::Incoherent
                }
            });
            let confidence = validity.mapv(|v| f32::from(u8::from(v.is_valid())));
            let plane = |value| Array2::from_elem(dim, value);
            DisparityField::new(plane(dx), plane(0.0), confidence, validity).unwrap()
        };
        // A pattern of period 8 between columns 20 and 80, seen by the right eye 12 px further left.
        let truth = field(-12.0, &|x| (20..80).contains(&x));
        let period_less = field(-4.0, &|x| (20..72).contains(&x));
        let period_more = field(-20.0, &|x| (28..80).contains(&x));
        let chosen = most_consistent(&[period_less, truth.clone(), period_more]).unwrap();
        for x in 22..78 {
            assert_eq!(chosen.guess(x, 48).dx, -12.0, "at {x}");
        }
        assert!(most_consistent(&[]).is_none());
        assert_eq!(most_consistent(std::slice::from_ref(&truth)), Some(truth));
    }

    #[test]
    fn blocks_are_few() {
        let side = |width, height| block_px(Size { width, height });
        assert_eq!(side(96, 20), 1);
        assert_eq!(side(640, 480), 8);
        assert_eq!(side(480, 640), 8);
        assert_eq!(side(1282, 1110), 16);
    }
}
