use crate::gabor_kernels::gabor_kernels;
use crate::separable::Separable;
use crate::steerable_kernels::steerable_kernels;
use crate::{BadParams, GaborParams, Size, SteerableParams};

/// A family of oriented quadrature filters, with its parameters.
///
/// Every family answers with the same [`V1Responses`](crate::V1Responses): unit gain at the peak
/// frequency, no DC, phase growing along the wave vector.
///
/// The spherical quadrature filter is not among them, since it knows one orientation a pixel:
/// see [`MonogenicBank`](crate::MonogenicBank).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Family {
    /// A Gaussian times a complex wave; the paper's choice.
    Gabor(GaborParams),
    /// A derivative of a Gaussian and its approximate Hilbert transform (Freeman & Adelson).
    Steerable(SteerableParams),
}

impl Default for Family {
    fn default() -> Self {
        Self::Gabor(GaborParams::default())
    }
}

impl From<GaborParams> for Family {
    fn from(params: GaborParams) -> Self {
        Self::Gabor(params)
    }
}

impl From<SteerableParams> for Family {
    fn from(params: SteerableParams) -> Self {
        Self::Steerable(params)
    }
}

impl Family {
    /// The same filters at so many scales.
    pub(crate) const fn with_scales(self, scales: usize) -> Self {
        match self {
            Self::Gabor(params) => Self::Gabor(GaborParams { scales, ..params }),
            Self::Steerable(params) => Self::Steerable(SteerableParams { scales, ..params }),
        }
    }

    /// The Gabor filters of the same orientations, scales, peak frequency, bandwidth and width.
    #[must_use]
    pub const fn as_gabor(&self) -> GaborParams {
        match self {
            Self::Gabor(params) => *params,
            Self::Steerable(params) => params.as_gabor(),
        }
    }

    /// The same family with no more scales than an image of this size carries.
    #[must_use]
    pub fn fitted_to(self, size: Size) -> Self {
        match self {
            Self::Gabor(params) => Self::Gabor(params.fitted_to(size)),
            Self::Steerable(params) => Self::Steerable(params.fitted_to(size)),
        }
    }

    pub(crate) fn check(&self, size: Size) -> Result<(), BadParams> {
        match self {
            Self::Gabor(params) => params.check(size),
            Self::Steerable(params) => params.check(size),
        }
    }

    pub(crate) fn kernels(&self) -> Separable {
        match self {
            Self::Gabor(params) => gabor_kernels(params),
            Self::Steerable(params) => steerable_kernels(params),
        }
    }
}
