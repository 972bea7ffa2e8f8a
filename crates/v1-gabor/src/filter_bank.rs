use ndarray::{Array2, Array3, ArrayView2};
use num_complex::Complex32;
use rayon::prelude::*;

use crate::pyramid::reduce;
use crate::separable::Separable;
use crate::separable_pass::SeparablePass;
use crate::{BadParams, GaborParams, LumaImage, Responses, Size, V1Responses};

/// A bank of oriented Gabor filters, planned for images of one size and good for any number of
/// them.
///
/// `h_q(x, y) = exp(-(x^2 + y^2) / (2 sigma^2)) exp(-j omega0 (x cos theta_q + y sin theta_q))`
/// (equation 1 of the paper), applied as a correlation so that phase grows with `x`, freed of its
/// DC, scaled to unit gain at its peak.
///
/// ```
/// use ndarray::Array2;
/// use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};
///
/// let size = Size { width: 64, height: 48 };
/// let bank = FilterBank::plan(GaborParams { scales: 3, ..GaborParams::default() }, size)?;
/// let grating = Array2::from_shape_fn(size.dim(), |(_, x)| (1.5 * x as f32).sin());
/// let responses = bank.respond(&LumaImage::new(grating)?)?;
/// let finest = &responses.scales()[0];
/// // Vertical bars excite the orientation whose wave vector lies along x, not the one across it.
/// assert!(finest.at(0, 32, 24).norm() > 100.0 * finest.at(4, 32, 24).norm());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FilterBank {
    params: GaborParams,
    size: Size,
    separable: Separable,
}

/// The image has another size than the bank was planned for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("this bank was planned for images of {planned} and got one of {given}")]
pub struct WrongSize {
    /// Size the bank was planned for.
    pub planned: Size,
    /// Size of the image.
    pub given: Size,
}

impl FilterBank {
    /// Plans a bank for images of one size.
    ///
    /// # Errors
    /// [`BadParams`] says which parameter cannot be, and why.
    pub fn plan(params: GaborParams, size: Size) -> Result<Self, BadParams> {
        params.check(size)?;
        Ok(Self {
            params,
            size,
            separable: Separable::new(&params),
        })
    }

    /// The parameters that the bank was planned with.
    #[must_use]
    pub const fn params(&self) -> GaborParams {
        self.params
    }

    /// The size of the images that the bank was planned for.
    #[must_use]
    pub const fn size(&self) -> Size {
        self.size
    }

    /// The filter of one orientation, `[[y, x]]`, `taps x taps`, its centre in the middle.
    ///
    /// The response at a pixel is the sum over the taps of the image around that pixel times the
    /// filter (a correlation: the filter is not turned round).
    ///
    /// # Panics
    /// If there is no such orientation.
    #[must_use]
    pub fn filter(&self, orientation: usize) -> Array2<Complex32> {
        let recipe = &self.separable.recipes[orientation];
        let radius = self.params.radius as isize;
        let taps = self.params.taps();
        Array2::from_shape_fn((taps, taps), |(y, x)| {
            self.separable
                .sample(recipe, x as isize - radius, y as isize - radius)
        })
    }

    /// The responses of every orientation at every scale, finest first.
    ///
    /// # Errors
    /// [`WrongSize`] if the image has another size than the bank was planned for.
    pub fn respond(&self, image: &LumaImage) -> Result<V1Responses, WrongSize> {
        self.respond_with(image, |plane| self.respond_at_one_scale(plane))
    }

    /// Walks the pyramid of an image, finest scale first, with one way to filter a plane.
    pub(crate) fn respond_with(
        &self,
        image: &LumaImage,
        filter: impl Fn(ArrayView2<'_, f32>) -> Responses,
    ) -> Result<V1Responses, WrongSize> {
        if image.size() != self.size {
            return Err(WrongSize {
                planned: self.size,
                given: image.size(),
            });
        }
        let mut scales = vec![filter(image.plane())];
        let mut plane: Option<Array2<f32>> = None;
        for _ in 1..self.params.scales {
            let coarser = reduce(plane.as_ref().map_or(image.plane(), |plane| plane.view()));
            scales.push(filter(coarser.view()));
            plane = Some(coarser);
        }
        Ok(V1Responses::new(self.params, scales))
    }

    fn respond_at_one_scale(&self, plane: ArrayView2<'_, f32>) -> Responses {
        let size = Size::of_dim(plane.dim());
        let parts = 2 * self.params.orientations;
        let padded = pad(plane, self.params.radius);
        let pass = SeparablePass::new(&self.separable);
        let mut samples = Array3::zeros((size.height, size.width, parts));
        samples
            .as_slice_mut()
            .expect("a fresh array is contiguous")
            .par_chunks_mut(size.width * parts)
            .enumerate()
            .for_each_init(
                || pass.workspace(size.width),
                |workspace, (y, row)| pass.respond_row(padded.view(), y, row, workspace),
            );
        Responses::new(self.params, samples)
    }
}

/// The plane with its border replicated `radius` pixels outwards on every side.
pub(crate) fn pad(plane: ArrayView2<'_, f32>, radius: usize) -> Array2<f32> {
    let (height, width) = plane.dim();
    Array2::from_shape_fn((height + 2 * radius, width + 2 * radius), |(y, x)| {
        let y = y.saturating_sub(radius).min(height - 1);
        let x = x.saturating_sub(radius).min(width - 1);
        plane[[y, x]]
    })
}
