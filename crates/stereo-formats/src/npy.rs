//! NumPy arrays: `.npy` files of any shape, read by `numpy.load`.
//!
//! Written as version 1.0 of the format: little-endian, row-major, the first axis slowest.

use std::path::Path;

use ndarray::{ArrayD, ArrayView, Dimension, IxDyn};
use num_complex::Complex32;

use crate::file::{self, Unreadable, Unwritable};

const MAGIC: &[u8] = b"\x93NUMPY";
/// NumPy aligns the data to this many bytes, for those who map files into memory.
const ALIGNMENT: usize = 64;
/// No honest array has more axes; NumPy itself stops there.
const MOST_AXES: usize = 32;

/// A number that a `.npy` file holds.
///
/// Implemented for `f32` (`<f4`, NumPy's `float32`), [`Complex32`] (`<c8`, `complex64`) and `bool`
/// (`|b1`, `bool`).
pub trait Sample: Copy {
    /// What the header calls the type.
    const DESCR: &'static str;
    /// Bytes of one sample.
    const BYTES: usize;
    /// Adds the bytes of this sample.
    fn put(self, bytes: &mut Vec<u8>);
    /// The sample of these [`BYTES`](Self::BYTES) bytes; `None` if they are none.
    fn get(bytes: &[u8]) -> Option<Self>;
}

impl Sample for f32 {
    const DESCR: &'static str = "<f4";
    const BYTES: usize = 4;

    fn put(self, bytes: &mut Vec<u8>) {
        bytes.extend(self.to_le_bytes());
    }

    fn get(bytes: &[u8]) -> Option<Self> {
        Some(Self::from_le_bytes(bytes.try_into().ok()?))
    }
}

impl Sample for Complex32 {
    const DESCR: &'static str = "<c8";
    const BYTES: usize = 8;

    fn put(self, bytes: &mut Vec<u8>) {
        self.re.put(bytes);
        self.im.put(bytes);
    }

    fn get(bytes: &[u8]) -> Option<Self> {
        let (re, im) = bytes.split_at_checked(4)?;
        Some(Self::new(f32::get(re)?, f32::get(im)?))
    }
}

impl Sample for bool {
    const DESCR: &'static str = "|b1";
    const BYTES: usize = 1;

    fn put(self, bytes: &mut Vec<u8>) {
        bytes.push(u8::from(self));
    }

    fn get(bytes: &[u8]) -> Option<Self> {
        match bytes {
            [0] => Some(false),
            [1] => Some(true),
            _ => None,
        }
    }
}

/// Why bytes are not an array of the wanted type.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotNpy {
    /// The file does not begin with `\x93NUMPY`.
    #[error("it does not begin with '\\x93NUMPY'; a .npy file of numpy.save is needed")]
    Magic,
    /// A version of the format that is not read.
    #[error("it is version {0} of the format, and versions 1 to 3 are read")]
    Version(u8),
    /// The header ends early, or does not say what it must.
    #[error("the header gives no {0}; it reads {{'descr': .., 'fortran_order': .., 'shape': ..}}")]
    Header(&'static str),
    /// The array is of another type.
    #[error("it holds {found}, and {wanted} is needed; see numpy.ndarray.astype")]
    Type {
        /// What the header says.
        found: String,
        /// What the header would have to say.
        wanted: &'static str,
    },
    /// The first axis is the fastest one.
    #[error("it is in Fortran order; save numpy.ascontiguousarray of it")]
    Fortran,
    /// The bytes behind the header are not as many as it claims.
    #[error(
        "the header claims the shape {shape:?}, and {bytes} bytes follow it; \
         the file is cut short or damaged"
    )]
    Length {
        /// What the header claims.
        shape: Vec<usize>,
        /// What follows it.
        bytes: usize,
    },
    /// A truth value is neither 0 nor 1.
    #[error("sample {0} is none of its type")]
    Sample(usize),
}

/// The bytes of an array of any shape, an empty one too.
#[must_use]
pub fn encode<T: Sample, D: Dimension>(array: ArrayView<'_, T, D>) -> Vec<u8> {
    let axes: Vec<String> = array.shape().iter().map(usize::to_string).collect();
    // A tuple of one needs its comma.
    let shape = match &axes[..] {
        [one] => format!("({one},)"),
        axes => format!("({})", axes.join(", ")),
    };
    let mut header = format!(
        "{{'descr': '{}', 'fortran_order': False, 'shape': {shape}, }}",
        T::DESCR
    );
    // Magic, version, length of the header, and the line end that closes it.
    let before = MAGIC.len() + 4;
    let padding = (before + header.len() + 1).next_multiple_of(ALIGNMENT) - before - 1;
    header = format!("{header:padding$}\n");

    let mut bytes = Vec::with_capacity(before + header.len() + T::BYTES * array.len());
    bytes.extend(MAGIC);
    bytes.extend([1, 0]);
    // Thirty-two axes of twenty digits are far below 65536.
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    for &sample in &array {
        sample.put(&mut bytes);
    }
    bytes
}

/// Decodes an array of a known type and any shape.
///
/// # Errors
/// [`NotNpy`] says what is wrong; no header is believed with memory that the file's length does not
/// bear out.
pub fn decode<T: Sample>(bytes: &[u8]) -> Result<ArrayD<T>, NotNpy> {
    let rest = bytes.strip_prefix(MAGIC).ok_or(NotNpy::Magic)?;
    let (length, rest) = match rest {
        [1, _, a, b, rest @ ..] => (usize::from(u16::from_le_bytes([*a, *b])), rest),
        [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
        [1..=3, ..] => return Err(NotNpy::Header("length")),
        [version, ..] => return Err(NotNpy::Version(*version)),
        [] => return Err(NotNpy::Header("version")),
    };
    let (header, data) = rest
        .split_at_checked(length)
        .ok_or(NotNpy::Header("end within the file"))?;
    let header = std::str::from_utf8(header).map_err(|_| NotNpy::Header("text"))?;

    let descr = entry(header, "descr").and_then(quoted);
    let descr = descr.ok_or(NotNpy::Header("descr"))?;
    if descr != T::DESCR {
        return Err(NotNpy::Type {
            found: descr.to_owned(),
            wanted: T::DESCR,
        });
    }
    let order = entry(header, "fortran_order").ok_or(NotNpy::Header("fortran_order"))?;
    if !order.starts_with("False") {
        return Err(NotNpy::Fortran);
    }
    let shape = entry(header, "shape")
        .and_then(tuple)
        .ok_or(NotNpy::Header("shape"))?;

    let claimed = shape
        .iter()
        .try_fold(T::BYTES, |bytes, &axis| bytes.checked_mul(axis));
    let samples = data.chunks_exact(T::BYTES).enumerate();
    let not = || NotNpy::Length {
        shape: shape.clone(),
        bytes: data.len(),
    };
    if claimed != Some(data.len()) {
        return Err(not());
    }
    let samples: Vec<T> = samples
        .map(|(place, bytes)| T::get(bytes).ok_or(NotNpy::Sample(place)))
        .collect::<Result<_, _>>()?;
    ArrayD::from_shape_vec(IxDyn(&shape), samples).map_err(|_| not())
}

/// What stands behind a key of the header's dictionary.
fn entry<'a>(header: &'a str, key: &str) -> Option<&'a str> {
    let (_, behind) = header.split_once(&format!("'{key}'"))?;
    Some(behind.trim_start().strip_prefix(':')?.trim_start())
}

fn quoted(text: &str) -> Option<&str> {
    let (word, _) = text.strip_prefix('\'')?.split_once('\'')?;
    Some(word)
}

fn tuple(text: &str) -> Option<Vec<usize>> {
    let (inside, _) = text.strip_prefix('(')?.split_once(')')?;
    let axes = inside.split(',').map(str::trim);
    let axes: Vec<usize> = axes
        .filter(|axis| !axis.is_empty())
        .map(|axis| axis.parse().ok())
        .take(MOST_AXES + 1)
        .collect::<Option<_>>()?;
    (axes.len() <= MOST_AXES).then_some(axes)
}

/// Reads an array; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read<T: Sample>(path: impl AsRef<Path>) -> Result<ArrayD<T>, Unreadable<NotNpy>> {
    file::read(path.as_ref(), decode)
}

/// Writes an array, whole or not at all; see [`encode`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write<T: Sample, D: Dimension>(
    path: impl AsRef<Path>,
    array: ArrayView<'_, T, D>,
) -> Result<(), Unwritable<std::convert::Infallible>> {
    file::write(path.as_ref(), Ok(encode(array)))
}

#[cfg(test)]
mod tests {
    use ndarray::{Array1, array};

    use super::*;

    /// The bytes that `numpy.save` of NumPy 2 writes for `np.array([[1, 2, 3]], dtype='<f4')`.
    #[test]
    fn the_bytes_are_numpys() {
        let mut want = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
        want.extend(b"{'descr': '<f4', 'fortran_order': False, 'shape': (1, 3), }");
        want.resize(127, b' ');
        want.push(b'\n');
        want.extend([0, 0, 128, 63, 0, 0, 0, 64, 0, 0, 64, 64]);
        assert_eq!(encode(array![[1.0f32, 2.0, 3.0]].view()), want);
    }

    #[test]
    fn refusals_say_what() {
        let good = encode(Array1::from_elem(3, 1.0f32).view());
        assert_eq!(decode::<f32>(b"PIEH"), Err(NotNpy::Magic));
        assert!(matches!(decode::<bool>(&good), Err(NotNpy::Type { .. })));
        let short = decode::<f32>(&good[..good.len() - 1]).unwrap_err();
        assert!(short.to_string().contains("11 bytes follow"), "{short}");
        let odd = encode(array![true].view());
        let odd = [&odd[..odd.len() - 1], &[2]].concat();
        assert_eq!(decode::<bool>(&odd), Err(NotNpy::Sample(0)));
        let text = String::from_utf8_lossy(&good[10..128]).into_owned();
        let told = |text: String| {
            let mut bytes = good[..10].to_vec();
            bytes.extend(text.as_bytes());
            bytes.extend(&good[128..]);
            decode::<f32>(&bytes)
        };
        assert_eq!(told(text.replace("False", "True ")), Err(NotNpy::Fortran));
        assert_eq!(
            told(text.replace("shape", "shade")),
            Err(NotNpy::Header("shape"))
        );
        let mut new = good.clone();
        new[6] = 9;
        assert_eq!(decode::<f32>(&new), Err(NotNpy::Version(9)));
    }
}
