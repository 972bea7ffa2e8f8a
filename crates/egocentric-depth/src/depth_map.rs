use ndarray::{Array2, ArrayView2};
use v1_gabor::Size;

/// Depth of every pixel of the left image: metres along the head's forward axis z.
///
/// What is not known is NaN inside the plane and `None` at [`DepthMap::at`]; known depths are
/// positive and finite.
#[derive(Clone, Debug)]
pub struct DepthMap {
    metres: Array2<f32>,
}

impl DepthMap {
    /// Takes a plane `[[y, x]]` of metres; whatever is not positive and finite becomes unknown.
    #[must_use]
    pub fn new(mut metres: Array2<f32>) -> Self {
        metres.mapv_inplace(|z| {
            if z.is_finite() && z > 0.0 {
                z
            } else {
                f32::NAN
            }
        });
        Self { metres }
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> Size {
        Size::of_dim(self.metres.dim())
    }

    /// Depth at a pixel in metres, if known; `None` outside the map too.
    #[must_use]
    pub fn at(&self, x: usize, y: usize) -> Option<f32> {
        self.metres.get((y, x)).copied().filter(|z| z.is_finite())
    }

    /// The plane `[[y, x]]` in metres, NaN where unknown.
    #[must_use]
    pub fn metres(&self) -> ArrayView2<'_, f32> {
        self.metres.view()
    }
}
