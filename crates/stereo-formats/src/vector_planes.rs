use ndarray::{Array2, ArrayView2, Zip};
use v1_gabor::Size;

/// Two planes `[[y, x]]` of shifts: first `(x, y)` matches second `(x + dx, y + dy)`, in pixels.
///
/// Both planes have one size and at least one pixel; a pixel is known in both or NaN in both.
#[derive(Clone, Debug)]
pub struct VectorPlanes {
    dx: Array2<f32>,
    dy: Array2<f32>,
}

/// Why two planes are not the two halves of one vector field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotVectors {
    /// The planes differ in size.
    #[error("dx has {dx} pixels and dy has {dy}; the halves of a vector have one size")]
    Sizes {
        /// Size of the horizontal half.
        dx: Size,
        /// Size of the vertical half.
        dy: Size,
    },
    /// The planes have no pixel.
    #[error("planes of {0} pixels hold no vector")]
    Empty(Size),
}

impl VectorPlanes {
    /// Takes two planes; a pixel that is not finite in one of them becomes NaN in both.
    ///
    /// # Errors
    /// [`NotVectors`] if the sizes differ or there is no pixel.
    pub fn new(mut dx: Array2<f32>, mut dy: Array2<f32>) -> Result<Self, NotVectors> {
        let (size, other) = (Size::of_dim(dx.dim()), Size::of_dim(dy.dim()));
        if size != other {
            return Err(NotVectors::Sizes {
                dx: size,
                dy: other,
            });
        }
        if dx.is_empty() {
            return Err(NotVectors::Empty(size));
        }
        Zip::from(&mut dx).and(&mut dy).for_each(|dx, dy| {
            if !(dx.is_finite() && dy.is_finite()) {
                (*dx, *dy) = (f32::NAN, f32::NAN);
            }
        });
        Ok(Self { dx, dy })
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> Size {
        Size::of_dim(self.dx.dim())
    }

    /// The shift `(dx, dy)` at a pixel, if known; `None` outside the planes too.
    #[must_use]
    pub fn at(&self, x: usize, y: usize) -> Option<(f32, f32)> {
        let dx = *self.dx.get((y, x))?;
        let dy = *self.dy.get((y, x))?;
        dx.is_finite().then_some((dx, dy))
    }

    /// Shifts along x `[[y, x]]`, NaN where unknown.
    #[must_use]
    pub fn dx(&self) -> ArrayView2<'_, f32> {
        self.dx.view()
    }

    /// Shifts along y `[[y, x]]`, NaN where unknown.
    #[must_use]
    pub fn dy(&self) -> ArrayView2<'_, f32> {
        self.dy.view()
    }
}
