use ndarray::{Array2, ArrayView2, Zip};
use v1_gabor::Size;

/// Depth of every pixel of the left image: metres along the head's forward axis z.
///
/// What is not known is NaN inside the plane and `None` at [`DepthMap::at`]; known depths are
/// positive and finite. The default is the map of an image without a pixel, to be
/// [written over](crate::triangulate_into()).
#[derive(Clone, Debug, Default)]
pub struct DepthMap {
    metres: Array2<f32>,
    /// One standard deviation of the disparity that each depth was made of, px; of the map's size.
    disparity_sigma_px: Option<Array2<f32>>,
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
        Self {
            metres,
            disparity_sigma_px: None,
        }
    }

    /// The same map, knowing one standard deviation of the disparity that each of its depths was made
    /// of: a plane `[[y, x]]` of pixels, as [`DisparitySigma::of`](crate::DisparitySigma::of) makes it.
    /// Where it is not finite and not negative, the depth becomes unknown.
    ///
    /// # Errors
    /// [`WrongPlane`] if the plane has another size.
    pub fn with_disparity_sigma(self, sigma_px: Array2<f32>) -> Result<Self, WrongPlane> {
        self.matches(sigma_px.dim())?;
        let metres = Zip::from(&self.metres)
            .and(&sigma_px)
            .map_collect(|&z, &sigma| {
                if sigma.is_finite() && sigma >= 0.0 {
                    z
                } else {
                    f32::NAN
                }
            });
        Ok(Self {
            metres,
            disparity_sigma_px: Some(sigma_px),
        })
    }

    /// Writes over the map, with as much of its room as fits: `fill` is given the plane of metres, to be
    /// written at every pixel, and the plane of [`disparity_sigma_px`](Self::disparity_sigma_px), if it was
    /// known, or an empty one. What it leaves keeps the promises of [`Self::new`] and
    /// [`Self::with_disparity_sigma`], with a sigma if its plane is the map's size.
    pub(crate) fn write_over(
        &mut self,
        size: Size,
        fill: impl FnOnce(&mut Array2<f32>, &mut Array2<f32>),
    ) {
        if self.metres.dim() != size.dim() {
            self.metres = Array2::from_elem(size.dim(), f32::NAN);
        }
        let mut sigma_px = self.disparity_sigma_px.take().unwrap_or_default();
        fill(&mut self.metres, &mut sigma_px);
        debug_assert!(self.metres.iter().all(|&z| z.is_nan() || z > 0.0));
        self.disparity_sigma_px = (sigma_px.dim() == size.dim()).then_some(sigma_px);
    }

    /// One standard deviation of the disparity that the depth of each pixel was made of, in pixels,
    /// `[[y, x]]`, if the map knows it.
    #[must_use]
    pub fn disparity_sigma_px(&self) -> Option<ArrayView2<'_, f32>> {
        self.disparity_sigma_px.as_ref().map(|plane| plane.view())
    }

    fn matches(&self, dim: (usize, usize)) -> Result<(), WrongPlane> {
        let sizes = WrongPlane {
            depth: self.size(),
            plane: Size::of_dim(dim),
        };
        if sizes.depth == sizes.plane {
            Ok(())
        } else {
            Err(sizes)
        }
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
        let mut within = self.clone();
        within.metres.mapv_inplace(|z| {
            if (nearest_m..=farthest_m).contains(&z) {
                z
            } else {
                f32::NAN
            }
        });
        within
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
    /// [`WrongPlane`] if the plane has another size.
    pub fn only_confident(
        &self,
        confidence: ArrayView2<'_, f32>,
        least: f32,
    ) -> Result<Self, WrongPlane> {
        self.matches(confidence.dim())?;
        let mut confident = self.clone();
        Zip::from(&mut confident.metres)
            .and(confidence)
            .for_each(|z, &sure| {
                // A confidence that is no number is none.
                let kept = sure >= least;
                if !kept {
                    *z = f32::NAN;
                }
            });
        Ok(confident)
    }
}

/// A plane of another size than its depth map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a depth map of {depth} pixels has no use for a plane of {plane}")]
pub struct WrongPlane {
    /// Size of the depth map.
    pub depth: Size,
    /// Size of the plane.
    pub plane: Size,
}
