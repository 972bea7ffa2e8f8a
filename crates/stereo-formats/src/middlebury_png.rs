//! Middlebury's disparity of 2001 to 2006: an 8-bit grey PNG, `d = grey / scale`.

use std::path::Path;

use ndarray::{Array2, ArrayView2};

use crate::file::{self, Unreadable, Unwritable};
use crate::raster::{self, NotAPicture, NotAPng};

/// How grey values stand for disparities; the file itself does not say.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GreyScale {
    steps_per_px: f32,
    unknown: u8,
}

/// A scale that turns no grey value into a disparity.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{0} grey values a pixel are no scale; it must be positive and finite")]
pub struct BadScale(pub f32);

/// Why disparities do not go into a Middlebury PNG.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BeyondGrey {
    /// The plane is no picture.
    #[error(transparent)]
    Plane(#[from] NotAPng),
    /// A disparity has no grey value, or only the one that means unknown.
    #[error(
        "d = {d} px at x = {x}, y = {y} has no grey value of its own; make it unknown, choose \
         another scale or write a PFM file"
    )]
    Disparity {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// The disparity there, in pixels.
        d: f32,
    },
}

impl GreyScale {
    /// A scale of so many grey values to a pixel of disparity, with one value that means unknown.
    ///
    /// # Errors
    /// [`BadScale`] if the scale is not positive and finite.
    pub fn new(steps_per_px: f32, unknown: u8) -> Result<Self, BadScale> {
        if steps_per_px.is_finite() && steps_per_px > 0.0 {
            Ok(Self {
                steps_per_px,
                unknown,
            })
        } else {
            Err(BadScale(steps_per_px))
        }
    }

    /// Decodes disparities `d` in pixels `[[y, x]]`, NaN where unknown.
    ///
    /// # Errors
    /// [`NotAPicture`] if the bytes are no grey PNG of at most 8 bits.
    pub fn decode(self, bytes: &[u8]) -> Result<Array2<f32>, NotAPicture> {
        let greys = raster::decode_codes(bytes)?.grey8()?;
        Ok(greys.mapv(|grey| {
            if grey == u16::from(self.unknown) {
                f32::NAN
            } else {
                f32::from(grey) / self.steps_per_px
            }
        }))
    }

    /// Reads disparities `d`; see [`GreyScale::decode`].
    ///
    /// # Errors
    /// [`Unreadable`] names the file and what is wrong with it.
    pub fn read(self, path: impl AsRef<Path>) -> Result<Array2<f32>, Unreadable<NotAPicture>> {
        file::read(path.as_ref(), |bytes| self.decode(bytes))
    }

    /// The grey PNG of disparities `d` in pixels `[[y, x]]`, each rounded to the nearest grey
    /// value; whatever is not finite is unknown.
    ///
    /// # Errors
    /// [`BeyondGrey`] names the first disparity that has no grey value; none is bent to fit.
    pub fn encode(self, d: ArrayView2<'_, f32>) -> Result<Vec<u8>, BeyondGrey> {
        let mut greys = Array2::from_elem(d.dim(), self.unknown);
        for (((y, x), &d), grey) in d.indexed_iter().zip(&mut greys) {
            if d.is_finite() {
                let nearest = (d * self.steps_per_px).round();
                if !(0.0..=255.0).contains(&nearest) || nearest == f32::from(self.unknown) {
                    return Err(BeyondGrey::Disparity { x, y, d });
                }
                *grey = nearest as u8;
            }
        }
        Ok(raster::encode_grey8(greys.view())?)
    }

    /// Writes disparities `d`, whole or not at all; see [`GreyScale::encode`].
    ///
    /// # Errors
    /// [`Unwritable`] names the file and what stood in the way.
    pub fn write(
        self,
        path: impl AsRef<Path>,
        d: ArrayView2<'_, f32>,
    ) -> Result<(), Unwritable<BeyondGrey>> {
        file::write(path.as_ref(), self.encode(d))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scales_and_disparities_that_cannot_be() {
        for scale in [0.0, -8.0, f32::NAN, f32::INFINITY] {
            assert!(GreyScale::new(scale, 0).is_err());
        }
        let scale = GreyScale::new(8.0, 0).unwrap();
        for d in [-1.0, 0.0, 32.0] {
            let refused = BeyondGrey::Disparity { x: 0, y: 0, d };
            assert_eq!(scale.encode(ndarray::array![[d]].view()), Err(refused));
        }
    }
}
