use ndarray::{Array2, ArrayView2};

use crate::Validity;

/// Patches of valid pixels whose shifts change by at most a pixel from neighbour to neighbour and
/// that have fewer than `least` pixels are chance: they become inconsistent.
pub(crate) fn reject_speckles(
    dx: ArrayView2<'_, f32>,
    validity: &mut Array2<Validity>,
    least: usize,
) {
    const STEP_PX: f32 = 1.0;
    if least < 2 {
        return;
    }
    let (height, width) = dx.dim();
    let (Some(dx), Some(validity)) = (dx.as_slice(), validity.as_slice_mut()) else {
        unreachable!("planes are made in row-major order")
    };
    let mut open: Vec<bool> = validity
        .iter()
        .map(|validity| validity.is_valid())
        .collect();
    let mut patch: Vec<usize> = Vec::new();
    for start in 0..width * height {
        if !open[start] {
            continue;
        }
        patch.clear();
        patch.push(start);
        open[start] = false;
        let mut next = 0;
        while let Some(&here) = patch.get(next) {
            next += 1;
            let x = here % width;
            let mut join = |there: usize| {
                if open[there] && (dx[there] - dx[here]).abs() <= STEP_PX {
                    open[there] = false;
                    patch.push(there);
                }
            };
            if x > 0 {
                join(here - 1);
            }
            if x + 1 < width {
                join(here + 1);
            }
            if here >= width {
                join(here - width);
            }
            if here + width < width * height {
                join(here + width);
            }
        }
        if patch.len() < least {
            for &place in &patch {
                validity[place] = Validity::Inconsistent;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_patches_go_and_large_ones_stay() {
        // A patch of 2 x 2 at another shift, on a surface that slants by half a pixel a column.
        let mut dx = Array2::from_shape_fn((8, 8), |(_, x)| -0.5 * x as f32);
        for place in [[2, 2], [2, 3], [3, 2], [3, 3]] {
            dx[place] -= 9.0;
        }
        let mut validity = Array2::from_elem((8, 8), Validity::Valid);
        validity[[7, 7]] = Validity::Occluded;
        reject_speckles(dx.view(), &mut validity, 5);
        for ((y, x), found) in validity.indexed_iter() {
            let want = match (y, x) {
                (7, 7) => Validity::Occluded,
                (2..4, 2..4) => Validity::Inconsistent,
                _ => Validity::Valid,
            };
            assert_eq!(*found, want, "at ({x}, {y})");
        }
        reject_speckles(dx.view(), &mut validity, 0);
        assert_eq!(validity[[0, 0]], Validity::Valid);
    }
}
