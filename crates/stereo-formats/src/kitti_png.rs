//! KITTI's disparity: a 16-bit grey PNG of `round(d * 256)`, 0 unknown.

use std::path::Path;

use disparity_pyramid::DisparityField;
use ndarray::{Array2, ArrayView2};

use crate::file::{self, Unreadable, Unwritable};
use crate::file_sign;
use crate::raster::{self, NotAPicture, NotAPng};

/// Steps of one pixel.
const STEPS: f32 = 256.0;

/// Why disparities do not go into a KITTI PNG.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BeyondKitti {
    /// The plane is no picture.
    #[error(transparent)]
    Plane(#[from] NotAPng),
    /// A disparity has no code.
    #[error(
        "d = {d} px at x = {x}, y = {y} has no code: a KITTI PNG holds 1/256 to 65535/256 px; \
         make it unknown or write a PFM file"
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

/// Decodes disparities `d` in pixels `[[y, x]]`, NaN where unknown.
///
/// # Errors
/// [`NotAPicture`] if the bytes are no 16-bit grey PNG.
pub fn decode(bytes: &[u8]) -> Result<Array2<f32>, NotAPicture> {
    let codes = raster::decode_codes(bytes)?.grey16()?;
    Ok(codes.mapv(|code| match code {
        0 => f32::NAN,
        code => f32::from(code) / STEPS,
    }))
}

/// Reads disparities `d`; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<Array2<f32>, Unreadable<NotAPicture>> {
    file::read(path.as_ref(), decode)
}

/// The KITTI PNG of disparities `d` in pixels `[[y, x]]`; whatever is not finite is unknown.
///
/// # Errors
/// [`BeyondKitti`] names the first disparity that has no code; none is bent to fit.
pub fn encode(d: ArrayView2<'_, f32>) -> Result<Vec<u8>, BeyondKitti> {
    let mut codes = Array2::zeros(d.dim());
    for (((y, x), &d), code) in d.indexed_iter().zip(&mut codes) {
        if d.is_finite() {
            let nearest = (d * STEPS).round();
            if !(1.0..=65535.0).contains(&nearest) {
                return Err(BeyondKitti::Disparity { x, y, d });
            }
            *code = nearest as u16;
        }
    }
    Ok(raster::encode_grey16(codes.view())?)
}

/// Writes disparities `d`, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(
    path: impl AsRef<Path>,
    d: ArrayView2<'_, f32>,
) -> Result<(), Unwritable<BeyondKitti>> {
    file::write(path.as_ref(), encode(d))
}

/// Writes the horizontal disparity of a field, `d = -dx`, whole or not at all: unknown where the
/// field is not valid, or, if `dense`, the best guess everywhere.
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write_disparity(
    path: impl AsRef<Path>,
    field: &DisparityField,
    dense: bool,
) -> Result<(), Unwritable<BeyondKitti>> {
    write(path, file_sign::d_of_field(field, dense).view())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_code_is_named() {
        let encode = |d: f32| encode(ndarray::array![[1.0, d]].view());
        for d in [-1.0, 0.0, 0.001, 256.0] {
            assert_eq!(encode(d), Err(BeyondKitti::Disparity { x: 1, y: 0, d }));
        }
        let plane = decode(&encode(f32::NAN).unwrap()).unwrap();
        assert_eq!(plane[[0, 0]], 1.0);
        assert!(plane[[0, 1]].is_nan());
    }
}
