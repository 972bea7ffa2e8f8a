//! Complex Gabor responses of an image over scales and orientations: what primary visual cortex
//! (V1) knows of an image. The first level of *dorsal*, usable without the others.
//!
//! A [`FilterBank`] is planned once for images of one size and then answers as many as come.
//! [`V1Responses`] hold, scale by scale, the response of every orientation at every pixel:
//!
//! ```
//! use ndarray::Array2;
//! use v1_gabor::{FilterBank, GaborParams, LumaImage, Size};
//!
//! let size = Size { width: 96, height: 96 };
//! let bank = FilterBank::plan(GaborParams { scales: 3, ..GaborParams::default() }, size)?;
//!
//! // Bars 4 px apart, leaning so that their wave vector points 45 degrees down and right.
//! let k = std::f32::consts::FRAC_PI_2 / 2f32.sqrt();
//! let bars = |x: usize, y: usize| 0.5 + 0.2 * (k * x as f32 + k * y as f32).cos();
//! let image = LumaImage::new(Array2::from_shape_fn(size.dim(), |(y, x)| bars(x, y)))?;
//!
//! let responses = bank.respond(&image)?;
//! let finest = &responses.scales()[0];
//! // Orientation 2 of 8 is 45 degrees. Its amplitude is half the grating's, and its phase is the
//! // grating's own at this pixel.
//! let response = finest.at(2, 40, 52);
//! assert!((response.norm() - 0.1).abs() < 0.002);
//! let phase = k * (40.0 + 52.0);
//! assert!((response.arg() - phase.sin().atan2(phase.cos())).abs() < 0.02);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The filters
//! `h_q(x, y) = exp(-(x^2 + y^2) / (2 sigma^2)) exp(-j omega0 (x cos theta_q + y sin theta_q))`
//! with `theta_q = q pi / K`, applied as a correlation: equation 1 of Martinez-Martin and
//! del Pobil (2018). `theta` is the direction of the wave vector, not of the bars; `theta = 0` sees
//! horizontal shifts. Every filter is free of DC and has unit gain at its peak. The default is the
//! paper's: eight orientations, six scales, `omega0 = pi / 2` rad/px, one octave, 11 x 11 taps.
//!
//! Each scale is half the size of the one before ([1 4 6 4 1] / 16, every second pixel), so a
//! filter of one shape sees ever coarser structure. Borders are replicated.
//!
//! Other band-pass families answer through the same door: [`SteerableParams`] plans Freeman and
//! Adelson's quadrature pairs of second and fourth order, with the same [`V1Responses`] as answer.
//! The spherical quadrature filter has its own, as it gives one orientation a pixel and no more:
//! [`MonogenicBank`] and [`MonogenicResponses`].
//!
//! # What else is read off them
//! A response says more than its phase: [`Responses::energy`], [`Responses::amplitude`],
//! [`Responses::local_phase`], [`Responses::dominant_orientation`] with its strength,
//! [`Responses::instantaneous_frequency`], [`Responses::singularities`] (where a phase means
//! nothing), and over all scales [`V1Responses::phase_congruency`] (edges and lines). Unknown is
//! NaN in a plane.
//!
//! # How it is computed
//! [`FilterBank::respond`] writes each filter as a sum of products of one-dimensional kernels; eight
//! orientations share nine kernels and sixteen products. [`FilterBank::respond_by_fourier`] is the
//! second opinion: the same responses by way of the spectrum. Tests hold both against the direct
//! two-dimensional sum. Rows are spread over the caller's rayon pool, and the bits do not depend on
//! how many threads it has. The machine's vector width is found at run time; between AVX2 and the
//! base instructions ([`Instructions`]) the last bits differ, as one fuses additions.
//! [`FilterBank::respond_into`] works in planned buffers, for frame after frame.
mod ahead;
mod amplitude;
mod bank_workspace;
mod binocular;
mod dispatch;
mod dominant_orientation;
mod energy;
mod family;
mod filter_bank;
mod fourier;
mod gabor_kernels;
mod gabor_params;
mod instantaneous_frequency;
mod lanes;
mod local_phase;
mod logarithmic_derivative;
mod luma_image;
// What level 2's kernel shares with the bank's; no part of the interface.
#[doc(hidden)]
pub mod machine;
mod monogenic_bank;
mod monogenic_params;
mod monogenic_responses;
mod phase_congruency;
mod pyramid;
mod quadrature;
mod responses;
mod row_workspace;
mod samples;
mod separable;
mod separable_pass;
mod singularity;
mod size;
mod steerable_kernels;
mod steerable_params;
mod strip_kernel;
mod transform;
mod wave_vector;

pub use bank_workspace::BankWorkspace;
pub use binocular::Binocular;
pub use dispatch::Instructions;
pub use dominant_orientation::DominantOrientation;
pub use family::Family;
pub use filter_bank::{FilterBank, WrongSize};
pub use gabor_params::{BadParams, GaborParams};
pub use instantaneous_frequency::InstantaneousFrequency;
pub use luma_image::{LumaImage, NotAnImage};
pub use monogenic_bank::MonogenicBank;
pub use monogenic_params::MonogenicParams;
pub use monogenic_responses::{MonogenicPlanes, MonogenicResponse, MonogenicResponses};
pub use responses::{PixelResponses, Responses, V1Responses};
pub use row_workspace::RowWorkspace;
pub use size::Size;
pub use steerable_params::{SteerableOrder, SteerableParams};
pub use wave_vector::WaveVector;
