use ndarray::Array2;
use v1_gabor::Size;

use crate::grid::Grid;
use crate::median::Medians;
use crate::shifts::Shifts;

/// What one way through the pyramid, from one eye to the other, works in: planes of every scale, kept
/// from one pair to the next.
#[derive(Clone, Debug, Default)]
pub(crate) struct Track {
    /// Finest first; those that the way does not come to are empty.
    pub(crate) levels: Vec<Level>,
}

/// The planes of one scale.
#[derive(Clone, Debug)]
pub(crate) struct Level {
    pub(crate) shifts: Shifts,
    /// The coarser scale's vertical shifts, where a second warp is to know them.
    pub(crate) parent_dy: Array2<f32>,
    pub(crate) medians: Medians,
}

impl Track {
    /// Makes the planes fit a pyramid of these grids, finest first, of which the scales from `last` on
    /// are walked. Those that fit already stay, with whatever they hold.
    pub(crate) fn fit(&mut self, grids: &[Grid], last: usize) {
        const EMPTY: Size = Size {
            width: 0,
            height: 0,
        };
        self.levels.resize_with(grids.len(), || Level::of(EMPTY));
        for (scale, (level, grid)) in self.levels.iter_mut().zip(grids).enumerate() {
            let size = if scale < last { EMPTY } else { grid.size };
            if level.shifts.validity.dim() != size.dim() {
                *level = Level::of(size);
            }
        }
    }
}

impl Level {
    fn of(size: Size) -> Self {
        Self {
            shifts: Shifts::silent(size),
            parent_dy: Array2::zeros((0, 0)),
            medians: Medians::default(),
        }
    }
}
