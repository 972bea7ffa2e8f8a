//! Portable float maps: one 32-bit float a pixel, rows from the bottom up, `+inf` unknown.

use std::path::Path;

use disparity_pyramid::DisparityField;
use ndarray::{Array2, ArrayView2, Axis};
use v1_gabor::Size;

use crate::file::{self, Unreadable, Unwritable};
use crate::file_sign;

/// Why bytes are not a float map.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotPfm {
    /// The file does not begin with `Pf`.
    #[error("it does not begin with 'Pf'; a PFM file of one channel is needed")]
    Magic,
    /// The file begins with `PF`: three channels.
    #[error(
        "it begins with 'PF', a colour float map, and a disparity or a depth has one channel; \
         save it as 'Pf'"
    )]
    Colour,
    /// The header ends early, or one of its numbers is none.
    #[error("the header gives no {what} at byte {byte}; it reads 'Pf', width, height, scale")]
    Header {
        /// Which number is missing.
        what: &'static str,
        /// Where it is missed.
        byte: usize,
    },
    /// The header claims no pixel.
    #[error("the header claims {0} pixels, and a map has at least one")]
    Empty(Size),
    /// The bytes behind the header are not as many as it claims.
    #[error(
        "the header claims {size} pixels, 4 bytes each, and {bytes} bytes follow it; \
         the file is cut short or damaged"
    )]
    Length {
        /// What the header claims.
        size: Size,
        /// What follows it.
        bytes: usize,
    },
}

/// Decodes a float map to a plane `[[y, x]]`, top row first; whatever is infinite is unknown and
/// comes back as NaN.
///
/// Only the sign of the header's scale counts (the order of the bytes): publishers write a factor
/// for viewers there, which does not apply to the numbers.
///
/// # Errors
/// [`NotPfm`] says what is wrong and where.
pub fn decode(bytes: &[u8]) -> Result<Array2<f32>, NotPfm> {
    match bytes {
        [b'P', b'f', ..] => {}
        [b'P', b'F', ..] => return Err(NotPfm::Colour),
        _ => return Err(NotPfm::Magic),
    }
    let mut header = Header { bytes, byte: 2 };
    let size = Size {
        width: header.number("width")?,
        height: header.number("height")?,
    };
    let scale: f32 = header.number("scale")?;
    if scale == 0.0 || !scale.is_finite() {
        return Err(header.lacks("scale other than 0"));
    }
    let data = header.data()?;

    let claimed = size
        .width
        .checked_mul(size.height)
        .and_then(|pixels| pixels.checked_mul(4));
    match claimed {
        Some(0) => return Err(NotPfm::Empty(size)),
        Some(claimed) if claimed == data.len() => {}
        _ => {
            return Err(NotPfm::Length {
                size,
                bytes: data.len(),
            });
        }
    }
    let number = if scale < 0.0 {
        f32::from_le_bytes
    } else {
        f32::from_be_bytes
    };
    let (samples, _) = data.as_chunks::<4>();
    let values = samples.iter().map(|sample| {
        let value = number(*sample);
        if value.is_finite() { value } else { f32::NAN }
    });
    let mut plane =
        Array2::from_shape_vec(size.dim(), values.collect()).map_err(|_| NotPfm::Length {
            size,
            bytes: data.len(),
        })?;
    plane.invert_axis(Axis(0));
    Ok(plane.as_standard_layout().into_owned())
}

/// The numbers of a header, separated by white space.
struct Header<'a> {
    bytes: &'a [u8],
    byte: usize,
}

impl<'a> Header<'a> {
    /// No honest number of a header is longer.
    const LONGEST_NUMBER: usize = 32;

    fn number<N: std::str::FromStr>(&mut self, what: &'static str) -> Result<N, NotPfm> {
        let rest = &self.bytes[self.byte..];
        let gap = rest.iter().take_while(|b| b.is_ascii_whitespace()).count();
        let word = rest[gap..]
            .iter()
            .take(Self::LONGEST_NUMBER)
            .take_while(|b| !b.is_ascii_whitespace())
            .count();
        let number = std::str::from_utf8(&rest[gap..gap + word])
            .ok()
            .filter(|_| gap > 0)
            .and_then(|word| word.parse().ok())
            .ok_or_else(|| self.lacks(what))?;
        self.byte += gap + word;
        Ok(number)
    }

    /// What follows the header: one white space ends it, or a whole line end of two bytes.
    fn data(&self) -> Result<&'a [u8], NotPfm> {
        match &self.bytes[self.byte..] {
            [b'\r', b'\n', data @ ..] => Ok(data),
            [end, data @ ..] if end.is_ascii_whitespace() => Ok(data),
            _ => Err(self.lacks("end of line")),
        }
    }

    const fn lacks(&self, what: &'static str) -> NotPfm {
        NotPfm::Header {
            what,
            byte: self.byte,
        }
    }
}

/// Reads a float map; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<Array2<f32>, Unreadable<NotPfm>> {
    file::read(path.as_ref(), decode)
}

/// The little-endian float map of a plane `[[y, x]]`; whatever is not finite is unknown and
/// written as `+inf`.
///
/// # Errors
/// [`NotAMap`] if the plane has no pixel.
pub fn encode(plane: ArrayView2<'_, f32>) -> Result<Vec<u8>, NotAMap> {
    let size = Size::of_dim(plane.dim());
    if plane.is_empty() {
        return Err(NotAMap(size));
    }
    let mut bytes = format!("Pf\n{} {}\n-1.0\n", size.width, size.height).into_bytes();
    bytes.reserve_exact(4 * plane.len());
    for row in plane.rows().into_iter().rev() {
        for &value in row {
            let value = if value.is_finite() {
                value
            } else {
                f32::INFINITY
            };
            bytes.extend(value.to_le_bytes());
        }
    }
    Ok(bytes)
}

/// A plane without pixels has no float map.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a plane of {0} pixels cannot be a PFM file")]
pub struct NotAMap(pub Size);

/// Writes a float map, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(
    path: impl AsRef<Path>,
    plane: ArrayView2<'_, f32>,
) -> Result<(), Unwritable<NotAMap>> {
    file::write(path.as_ref(), encode(plane))
}

/// The float map of a field's horizontal disparity in the sign of files, `d = -dx`: unknown where
/// the field is not valid, or, if `dense`, the best guess everywhere.
///
/// # Errors
/// [`NotAMap`] if the field has no pixel.
pub fn encode_disparity(field: &DisparityField, dense: bool) -> Result<Vec<u8>, NotAMap> {
    encode(file_sign::d_of_field(field, dense).view())
}

/// Writes the horizontal disparity of a field, whole or not at all; see [`encode_disparity`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write_disparity(
    path: impl AsRef<Path>,
    field: &DisparityField,
    dense: bool,
) -> Result<(), Unwritable<NotAMap>> {
    file::write(path.as_ref(), encode_disparity(field, dense))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_run_upwards_and_both_byte_orders_are_read() {
        let mut little = b"Pf\n2 2\n-1.0\n".to_vec();
        let mut big = b"Pf 2\t2\r\n0.5\r\n".to_vec();
        for value in [3.0f32, f32::INFINITY, 1.0, f32::NEG_INFINITY] {
            little.extend(value.to_le_bytes());
            big.extend(value.to_be_bytes());
        }
        for bytes in [little, big] {
            let plane = decode(&bytes).unwrap();
            assert_eq!((plane[[0, 0]], plane[[1, 0]]), (1.0, 3.0));
            assert!(plane[[0, 1]].is_nan() && plane[[1, 1]].is_nan());
            assert!(plane.is_standard_layout());
        }
    }

    #[test]
    fn refusals_say_what_and_where() {
        assert_eq!(decode(b"PF\n1 1\n-1\n"), Err(NotPfm::Colour));
        assert_eq!(decode(b"P5\n1 1\n255\n0"), Err(NotPfm::Magic));
        let header = |what, byte| Err(NotPfm::Header { what, byte });
        assert_eq!(decode(b"Pf"), header("width", 2));
        assert_eq!(decode(b"Pf\n7 -1 1\n"), header("height", 4));
        assert_eq!(decode(b"Pf\n7 1 0\n"), header("scale other than 0", 8));
        assert_eq!(decode(b"Pf\n7 1 1"), header("end of line", 8));
        let huge = b"Pf\n18446744073709551615 18446744073709551615\n-1\n";
        assert!(matches!(decode(huge), Err(NotPfm::Length { bytes: 0, .. })));
        let long = b"Pf\n1 1\n-1\n12345";
        assert!(matches!(decode(long), Err(NotPfm::Length { bytes: 5, .. })));
    }
}
