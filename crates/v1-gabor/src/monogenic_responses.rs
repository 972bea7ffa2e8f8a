use std::f32::consts::PI;

use ndarray::{Array2, ArrayView2};
use num_complex::Complex32;

use crate::{MonogenicParams, Size};

/// What a spherical quadrature filter says at one pixel: the even part, and an odd part that is a
/// vector.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonogenicResponse {
    /// The isotropic band-pass `e`.
    pub even: f32,
    /// The x component `r1` of the Riesz transform.
    pub along_x: f32,
    /// The y component `r2` of the Riesz transform.
    pub along_y: f32,
}

/// The monogenic responses at every pixel of one scale.
#[derive(Clone, Debug, PartialEq)]
pub struct MonogenicPlanes {
    even: Array2<f32>,
    along_x: Array2<f32>,
    along_y: Array2<f32>,
}

/// The monogenic responses of an image over scales, finest first: one local orientation a pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct MonogenicResponses {
    params: MonogenicParams,
    scales: Vec<MonogenicPlanes>,
}

impl MonogenicResponse {
    /// `sqrt(e^2 + r1^2 + r2^2)`, in units of luma: half the amplitude of a grating at the peak.
    #[must_use]
    pub fn amplitude(self) -> f32 {
        self.even.hypot(self.along_x.hypot(self.along_y))
    }

    /// The local phase `atan2(|r|, e)` in `[0, pi]` radians: 0 on a bright line, `pi / 2` on an
    /// edge, `pi` on a dark line. Which side of an edge is bright, `r` tells.
    #[must_use]
    pub fn phase(self) -> f32 {
        self.along_x.hypot(self.along_y).atan2(self.even)
    }

    /// The local orientation `atan2(r2, r1)` modulo `pi`, in `[0, pi)` radians: the direction
    /// across the bars, like `theta_q`. `None` where `r` is 0, on the crest of a line.
    #[must_use]
    pub fn theta_rad(self) -> Option<f32> {
        let some = self.along_x != 0.0 || self.along_y != 0.0;
        // The remainder of a tiny negative angle may round up to pi itself.
        some.then(|| self.along_y.atan2(self.along_x).rem_euclid(PI) % PI)
    }

    /// The complex response seen along the direction `theta_rad`: `e + j (r1 cos + r2 sin)`.
    ///
    /// Where the image varies along that direction only, this is what an oriented quadrature pair
    /// would say, and its phase grows that way.
    #[must_use]
    pub fn along(self, theta_rad: f32) -> Complex32 {
        let odd = self.along_x * theta_rad.cos() + self.along_y * theta_rad.sin();
        Complex32::new(self.even, odd)
    }
}

impl MonogenicPlanes {
    /// Takes the three parts, each `[[y, x]]`, of one size.
    pub(crate) const fn new(even: Array2<f32>, along_x: Array2<f32>, along_y: Array2<f32>) -> Self {
        Self {
            even,
            along_x,
            along_y,
        }
    }

    /// Width and height of this scale in its own pixels.
    #[must_use]
    pub fn size(&self) -> Size {
        Size::of_dim(self.even.dim())
    }

    /// The response at one pixel.
    ///
    /// # Panics
    /// If the pixel lies outside this scale.
    #[must_use]
    pub fn at(&self, x: usize, y: usize) -> MonogenicResponse {
        MonogenicResponse {
            even: self.even[[y, x]],
            along_x: self.along_x[[y, x]],
            along_y: self.along_y[[y, x]],
        }
    }

    /// The band-passed image `e`, `[[y, x]]`.
    #[must_use]
    pub fn even(&self) -> ArrayView2<'_, f32> {
        self.even.view()
    }

    /// The x component `r1` of the Riesz transform, `[[y, x]]`.
    #[must_use]
    pub fn along_x(&self) -> ArrayView2<'_, f32> {
        self.along_x.view()
    }

    /// The y component `r2` of the Riesz transform, `[[y, x]]`.
    #[must_use]
    pub fn along_y(&self) -> ArrayView2<'_, f32> {
        self.along_y.view()
    }
}

impl MonogenicResponses {
    /// Takes the responses of each scale, finest first.
    pub(crate) const fn new(params: MonogenicParams, scales: Vec<MonogenicPlanes>) -> Self {
        Self { params, scales }
    }

    /// The parameters of the bank that answered.
    #[must_use]
    pub const fn params(&self) -> MonogenicParams {
        self.params
    }

    /// The scales, finest first. There is at least one.
    #[must_use]
    pub fn scales(&self) -> &[MonogenicPlanes] {
        &self.scales
    }

    /// The size of the image that was answered.
    #[must_use]
    pub fn size(&self) -> Size {
        self.scales[0].size()
    }
}
