use ndarray::{Array2, ArrayView2, Zip};
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

    /// The same map with every depth unknown that is not from `nearest_m` to `farthest_m`.
    #[must_use]
    pub fn within(&self, nearest_m: f32, farthest_m: f32) -> Self {
        Self::new(self.metres.mapv(|z| {
            if (nearest_m..=farthest_m).contains(&z) {
                z
            } else {
                f32::NAN
            }
        }))
    }

    /// The part of the pixels whose depth is known, from 0 to 1.
    #[must_use]
    pub fn density(&self) -> f64 {
        let known = self.metres.iter().filter(|z| z.is_finite()).count();
        known as f64 / self.metres.len() as f64
    }

    /// The same map with every depth unknown whose confidence is below `least`.
    ///
    /// `confidence` is a plane `[[y, x]]` of the map's size, as a
    /// [`DisparityField`](disparity_pyramid::DisparityField) holds it.
    ///
    /// # Errors
    /// [`WrongConfidence`] if the plane has another size.
    pub fn only_confident(
        &self,
        confidence: ArrayView2<'_, f32>,
        least: f32,
    ) -> Result<Self, WrongConfidence> {
        let sizes = WrongConfidence {
            depth: self.size(),
            confidence: Size::of_dim(confidence.dim()),
        };
        if sizes.depth != sizes.confidence {
            return Err(sizes);
        }
        let metres = Zip::from(&self.metres)
            .and(confidence)
            .map_collect(|&z, &sure| if sure >= least { z } else { f32::NAN });
        Ok(Self { metres })
    }
}

/// A confidence plane of another size than its depth map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a depth map of {depth} pixels has no use for the confidence of {confidence}")]
pub struct WrongConfidence {
    /// Size of the depth map.
    pub depth: Size,
    /// Size of the confidence plane.
    pub confidence: Size,
}
