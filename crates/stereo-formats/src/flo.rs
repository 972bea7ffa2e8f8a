//! Middlebury's `.flo`: two 32-bit floats a pixel, the shift along x and along y.

use std::path::Path;

use disparity_pyramid::DisparityField;
use ndarray::Array2;
use v1_gabor::Size;

use crate::file::{self, Unreadable, Unwritable};
use crate::file_sign;
use crate::vector_planes::{NotVectors, VectorPlanes};

/// The number every file begins with; its little-endian bytes read `PIEH`.
const MAGIC: f32 = 202_021.25;

/// A shift beyond this is unknown.
const LARGEST_SHIFT: f32 = 1e9;

/// What is written for an unknown shift.
const UNKNOWN: f32 = 1e10;

/// Bytes before the first vector: the magic number, width, height.
const HEADER: usize = 12;

/// Why bytes are not a `.flo` file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotFlo {
    /// The first four bytes are not the format's own.
    #[error("its first four bytes are not 'PIEH'; a Middlebury .flo file is needed")]
    Magic,
    /// The file ends inside the header.
    #[error("its {0} bytes end inside the header of {HEADER}; it is cut short")]
    Header(usize),
    /// The header claims a size that no picture has.
    #[error("the header claims {width} x {height} vectors, and both must be positive")]
    Extent {
        /// The claimed width.
        width: i32,
        /// The claimed height.
        height: i32,
    },
    /// The bytes behind the header are not as many as it claims.
    #[error(
        "the header claims {size} vectors, 8 bytes each, and {bytes} bytes follow it; \
         the file is cut short or damaged"
    )]
    Length {
        /// What the header claims.
        size: Size,
        /// What follows it.
        bytes: usize,
    },
}

/// Why vectors do not go into a `.flo` file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BeyondFlo {
    /// The planes are no vector field.
    #[error(transparent)]
    Vectors(#[from] NotVectors),
    /// A side is longer than the header's 31 bits hold.
    #[error("{0} vectors are more than the header of a .flo file can say")]
    Extent(Size),
}

/// Decodes a `.flo` file; a shift beyond 1e9 (or no number) is unknown and comes back as NaN.
///
/// # Errors
/// [`NotFlo`] says what is wrong.
pub fn decode(bytes: &[u8]) -> Result<VectorPlanes, NotFlo> {
    let (magic, rest) = bytes.split_first_chunk().ok_or(NotFlo::Magic)?;
    if *magic != MAGIC.to_le_bytes() {
        return Err(NotFlo::Magic);
    }
    let cut = NotFlo::Header(bytes.len());
    let (width, rest) = rest.split_first_chunk().ok_or(cut)?;
    let (height, data) = rest.split_first_chunk().ok_or(cut)?;
    let (width, height) = (i32::from_le_bytes(*width), i32::from_le_bytes(*height));
    let side = |claimed: i32| usize::try_from(claimed).ok().filter(|&side| side > 0);
    let (Some(across), Some(down)) = (side(width), side(height)) else {
        return Err(NotFlo::Extent { width, height });
    };
    let size = Size {
        width: across,
        height: down,
    };
    let wrong_length = NotFlo::Length {
        size,
        bytes: data.len(),
    };
    let claimed = across
        .checked_mul(down)
        .and_then(|vectors| vectors.checked_mul(8));
    if claimed != Some(data.len()) {
        return Err(wrong_length);
    }
    let (numbers, _) = data.as_chunks::<4>();
    let half = |first: usize| {
        let shifts = numbers.iter().skip(first).step_by(2).map(|number| {
            let shift = f32::from_le_bytes(*number);
            if shift.abs() <= LARGEST_SHIFT {
                shift
            } else {
                f32::NAN
            }
        });
        Array2::from_shape_vec(size.dim(), shifts.collect()).map_err(|_| wrong_length)
    };
    VectorPlanes::new(half(0)?, half(1)?).map_err(|_| wrong_length)
}

/// Reads a `.flo` file; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<VectorPlanes, Unreadable<NotFlo>> {
    file::read(path.as_ref(), decode)
}

/// The `.flo` file of a vector field; unknown vectors are written as 1e10 in both halves.
///
/// # Errors
/// [`BeyondFlo`] if a side is too long for the header.
pub fn encode(vectors: &VectorPlanes) -> Result<Vec<u8>, BeyondFlo> {
    let size = vectors.size();
    let (Ok(width), Ok(height)) = (i32::try_from(size.width), i32::try_from(size.height)) else {
        return Err(BeyondFlo::Extent(size));
    };
    let mut bytes = Vec::with_capacity(HEADER + 8 * size.area());
    bytes.extend(MAGIC.to_le_bytes());
    bytes.extend(width.to_le_bytes());
    bytes.extend(height.to_le_bytes());
    for (&dx, &dy) in vectors.dx().iter().zip(vectors.dy().iter()) {
        let known = dx.abs() <= LARGEST_SHIFT && dy.abs() <= LARGEST_SHIFT;
        let (dx, dy) = if known { (dx, dy) } else { (UNKNOWN, UNKNOWN) };
        bytes.extend(dx.to_le_bytes());
        bytes.extend(dy.to_le_bytes());
    }
    Ok(bytes)
}

/// Writes a `.flo` file, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(path: impl AsRef<Path>, vectors: &VectorPlanes) -> Result<(), Unwritable<BeyondFlo>> {
    file::write(path.as_ref(), encode(vectors))
}

/// The `.flo` file of a disparity field, `dx` and `dy` in the library's sign: unknown where the
/// field is not valid, or, if `dense`, the best guess everywhere.
///
/// # Errors
/// [`BeyondFlo`] if the field has no pixel or a side is too long for the header.
pub fn encode_disparity(field: &DisparityField, dense: bool) -> Result<Vec<u8>, BeyondFlo> {
    encode(&VectorPlanes::new(
        file_sign::said(field, field.dx(), dense),
        file_sign::said(field, field.dy(), dense),
    )?)
}

/// Writes a disparity field as a `.flo` file, whole or not at all; see [`encode_disparity`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write_disparity(
    path: impl AsRef<Path>,
    field: &DisparityField,
    dense: bool,
) -> Result<(), Unwritable<BeyondFlo>> {
    file::write(path.as_ref(), encode_disparity(field, dense))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(width: i32, height: i32, numbers: &[f32]) -> Vec<u8> {
        let mut bytes = b"PIEH".to_vec();
        bytes.extend(width.to_le_bytes());
        bytes.extend(height.to_le_bytes());
        bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        bytes
    }

    #[test]
    fn vectors_alternate_and_the_unknown_is_nan() {
        let vectors = decode(&file(3, 1, &[1.0, 2.0, 1e10, 0.0, 3.0, f32::NAN])).unwrap();
        assert_eq!(vectors.at(0, 0), Some((1.0, 2.0)));
        assert_eq!(vectors.at(1, 0), None);
        assert_eq!(vectors.at(2, 0), None);
        assert_eq!(vectors.at(3, 0), None);
    }

    #[test]
    fn refusals_say_what() {
        assert_eq!(decode(b"PIE").unwrap_err(), NotFlo::Magic);
        assert_eq!(decode(b"PIEHabc").unwrap_err(), NotFlo::Header(7));
        assert!(matches!(
            decode(&file(-1, 2, &[])),
            Err(NotFlo::Extent { width: -1, .. })
        ));
        let huge = decode(&file(i32::MAX, i32::MAX, &[0.0]));
        assert!(matches!(huge, Err(NotFlo::Length { bytes: 4, .. })));
    }
}
