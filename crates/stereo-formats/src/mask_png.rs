//! Masks: an 8-bit grey PNG, 255 where a pixel counts and 0 where it does not.

use std::path::Path;

use ndarray::{Array2, ArrayView2};

use crate::file::{self, Unreadable, Unwritable};
use crate::raster::{self, NotAPicture, NotAPng};

/// Why bytes are not a mask.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotAMask {
    /// The bytes are no grey picture.
    #[error(transparent)]
    Picture(#[from] NotAPicture),
    /// A grey value between yes and no.
    #[error("grey {grey} at x = {x}, y = {y} is neither 255 (counts) nor 0 (does not)")]
    Grey {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// The value there.
        grey: u16,
    },
}

/// Decodes a mask `[[y, x]]`: `true` where the pixel counts.
///
/// # Errors
/// [`NotAMask`] if the bytes are no grey PNG of 8 bits (or 1) or a value is neither yes nor no.
pub fn decode(bytes: &[u8]) -> Result<Array2<bool>, NotAMask> {
    let codes = raster::decode_codes(bytes)?;
    let yes = if codes.bits == 1 { 1 } else { 255 };
    let greys = codes.grey8()?;
    let mut mask = Array2::from_elem(greys.dim(), false);
    for (((y, x), &grey), counts) in greys.indexed_iter().zip(&mut mask) {
        *counts = match grey {
            0 => false,
            grey if grey == yes => true,
            grey => return Err(NotAMask::Grey { x, y, grey }),
        };
    }
    Ok(mask)
}

/// Reads a mask; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<Array2<bool>, Unreadable<NotAMask>> {
    file::read(path.as_ref(), decode)
}

/// The PNG of a mask `[[y, x]]`.
///
/// # Errors
/// [`NotAPng`] if the mask has no pixel.
pub fn encode(mask: ArrayView2<'_, bool>) -> Result<Vec<u8>, NotAPng> {
    raster::encode_grey8(mask.mapv(|counts| if counts { 255 } else { 0 }).view())
}

/// Writes a mask, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(
    path: impl AsRef<Path>,
    mask: ArrayView2<'_, bool>,
) -> Result<(), Unwritable<NotAPng>> {
    file::write(path.as_ref(), encode(mask))
}
