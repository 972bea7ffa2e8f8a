//! Label images: a grey or indexed PNG whose sample is the label, 0 for no object.

use std::path::Path;

use egocentric_depth::LabelImage;

use crate::file::{self, Unreadable, Unwritable};
use crate::raster::{self, NotAPicture, NotAPng};

/// Decodes a label image from a grey PNG of up to 16 bits or an indexed one, whose indices are
/// the labels.
///
/// # Errors
/// [`NotAPicture`] if the bytes are no such PNG.
pub fn decode(bytes: &[u8]) -> Result<LabelImage, NotAPicture> {
    Ok(LabelImage::new(raster::decode_codes(bytes)?.plane))
}

/// Reads a label image; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<LabelImage, Unreadable<NotAPicture>> {
    file::read(path.as_ref(), decode)
}

/// The grey PNG of a label image: 8-bit if every label fits, else 16-bit.
///
/// # Errors
/// [`NotAPng`] if the image has no pixel.
pub fn encode(labels: &LabelImage) -> Result<Vec<u8>, NotAPng> {
    let plane = labels.plane();
    if plane.iter().all(|&label| label <= 255) {
        raster::encode_grey8(plane.mapv(|label| label as u8).view())
    } else {
        raster::encode_grey16(plane)
    }
}

/// Writes a label image, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(path: impl AsRef<Path>, labels: &LabelImage) -> Result<(), Unwritable<NotAPng>> {
    file::write(path.as_ref(), encode(labels))
}
