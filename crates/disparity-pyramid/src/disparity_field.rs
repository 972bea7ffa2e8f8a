use ndarray::{Array2, ArrayView2, Zip};
use v1_gabor::Size;

use crate::{ShiftCovariance, Validity};

/// Vector disparity at every pixel of the left image, with the estimator's own word on each.
///
/// Left `(x, y)` matches right `(x + dx, y + dy)`; a nearer point has a smaller `dx` on a
/// parallel rig. `dx` and `dy` are finite everywhere (a best guess where nothing better is
/// known), `confidence` lies in `[0, 1]`, and `validity` says which pixels are answers. An estimator
/// that fits says also how uncertain each answer is, in pixels ([`ShiftCovariance`]). All planes are `[[y, x]]`.
/// The default is the field of an image without a pixel, to be [written over](crate::estimate_into).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DisparityField {
    pub(crate) dx: Array2<f32>,
    pub(crate) dy: Array2<f32>,
    pub(crate) confidence: Array2<f32>,
    pub(crate) validity: Array2<Validity>,
    /// Unknown where not valid.
    pub(crate) covariance: Option<Array2<ShiftCovariance>>,
}

/// The disparity of one pixel that the estimator stands behind.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disparity {
    /// Shift along x, right minus left, in pixels.
    pub dx: f32,
    /// Shift along y, right minus left, in pixels.
    pub dy: f32,
    /// How sure the estimator is, from 0 to 1.
    pub confidence: f32,
    /// How uncertain the shift is, if the estimator says so.
    pub covariance: Option<ShiftCovariance>,
}

/// Why four planes are not a disparity field.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NotAField {
    /// The planes differ in size.
    #[error("the planes of a field have one size, and these have {first} and {other}")]
    Sizes {
        /// Size of `dx`.
        first: Size,
        /// The first size that differs from it.
        other: Size,
    },
    /// A shift is not finite, or a confidence lies outside `[0, 1]`.
    #[error("dx = {dx}, dy = {dy}, confidence = {confidence} at x = {x}, y = {y} cannot be")]
    Value {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// Horizontal shift there, in pixels.
        dx: f32,
        /// Vertical shift there, in pixels.
        dy: f32,
        /// Confidence there.
        confidence: f32,
    },
}

impl DisparityField {
    /// Takes four planes `[[y, x]]` as a field.
    ///
    /// # Errors
    /// [`NotAField`] if the sizes differ, a shift is not finite or a confidence is outside
    /// `[0, 1]`.
    pub fn new(
        dx: Array2<f32>,
        dy: Array2<f32>,
        confidence: Array2<f32>,
        validity: Array2<Validity>,
    ) -> Result<Self, NotAField> {
        let first = Size::of_dim(dx.dim());
        for dim in [dy.dim(), confidence.dim(), validity.dim()] {
            let other = Size::of_dim(dim);
            if other != first {
                return Err(NotAField::Sizes { first, other });
            }
        }
        for (((y, x), &dx), (&dy, &confidence)) in
            dx.indexed_iter().zip(dy.iter().zip(confidence.iter()))
        {
            if !(dx.is_finite() && dy.is_finite() && (0.0..=1.0).contains(&confidence)) {
                return Err(NotAField::Value {
                    x,
                    y,
                    dx,
                    dy,
                    confidence,
                });
            }
        }
        Ok(Self {
            dx,
            dy,
            confidence,
            validity,
            covariance: None,
        })
    }

    /// Writes over the field, in as much of its room as fits: `answer` gives the disparity and the validity
    /// of each pixel `(x, y)`. A shift that is not finite, or a confidence outside `[0, 1]`, becomes 0 and
    /// incoherent; what it says of covariances is not taken.
    pub fn write_over(
        &mut self,
        size: Size,
        answer: impl Fn(usize, usize) -> (Disparity, Validity) + Sync,
    ) {
        if self.size() != size {
            for plane in [&mut self.dx, &mut self.dy, &mut self.confidence] {
                *plane = Array2::zeros(size.dim());
            }
            self.validity = Array2::from_elem(size.dim(), Validity::NoEnergy);
        }
        self.covariance = None;
        Zip::indexed(&mut self.dx)
            .and(&mut self.dy)
            .and(&mut self.confidence)
            .and(&mut self.validity)
            .par_for_each(|(y, x), dx, dy, confidence, validity| {
                let (found, reason) = answer(x, y);
                let sound = found.dx.is_finite()
                    && found.dy.is_finite()
                    && (0.0..=1.0).contains(&found.confidence);
                (*dx, *dy, *confidence, *validity) = if sound {
                    (found.dx, found.dy, found.confidence, reason)
                } else {
                    (0.0, 0.0, 0.0, Validity::Incoherent)
                };
            });
    }

    /// Takes planes that the estimator has made, of one size and all finite by construction.
    pub(crate) fn trusted(
        dx: Array2<f32>,
        dy: Array2<f32>,
        confidence: Array2<f32>,
        validity: Array2<Validity>,
    ) -> Self {
        debug_assert!(
            dx.iter()
                .chain(&dy)
                .chain(&confidence)
                .all(|v| v.is_finite())
        );
        Self {
            dx,
            dy,
            confidence,
            validity,
            covariance: None,
        }
    }

    /// The same field with the covariance of each answer, a plane of its size.
    pub(crate) fn with_covariance(self, covariance: Option<Array2<ShiftCovariance>>) -> Self {
        debug_assert!(
            covariance
                .as_ref()
                .is_none_or(|plane| plane.dim() == self.dx.dim())
        );
        Self { covariance, ..self }
    }

    /// Gives another reason where one pixel or another has no answer: `reason` is asked at those of
    /// too little energy.
    pub(crate) fn give_reasons(&mut self, reason: impl Fn(usize, usize, Disparity) -> Validity) {
        for y in 0..self.size().height {
            for x in 0..self.size().width {
                if self.validity[[y, x]] == Validity::NoEnergy {
                    self.validity[[y, x]] = reason(x, y, self.guess(x, y));
                }
            }
        }
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> Size {
        Size::of_dim(self.dx.dim())
    }

    /// The disparity at a pixel, if the estimator stands behind it; `None` outside the image too.
    #[must_use]
    pub fn at(&self, x: usize, y: usize) -> Option<Disparity> {
        self.validity
            .get((y, x))?
            .is_valid()
            .then(|| self.guess(x, y))
    }

    /// The best guess at a pixel, whatever its validity.
    ///
    /// # Panics
    /// If the pixel lies outside the image.
    #[must_use]
    pub fn guess(&self, x: usize, y: usize) -> Disparity {
        Disparity {
            dx: self.dx[[y, x]],
            dy: self.dy[[y, x]],
            confidence: self.confidence[[y, x]],
            covariance: self.covariance.as_ref().map(|plane| plane[[y, x]]),
        }
    }

    /// Horizontal shifts `[[y, x]]` in pixels, finite everywhere: a best guess where not valid.
    #[must_use]
    pub fn dx(&self) -> ArrayView2<'_, f32> {
        self.dx.view()
    }

    /// Vertical shifts `[[y, x]]` in pixels, finite everywhere: a best guess where not valid.
    #[must_use]
    pub fn dy(&self) -> ArrayView2<'_, f32> {
        self.dy.view()
    }

    /// Confidence `[[y, x]]`, from 0 to 1.
    #[must_use]
    pub fn confidence(&self) -> ArrayView2<'_, f32> {
        self.confidence.view()
    }

    /// The covariance of each shift `[[y, x]]`, unknown (infinite) where not valid; `None` if the
    /// estimator does not say ([`MatchParams::covariance`](crate::MatchParams::covariance)).
    #[must_use]
    pub fn covariance(&self) -> Option<ArrayView2<'_, ShiftCovariance>> {
        self.covariance.as_ref().map(|plane| plane.view())
    }

    /// Validity `[[y, x]]`.
    #[must_use]
    pub fn validity(&self) -> ArrayView2<'_, Validity> {
        self.validity.view()
    }

    /// `plane` with NaN, the library's word for unknown, wherever this field is not valid.
    ///
    /// # Panics
    /// If the plane has another size than the field.
    #[must_use]
    pub fn only_valid(&self, plane: ArrayView2<'_, f32>) -> Array2<f32> {
        Zip::from(plane)
            .and(&self.validity)
            .map_collect(|&value, validity| if validity.is_valid() { value } else { f32::NAN })
    }

    /// The part of the pixels that are valid, from 0 to 1.
    #[must_use]
    pub fn density(&self) -> f64 {
        let valid = self.validity.iter().filter(|v| v.is_valid()).count();
        valid as f64 / self.validity.len() as f64
    }
}
