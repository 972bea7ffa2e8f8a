use std::fmt;

/// The extent of an image or a plane, in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Size {
    /// Columns: the extent along x.
    pub width: usize,
    /// Rows: the extent along y.
    pub height: usize,
}

impl Size {
    /// The size of a plane with these `[[y, x]]` dimensions.
    #[must_use]
    pub const fn of_dim((height, width): (usize, usize)) -> Self {
        Self { width, height }
    }

    /// The `(rows, columns)` that ndarray wants for a plane `[[y, x]]`.
    #[must_use]
    pub const fn dim(self) -> (usize, usize) {
        (self.height, self.width)
    }

    /// The number of pixels.
    #[must_use]
    pub const fn area(self) -> usize {
        self.width * self.height
    }

    /// The size of the next coarser scale: every second pixel, the first one kept.
    #[must_use]
    pub const fn halved(self) -> Self {
        Self {
            width: self.width.div_ceil(2),
            height: self.height.div_ceil(2),
        }
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} x {}", self.width, self.height)
    }
}
