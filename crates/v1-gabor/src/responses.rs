use ndarray::Array2;
use num_complex::Complex32;

use crate::samples::Samples;
use crate::{GaborParams, Size};

/// The complex responses of every orientation at every pixel of one scale.
///
/// For an image `exp(j w.x)` the response of a filter with transfer function `H` is
/// `H(w) exp(j w.x)`: phase grows along the wave vector, and the gain at the peak frequency is 1,
/// so that a grating of amplitude `A` answers with amplitude `A / 2`.
#[derive(Clone, Debug, PartialEq)]
pub struct Responses {
    params: GaborParams,
    size: Size,
    /// Row-major `[[y, x, part]]`: the even (real) parts of all orientations, then the odd (imaginary) ones.
    ///
    /// What one pixel says lies in one place (a cache line for eight orientations), because who
    /// reads a response at a shifted position reads all orientations there.
    samples: Samples,
}

/// The even and odd parts of all orientations at one pixel, by orientation.
#[derive(Clone, Copy, Debug)]
pub struct PixelResponses<'a> {
    /// Real parts: the responses of the cosine filters.
    pub even: &'a [f32],
    /// Imaginary parts: the responses of the sine filters.
    pub odd: &'a [f32],
}

/// What primary visual cortex knows of an image: [`Responses`] over scales, finest first.
#[derive(Clone, Debug, PartialEq)]
pub struct V1Responses {
    params: GaborParams,
    scales: Vec<Responses>,
}

impl Responses {
    /// The responses to a black image.
    pub(crate) fn silence(params: GaborParams, size: Size) -> Self {
        let samples = Samples::zeros(size.area() * 2 * params.orientations);
        Self {
            params,
            size,
            samples,
        }
    }

    /// Every number, row-major `[[y, x, part]]`: for each pixel the even (real) parts of all
    /// orientations, then the odd (imaginary) ones. For who walks whole rows.
    #[inline(always)]
    #[must_use]
    pub fn samples(&self) -> &[f32] {
        self.samples.as_slice()
    }

    /// The samples, row-major, to be written over.
    pub(crate) fn samples_mut(&mut self) -> &mut [f32] {
        self.samples.as_mut_slice()
    }

    /// The parameters of the bank that answered. Frequencies are in radians a pixel of this scale.
    #[must_use]
    pub const fn params(&self) -> GaborParams {
        self.params
    }

    /// Width and height of this scale in its own pixels.
    #[inline(always)]
    #[must_use]
    pub const fn size(&self) -> Size {
        self.size
    }

    /// The number of orientations.
    #[must_use]
    pub const fn orientations(&self) -> usize {
        self.params.orientations
    }

    /// The responses of all orientations at one pixel.
    ///
    /// # Panics
    /// If the pixel lies outside this scale.
    #[inline(always)]
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> PixelResponses<'_> {
        let Size { width, height } = self.size;
        let parts = 2 * self.orientations();
        assert!(
            x < width && y < height,
            "no pixel ({x}, {y}) in {width} x {height}"
        );
        let start = (y * width + x) * parts;
        let (even, odd) = self.samples()[start..start + parts].split_at(parts / 2);
        PixelResponses { even, odd }
    }

    /// The response of one orientation at one pixel.
    ///
    /// # Panics
    /// If there is no such orientation or pixel.
    #[must_use]
    pub fn at(&self, orientation: usize, x: usize, y: usize) -> Complex32 {
        let pixel = self.pixel(x, y);
        Complex32::new(pixel.even[orientation], pixel.odd[orientation])
    }

    /// All responses of one orientation as a plane `[[y, x]]`.
    ///
    /// # Panics
    /// If there is no such orientation.
    #[must_use]
    pub fn plane(&self, orientation: usize) -> Array2<Complex32> {
        Array2::from_shape_fn(self.size().dim(), |(y, x)| self.at(orientation, x, y))
    }
}

impl V1Responses {
    /// Takes the responses of each scale, finest first.
    pub(crate) const fn new(params: GaborParams, scales: Vec<Responses>) -> Self {
        Self { params, scales }
    }

    /// The parameters of the bank that answered.
    #[must_use]
    pub const fn params(&self) -> GaborParams {
        self.params
    }

    /// The scales, finest first. There is at least one.
    #[must_use]
    pub fn scales(&self) -> &[Responses] {
        &self.scales
    }

    /// The scales, to be written over.
    pub(crate) fn scales_mut(&mut self) -> &mut [Responses] {
        &mut self.scales
    }

    /// The size of the image that was answered.
    #[must_use]
    pub fn size(&self) -> Size {
        self.scales[0].size()
    }
}
