//! Validity as an 8-bit grey PNG: white is an answer, each shade of grey a reason for none.
//!
//! | grey | validity |
//! |---|---|
//! | 255 | [`Validity::Valid`] |
//! | 200 | [`Validity::Inconsistent`] |
//! | 150 | [`Validity::Occluded`] |
//! | 100 | [`Validity::OutOfView`] |
//! | 50 | [`Validity::Incoherent`] |
//! | 25 | [`Validity::Singular`] |
//! | 0 | [`Validity::NoEnergy`] |

use std::path::Path;

use disparity_pyramid::Validity;
use ndarray::{Array2, ArrayView2};

use crate::file::{self, Unreadable, Unwritable};
use crate::raster::{self, NotAPicture, NotAPng};

/// Why bytes are not a picture of validities.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotValidity {
    /// The bytes are no grey picture.
    #[error(transparent)]
    Picture(#[from] NotAPicture),
    /// A grey value stands for no validity.
    #[error(
        "grey {grey} at x = {x}, y = {y} stands for no validity (0, 25, 50, 100, 150, 200, 255)"
    )]
    Grey {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
        /// The value there.
        grey: u16,
    },
}

/// The grey value that stands for a validity.
#[must_use]
pub const fn grey(validity: Validity) -> u8 {
    match validity {
        Validity::NoEnergy => 0,
        Validity::Singular => 25,
        Validity::Incoherent => 50,
        Validity::OutOfView => 100,
        Validity::Occluded => 150,
        Validity::Inconsistent => 200,
        Validity::Valid => 255,
    }
}

/// Decodes validities `[[y, x]]`.
///
/// # Errors
/// [`NotValidity`] if the bytes are no 8-bit grey PNG or a value stands for none.
pub fn decode(bytes: &[u8]) -> Result<Array2<Validity>, NotValidity> {
    let greys = raster::decode_codes(bytes)?.grey8()?;
    let mut validities = Array2::from_elem(greys.dim(), Validity::Valid);
    for (((y, x), &code), validity) in greys.indexed_iter().zip(&mut validities) {
        *validity = Validity::ALL
            .into_iter()
            .find(|&validity| u16::from(grey(validity)) == code)
            .ok_or(NotValidity::Grey { x, y, grey: code })?;
    }
    Ok(validities)
}

/// Reads validities; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<Array2<Validity>, Unreadable<NotValidity>> {
    file::read(path.as_ref(), decode)
}

/// The PNG of validities `[[y, x]]`.
///
/// # Errors
/// [`NotAPng`] if the plane has no pixel.
pub fn encode(validity: ArrayView2<'_, Validity>) -> Result<Vec<u8>, NotAPng> {
    raster::encode_grey8(validity.mapv(grey).view())
}

/// Writes validities, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write(
    path: impl AsRef<Path>,
    validity: ArrayView2<'_, Validity>,
) -> Result<(), Unwritable<NotAPng>> {
    file::write(path.as_ref(), encode(validity))
}
