use std::f32::consts::TAU;

use ndarray::{Array2, ArrayView2, s};
use num_complex::Complex32;

use crate::filter_bank::pad;
use crate::pyramid::reduce;
use crate::transform::{Direction, transform};
use crate::{
    BadParams, LumaImage, MonogenicParams, MonogenicPlanes, MonogenicResponses, Size, WrongSize,
};

/// A bank of spherical quadrature filters (Felsberg & Sommer 2001), planned for images of one size.
///
/// An isotropic band-pass `e` and its Riesz transform, `H1 = -j wx / |w|` and `H2 = -j wy / |w|`
/// times the same band: a quadrature pair turned at every pixel to where the structure is. It tells
/// **one** orientation a pixel, the local one, and has nothing to say of crossings. Built in the
/// Fourier domain.
///
/// ```
/// use ndarray::Array2;
/// use v1_gabor::{LumaImage, MonogenicBank, MonogenicParams, Size};
///
/// let size = Size { width: 64, height: 48 };
/// let bank = MonogenicBank::plan(MonogenicParams::default().fitted_to(size), size)?;
/// let bars = Array2::from_shape_fn(size.dim(), |(_, x)| 0.2 * (1.5 * x as f32).cos());
/// let responses = bank.respond(&LumaImage::new(bars)?)?;
/// let response = responses.scales()[0].at(32, 24);
/// assert!((response.amplitude() - 0.1).abs() < 0.005);
/// assert!(response.theta_rad().expect("bars have a direction").sin() < 0.02);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MonogenicBank {
    params: MonogenicParams,
    size: Size,
}

impl MonogenicBank {
    /// Plans a bank for images of one size.
    ///
    /// # Errors
    /// [`BadParams`] says which parameter cannot be, and why.
    pub fn plan(params: MonogenicParams, size: Size) -> Result<Self, BadParams> {
        params.check(size)?;
        Ok(Self { params, size })
    }

    /// The parameters that the bank was planned with.
    #[must_use]
    pub const fn params(&self) -> MonogenicParams {
        self.params
    }

    /// The size of the images that the bank was planned for.
    #[must_use]
    pub const fn size(&self) -> Size {
        self.size
    }

    /// The responses at every scale, finest first.
    ///
    /// # Errors
    /// [`WrongSize`] if the image has another size than the bank was planned for.
    pub fn respond(&self, image: &LumaImage) -> Result<MonogenicResponses, WrongSize> {
        if image.size() != self.size {
            return Err(WrongSize {
                planned: self.size,
                given: image.size(),
            });
        }
        let mut scales = vec![self.respond_at_one_scale(image.plane())];
        let mut plane: Option<Array2<f32>> = None;
        for _ in 1..self.params.scales {
            let coarser = reduce(plane.as_ref().map_or(image.plane(), |plane| plane.view()));
            scales.push(self.respond_at_one_scale(coarser.view()));
            plane = Some(coarser);
        }
        Ok(MonogenicResponses::new(self.params, scales))
    }

    fn respond_at_one_scale(&self, plane: ArrayView2<'_, f32>) -> MonogenicPlanes {
        let (height, width) = plane.dim();
        let margin = self.params.margin();
        let padded = pad(plane, margin);
        let (rows, columns) = padded.dim();
        let mut even = padded.mapv(|luma| Complex32::new(luma, 0.0));
        transform(&mut even, Direction::Forward);
        let mut riesz = Array2::zeros(even.dim());
        for ((row, column), spectrum) in even.indexed_iter_mut() {
            let (along_x, along_y) = (frequency(column, columns), frequency(row, rows));
            let omega = along_x.hypot(along_y);
            *spectrum *= self.params.radial_gain(omega) / (rows * columns) as f32;
            if omega > 0.0 {
                // Both Riesz parts are real planes, so one complex transform carries them both:
                // H1 + j H2 = (wy - j wx) / |w|. At the Nyquist frequency, its own opposite, an
                // odd function is 0.
                let odd = |w: f32, k, n| if 2 * k == n { 0.0 } else { w / omega };
                let riesz_gain =
                    Complex32::new(odd(along_y, row, rows), -odd(along_x, column, columns));
                riesz[[row, column]] = *spectrum * riesz_gain;
            }
        }
        transform(&mut even, Direction::Inverse);
        transform(&mut riesz, Direction::Inverse);
        let inner = s![margin..margin + height, margin..margin + width];
        MonogenicPlanes::new(
            even.slice(inner).mapv(|value| value.re),
            riesz.slice(inner).mapv(|value| value.re),
            riesz.slice(inner).mapv(|value| value.im),
        )
    }
}

/// The frequency of bin `k` of `length`, in `(-pi, pi]` rad/px.
fn frequency(k: usize, length: usize) -> f32 {
    let signed = if 2 * k > length {
        k as f32 - length as f32
    } else {
        k as f32
    };
    TAU * signed / length as f32
}
