//! Pictures: what the eyes see, from PNG, PNM, JPEG or TIFF, and colour pictures to PNG.

use std::path::{Path, PathBuf};

use image::codecs::png::CompressionType;
use ndarray::{Array2, ArrayView2, Zip};
use v1_gabor::{Binocular, LumaImage, NotAnImage, Size};

use crate::code_luma::luma_of_codes;
use crate::file::{self, Unreadable, Unwritable};
use crate::raster::{self, NotAPicture, NotAPng};

pub use crate::raster::Samples;

/// A picture: its luma for the responses, its colours for guides and clouds.
#[derive(Clone, Debug)]
pub struct Picture {
    luma: LumaImage,
    rgb: Array2<[u8; 3]>,
}

impl Picture {
    /// A picture of the samples that a camera delivers, grey or colour.
    ///
    /// # Errors
    /// [`NotAnImage`] if there is no pixel.
    pub fn of_samples(samples: Samples) -> Result<Self, NotAnImage> {
        let (luma, rgb) = match samples {
            Samples::Grey8(grey) => (
                grey.mapv(|grey| f32::from(grey) / 255.0),
                grey.mapv(|grey| [grey; 3]),
            ),
            Samples::Grey16(grey) => (
                grey.mapv(|grey| f32::from(grey) / 65535.0),
                grey.mapv(|grey| [eight_bits(grey); 3]),
            ),
            Samples::Rgb8(rgb) => (luma_of_codes(rgb.view()), rgb),
            Samples::Rgb16(rgb) => (
                rgb.mapv(|rgb| rec_601(rgb, 65535.0)),
                rgb.mapv(|rgb| rgb.map(eight_bits)),
            ),
        };
        let luma = LumaImage::new(luma)?;
        Ok(Self { luma, rgb })
    }

    /// Width and height in pixels.
    #[must_use]
    pub fn size(&self) -> Size {
        self.luma.size()
    }

    /// The luma, from 0 (black) to 1 (white).
    #[must_use]
    pub const fn luma(&self) -> &LumaImage {
        &self.luma
    }

    /// The luma, given away.
    #[must_use]
    pub fn into_luma(self) -> LumaImage {
        self.luma
    }

    /// Red, green and blue `[[y, x]]`, from 0 to 255; grey pictures have three equal ones.
    #[must_use]
    pub fn rgb(&self) -> ArrayView2<'_, [u8; 3]> {
        self.rgb.view()
    }
}

/// Why two files are not the two eyes of one look.
#[derive(Debug, thiserror::Error)]
pub enum NotAPair {
    /// One of the pictures is not read.
    #[error(transparent)]
    Picture(#[from] Unreadable<NotAPicture>),
    /// The pictures differ in size.
    #[error(
        "{} has {left} pixels and {} has {right}; the two eyes need pictures of one size",
        paths.left.display(), paths.right.display()
    )]
    Sizes {
        /// The two files.
        paths: Binocular<PathBuf>,
        /// Size of the left picture.
        left: Size,
        /// Size of the right picture.
        right: Size,
    },
}

/// Decodes a PNG, PNM, JPEG or TIFF picture with 8-bit or 16-bit samples, grey or colour.
///
/// # Errors
/// [`NotAPicture`] says what is wrong; no header is believed with memory that the length of the
/// file does not bear out.
pub fn decode(bytes: &[u8]) -> Result<Picture, NotAPicture> {
    let not = |not: NotAnImage| NotAPicture::Broken(not.to_string());
    Picture::of_samples(raster::decode(bytes)?).map_err(not)
}

/// Reads a picture file; see [`decode`].
///
/// # Errors
/// [`Unreadable`] names the file and what is wrong with it.
pub fn read(path: impl AsRef<Path>) -> Result<Picture, Unreadable<NotAPicture>> {
    file::read(path.as_ref(), decode)
}

/// Reads the pictures of both eyes.
///
/// # Errors
/// [`NotAPair`] if one is not read or the sizes differ.
pub fn read_pair(paths: Binocular<&Path>) -> Result<Binocular<Picture>, NotAPair> {
    let eyes = paths.try_map(read)?;
    let (left, right) = (eyes.left.size(), eyes.right.size());
    if left == right {
        Ok(eyes)
    } else {
        Err(NotAPair::Sizes {
            paths: paths.map(Path::to_owned),
            left,
            right,
        })
    }
}

/// Reads what both eyes see in grey: [`read_pair`] without the colours.
///
/// # Errors
/// [`NotAPair`] if one is not read or the sizes differ.
pub fn read_luma_pair(paths: Binocular<&Path>) -> Result<Binocular<LumaImage>, NotAPair> {
    Ok(read_pair(paths)?.map(Picture::into_luma))
}

/// The bytes of a colour PNG from red, green and blue `[[y, x]]`.
///
/// # Errors
/// [`NotAPng`] if the plane has no pixel.
pub fn encode_rgb(rgb: ArrayView2<'_, [u8; 3]>) -> Result<Vec<u8>, NotAPng> {
    raster::encode_rgb8(rgb, CompressionType::Fast)
}

/// The same in few bytes: for pictures that are kept, as it takes many times as long.
///
/// # Errors
/// [`NotAPng`] if the plane has no pixel.
pub fn encode_rgb_small(rgb: ArrayView2<'_, [u8; 3]>) -> Result<Vec<u8>, NotAPng> {
    raster::encode_rgb8(rgb, CompressionType::Best)
}

/// The bytes of a small colour JPEG to look at, never to measure in: at most `most_width` pixels wide,
/// each the mean of the pixels it stands for.
///
/// # Errors
/// [`NotAPng`] if the plane has no pixel, or more than 65535 along a side.
pub fn encode_preview(rgb: ArrayView2<'_, [u8; 3]>, most_width: usize) -> Result<Vec<u8>, NotAPng> {
    // Noise is what a picture's bytes go for; at this quality it is gone and edges are not.
    const QUALITY: u8 = 72;
    let (height, width) = rgb.dim();
    let step = width.div_ceil(most_width.max(1)).max(1);
    if step == 1 {
        return raster::encode_jpeg(rgb, QUALITY);
    }
    let small = Array2::from_shape_fn((height.div_ceil(step), width.div_ceil(step)), |(y, x)| {
        let (y, x) = (y * step, x * step);
        let block = rgb.slice(ndarray::s![y..height.min(y + step), x..width.min(x + step)]);
        let count = block.len() as u32;
        [0, 1, 2].map(|c| {
            let sum: u32 = block.iter().map(|pixel| u32::from(pixel[c])).sum();
            ((sum + count / 2) / count) as u8
        })
    });
    raster::encode_jpeg(small.view(), QUALITY)
}

/// Writes a colour PNG, whole or not at all; see [`encode_rgb`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write_rgb(
    path: impl AsRef<Path>,
    rgb: ArrayView2<'_, [u8; 3]>,
) -> Result<(), Unwritable<NotAPng>> {
    file::write(path.as_ref(), encode_rgb(rgb))
}

/// The bytes of a 16-bit grey PNG of a luma image: 0 black, 1 white, what lies outside clipped.
///
/// # Errors
/// [`NotAPng`] if a side is longer than a PNG holds.
pub fn encode_luma(luma: &LumaImage) -> Result<Vec<u8>, NotAPng> {
    let codes = Zip::from(luma.plane()).map_collect(|&luma| (luma * 65535.0).round() as u16);
    raster::encode_grey16(codes.view())
}

/// Writes a luma image as a 16-bit grey PNG, whole or not at all; see [`encode_luma`].
///
/// # Errors
/// [`Unwritable`] names the file and what stood in the way.
pub fn write_luma(path: impl AsRef<Path>, luma: &LumaImage) -> Result<(), Unwritable<NotAPng>> {
    file::write(path.as_ref(), encode_luma(luma))
}

/// Luma by the weights of ITU-R BT.601, from the samples as stored (gamma and all), as the
/// literature on stereo does.
///
/// The sum is taken in `f64`, in which white is 1 and not a rounding error above it.
pub(crate) fn rec_601<T: Into<f64>>(rgb: [T; 3], white: f64) -> f32 {
    let [red, green, blue] = rgb.map(Into::into);
    ((0.299 * red + 0.587 * green + 0.114 * blue) / white) as f32
}

/// The nearest 8-bit sample: 65535 = 255 * 257.
const fn eight_bits(sample: u16) -> u8 {
    ((sample as u32 + 128) / 257) as u8
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn sixteen_bits_keep_their_scale() {
        let bytes = raster::encode_grey16(ndarray::array![[0, 1, 32768, 65535]].view()).unwrap();
        let picture = decode(&bytes).unwrap();
        let want = ndarray::array![[0.0, 1.0 / 65535.0, 32768.0 / 65535.0, 1.0]];
        assert_eq!(picture.luma().plane(), want);
        assert_eq!(
            picture.rgb(),
            ndarray::array![[[0; 3], [0; 3], [128; 3], [255; 3]]]
        );
    }

    #[test]
    fn pnm_is_read_at_its_own_white() {
        let picture = decode(b"P2\n# a comment\n3 1\n15\n0 5 15\n").unwrap();
        assert_eq!(
            picture.luma().plane(),
            ndarray::array![[0.0, 85.0 / 255.0, 1.0]]
        );
        let colour = decode(b"P6 1 1 255\n\xff\x00\x00").unwrap();
        assert_eq!(colour.luma().plane(), ndarray::array![[0.299]]);
        assert_eq!(colour.rgb()[[0, 0]], [255, 0, 0]);
    }

    #[test]
    fn eyes_of_two_sizes_are_refused_with_both() {
        let folder = tempfile::tempdir().unwrap();
        let paths = Binocular {
            left: folder.path().join("left.png"),
            right: folder.path().join("right.png"),
        };
        write_rgb(&paths.left, Array2::from_elem((3, 4), [1, 2, 3]).view()).unwrap();
        write_rgb(&paths.right, Array2::from_elem((3, 5), [1, 2, 3]).view()).unwrap();
        let refused = read_pair(paths.as_ref().map(PathBuf::as_path))
            .unwrap_err()
            .to_string();
        for part in ["left.png", "right.png", "4 x 3", "5 x 3"] {
            assert!(refused.contains(part), "{refused}");
        }
        let left = Binocular {
            left: paths.left.as_path(),
            right: paths.left.as_path(),
        };
        assert_eq!(
            read_luma_pair(left).unwrap().right.size(),
            Size {
                width: 4,
                height: 3
            }
        );
    }

    proptest! {
        /// Grey in colour is the same grey: the weights sum to one, to the last bit but one of f32.
        #[test]
        fn grey_in_colour_is_grey(grey: u8) {
            prop_assert!((rec_601([grey; 3], 255.0) - f32::from(grey) / 255.0).abs() < 1e-7);
            prop_assert!(rec_601([grey; 3], 255.0) <= 1.0);
            prop_assert_eq!(eight_bits(u16::from(grey) * 257), grey);
        }

        /// Colours come back as written.
        #[test]
        fn colours_come_back(width in 1usize..9, height in 1usize..9, seed: u8) {
            let rgb = Array2::from_shape_fn((height, width), |(y, x)| {
                [seed.wrapping_mul(x as u8), seed.wrapping_add(y as u8), seed]
            });
            let back = decode(&encode_rgb(rgb.view()).unwrap()).unwrap();
            prop_assert_eq!(back.rgb(), rgb);
        }

        /// Luma comes back to half a step of 16 bits.
        #[test]
        fn luma_comes_back(luma in 0.0f32..=1.0) {
            let image = LumaImage::new(ndarray::array![[luma]]).unwrap();
            let back = decode(&encode_luma(&image).unwrap()).unwrap();
            // Half a step, and one rounding of f32.
            prop_assert!((back.luma().plane()[[0, 0]] - luma).abs() <= 0.5 / 65535.0 + 1e-7);
        }
    }
}
