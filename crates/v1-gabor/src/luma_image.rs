use ndarray::{Array2, ArrayView2};

use crate::Size;
use crate::pyramid::{reduce, reduce_into};

/// A grey image `[[y, x]]`: at least one pixel, every sample finite, by habit in `[0, 1]`.
///
/// The range is a habit and not a promise: thresholds on energy assume it, nothing breaks
/// outside it.
#[derive(Clone, Debug, PartialEq)]
pub struct LumaImage(Array2<f32>);

/// Why a plane is not an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotAnImage {
    /// The plane has no pixel.
    #[error("an image needs at least one pixel, and this plane has none")]
    Empty,
    /// A sample is NaN or infinite.
    #[error("the sample at x = {x}, y = {y} is not a finite number")]
    NotFinite {
        /// Column of the first such sample.
        x: usize,
        /// Row of the first such sample.
        y: usize,
    },
}

impl LumaImage {
    /// Takes a plane `[[y, x]]` as an image.
    ///
    /// # Errors
    /// [`NotAnImage`] if the plane is empty or a sample is not finite.
    pub fn new(plane: Array2<f32>) -> Result<Self, NotAnImage> {
        if plane.is_empty() {
            return Err(NotAnImage::Empty);
        }
        // All are asked before anyone is looked for: side by side, a tenth of the time.
        let finite = plane.fold(true, |finite, luma| finite & luma.is_finite());
        let first = || plane.indexed_iter().find(|(_, luma)| !luma.is_finite());
        if !finite && let Some(((y, x), _)) = first() {
            return Err(NotAnImage::NotFinite { x, y });
        }
        // Kernels walk rows as slices, so the plane is kept in row-major order.
        if plane.is_standard_layout() {
            return Ok(Self(plane));
        }
        Ok(Self(plane.as_standard_layout().into_owned()))
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> Size {
        Size::of_dim(self.0.dim())
    }

    /// The samples `[[y, x]]`.
    #[must_use]
    pub fn plane(&self) -> ArrayView2<'_, f32> {
        self.0.view()
    }

    /// The image at half the size, as the pyramid has it: low-passed with `[1 4 6 4 1] / 16` along
    /// both axes, every second pixel kept, the first one first.
    #[must_use]
    pub fn halved(&self) -> Self {
        Self(reduce(self.plane()))
    }

    /// The same, written over an earlier image: nothing is allocated if that has the size already.
    pub fn halve_into(&self, halved: &mut Self) {
        let size = self.size().halved();
        if halved.size() != size {
            halved.0 = Array2::zeros(size.dim());
        }
        reduce_into(self.plane(), &mut halved.0);
    }

    /// Writes over an image: `fill` is given a plane of this size, with whatever it holds, and writes every
    /// sample. Nothing is allocated if the image has the size already.
    ///
    /// # Errors
    /// [`NotAnImage`] if the size is without a pixel or a sample is not finite; the image is then black.
    pub fn write_over(
        &mut self,
        size: Size,
        fill: impl FnOnce(&mut Array2<f32>),
    ) -> Result<(), NotAnImage> {
        if size.area() == 0 {
            return Err(NotAnImage::Empty);
        }
        if self.size() != size {
            self.0 = Array2::zeros(size.dim());
        }
        fill(&mut self.0);
        match self.0.indexed_iter().find(|(_, luma)| !luma.is_finite()) {
            None => Ok(()),
            Some(((y, x), _)) => {
                self.0.fill(0.0);
                Err(NotAnImage::NotFinite { x, y })
            }
        }
    }

    /// The samples `[[y, x]]`, given away.
    #[must_use]
    pub fn into_plane(self) -> Array2<f32> {
        self.0
    }
}
