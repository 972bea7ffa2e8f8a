//! Depth as RGB-D cameras store it: a 16-bit grey PNG in millimetres, 0 unknown.

use std::path::Path;

use egocentric_depth::DepthMap;
use ndarray::Array2;

use crate::file::{self, Unreadable, Unwritable};
use crate::raster::{self, NotAPicture, NotAPng};

/// Why a depth map does not go into a 16-bit PNG.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BeyondMillimetres {
    /// The map is no picture.
    #[error(transparent)]
    Plane(#[from] NotAPng),
    /// A depth has no code.
    #[error(
        "a depth of {metres} m at x = {x}, y = {y} has no code: the PNG holds 0.001 to 65.535 m; \
         make it unknown or write a PFM file"
    )]
    Depth {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// The depth there, in metres.
        metres: f32,
    },
}

/// Decodes a depth map.
///
/// # Errors
/// [`NotAPicture`] if the bytes are no 16-bit grey PNG.
pub fn decode(bytes: &[u8]) -> Result<DepthMap, NotAPicture> {
    let millimetres = raster::decode_codes(bytes)?.grey16()?;
    // A depth of zero is none: the map itself makes it unknown.
    Ok(DepthMap::new(
        millimetres.mapv(|millimetres| f32::from(millimetres) / 1000.0),
    ))
}

/// Reads a depth map; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<DepthMap, Unreadable<NotAPicture>> {
    file::read(path.as_ref(), decode)
}

/// The PNG of a depth map, each depth rounded to the nearest millimetre.
///
/// # Errors
/// [`BeyondMillimetres`] names the first depth that has no code; none is bent to fit.
pub fn encode(depth: &DepthMap) -> Result<Vec<u8>, BeyondMillimetres> {
    let mut codes = Array2::zeros(depth.size().dim());
    for (((y, x), &metres), code) in depth.metres().indexed_iter().zip(&mut codes) {
        if metres.is_finite() {
            let nearest = (metres * 1000.0).round();
            if !(1.0..=65535.0).contains(&nearest) {
                return Err(BeyondMillimetres::Depth { x, y, metres });
            }
            *code = nearest as u16;
        }
    }
    Ok(raster::encode_grey16(codes.view())?)
}

/// Writes a depth map, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(
    path: impl AsRef<Path>,
    depth: &DepthMap,
) -> Result<(), Unwritable<BeyondMillimetres>> {
    file::write(path.as_ref(), encode(depth))
}
