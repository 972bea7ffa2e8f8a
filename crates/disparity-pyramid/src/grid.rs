use v1_gabor::Size;

use crate::MatchParams;

/// The pixels of one scale whose shifts are fitted: all, or every second one of every second row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Grid {
    /// How many there are along each side.
    pub(crate) size: Size,
    /// How far each is from the next, in pixels of the scale.
    pub(crate) step: usize,
}

impl Grid {
    /// Those of every scale, whose sizes are given.
    pub(crate) fn of_scales(sizes: impl Iterator<Item = Size>, params: &MatchParams) -> Vec<Self> {
        let grid = |(scale, size): (usize, Size)| {
            if scale < params.sparse_scales {
                let size = size.halved();
                Self { size, step: 2 }
            } else {
                Self { size, step: 1 }
            }
        };
        sizes.enumerate().map(grid).collect()
    }
}
