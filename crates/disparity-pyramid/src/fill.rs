use ndarray::Array2;

use crate::Validity;
use crate::refine::Shifts;

/// Half the width of the window that is looked at, in pixels.
const REACH: usize = 2;

/// Makes a pixel without an answer of its own (too little energy, or incoherent) valid if at least
/// so many of the 5 x 5 pixels around it are: the medians have given it their value by then. What
/// is left unexplained there is taken to be their mean.
///
/// A texture's own quiet spots, where an orientation or two fall below the threshold, are filled so;
/// an empty wall is not. `None` fills nothing.
pub(crate) fn fill(shifts: &mut Shifts, least: Option<usize>) {
    let Some(least) = least else {
        return;
    };
    let (height, width) = shifts.dx.dim();
    let mut filled: Vec<((usize, usize), f32)> = Vec::new();
    let mut columns = vec![(0usize, 0.0f32); width];
    for y in 0..height {
        let rows = y.saturating_sub(REACH)..(y + REACH + 1).min(height);
        for (x, column) in columns.iter_mut().enumerate() {
            *column = rows
                .clone()
                .fold((0, 0.0), |sum, v| add(sum, at(shifts, v, x)));
        }
        for x in 0..width {
            if !matches!(
                shifts.validity[[y, x]],
                Validity::NoEnergy | Validity::Incoherent
            ) {
                continue;
            }
            let window = &columns[x.saturating_sub(REACH)..(x + REACH + 1).min(width)];
            let (valid, residual) = window.iter().copied().fold((0, 0.0), add);
            if valid >= least.max(1) {
                filled.push(((y, x), residual / valid as f32));
            }
        }
    }
    for (place, residual) in filled {
        shifts.validity[place] = Validity::Valid;
        shifts.residual[place] = residual;
    }
}

/// Whether a pixel is valid, as a number, and its residual if it is.
fn at(shifts: &Shifts, y: usize, x: usize) -> (usize, f32) {
    if shifts.validity[[y, x]].is_valid() {
        (1, shifts.residual[[y, x]])
    } else {
        (0, 0.0)
    }
}

fn add(a: (usize, f32), b: (usize, f32)) -> (usize, f32) {
    (a.0 + b.0, a.1 + b.1)
}

impl Shifts {
    /// Shifts of which nothing is known yet.
    pub(crate) fn silent(dx: Array2<f32>, dy: Array2<f32>) -> Self {
        Self {
            validity: Array2::from_elem(dx.dim(), Validity::NoEnergy),
            residual: Array2::zeros(dx.dim()),
            dx,
            dy,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quiet_spot_is_filled_and_a_wall_is_not() {
        let mut shifts = Shifts::silent(Array2::zeros((20, 30)), Array2::zeros((20, 30)));
        shifts.residual.fill(0.25);
        for y in 0..20 {
            for x in 0..15 {
                shifts.validity[[y, x]] = Validity::Valid;
            }
        }
        shifts.validity[[10, 5]] = Validity::Incoherent;
        shifts.validity[[4, 7]] = Validity::OutOfView;
        fill(&mut shifts, Some(13));
        assert!(shifts.validity[[10, 5]].is_valid());
        assert_eq!(shifts.residual[[10, 5]], 0.25);
        assert_eq!(shifts.validity[[4, 7]], Validity::OutOfView);
        // Beside an edge, two columns of five are valid: ten of twenty-five.
        assert_eq!(shifts.validity[[10, 15]], Validity::NoEnergy);
        assert_eq!(shifts.validity[[10, 25]], Validity::NoEnergy);
        fill(&mut shifts, Some(10));
        assert!(shifts.validity[[10, 15]].is_valid());
        assert_eq!(shifts.validity[[10, 25]], Validity::NoEnergy);
    }
}
