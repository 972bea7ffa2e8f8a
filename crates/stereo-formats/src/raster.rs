//! The one door to the image codecs: bytes to samples, and planes to PNG bytes.

use std::io::Cursor;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{
    ColorType, DynamicImage, ExtendedColorType, ImageDecoder as _, ImageEncoder as _, ImageFormat,
    ImageReader, Limits,
};
use ndarray::{Array2, ArrayView2};
use v1_gabor::Size;

use crate::tiff_directory;

/// The most pixels a picture may have: 2^26, as of 8192 x 8192.
///
/// A picture of this size takes a quarter of a gigabyte as one plane of 32-bit floats.
pub const MOST_PIXELS: usize = 1 << 26;

/// The most pixels that one byte of an honest file stands for.
///
/// Deflate packs at most 1032 bytes into one, and a byte holds at most 8 pixels; JPEG spends at
/// least a bit on 64 pixels. A header that claims more lies, and is not believed with memory.
const MOST_PIXELS_PER_BYTE: usize = 8 * 1032;

/// What decoders may allocate beside the picture itself: tables, colour profiles, strips.
const SPARE_BYTES: u64 = 4 << 20;

/// Why bytes are not the picture they should be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotAPicture {
    /// The first bytes belong to no format known here.
    #[error("its first bytes are those of no picture read here; save it as {0}")]
    Format(&'static str),
    /// The header claims no pixel.
    #[error("the header claims {0} pixels, and a picture has at least one")]
    Empty(Size),
    /// The header claims more pixels than [`MOST_PIXELS`].
    #[error(
        "the header claims {0} pixels, more than the {MOST_PIXELS} that are read; scale it down"
    )]
    TooLarge(Size),
    /// The header claims more pixels than the file can hold.
    #[error(
        "the header claims {size} pixels, and no file of {bytes} bytes holds so many; it is \
         damaged, cut short or made to exhaust memory"
    )]
    OutOfProportion {
        /// What the header claims.
        size: Size,
        /// How long the file is.
        bytes: usize,
    },
    /// The picture is sound, and its samples are of the wrong kind.
    #[error("its samples are {found}, and {wanted} are needed")]
    Samples {
        /// What the file has.
        found: String,
        /// What the reader reads.
        wanted: &'static str,
    },
    /// The decoder gives up.
    #[error("the picture is damaged or of an unknown kind: {0}")]
    Broken(String),
}

/// A plane that no PNG holds: without pixels, or with more than 2^32 - 1 along one side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a plane of {0} pixels cannot be a PNG")]
pub struct NotAPng(pub Size);

/// What a picture file or a camera holds, `[[y, x]]`, before anyone says what it means; the largest code is
/// white.
#[derive(Clone, Debug)]
pub enum Samples {
    /// Grey, 8 bits.
    Grey8(Array2<u8>),
    /// Grey, 16 bits.
    Grey16(Array2<u16>),
    /// Red, green and blue, 8 bits each.
    Rgb8(Array2<[u8; 3]>),
    /// Red, green and blue, 16 bits each.
    Rgb16(Array2<[u16; 3]>),
}

/// Numbers stored as the samples of a grey or indexed PNG, exactly as they stand in the file.
pub(crate) struct PngCodes {
    /// Bits of one sample: 1, 2, 4, 8 or 16.
    pub(crate) bits: u8,
    /// Whether the samples are indices into a palette.
    pub(crate) indexed: bool,
    /// The samples `[[y, x]]`.
    pub(crate) plane: Array2<u16>,
}

/// Decodes a PNG, PNM, JPEG or TIFF picture. Alpha is dropped; turns that a camera notes beside
/// the picture are not applied, since both eyes of a calibrated pair are used as they were stored.
pub(crate) fn decode(bytes: &[u8]) -> Result<Samples, NotAPicture> {
    let format = image::guess_format(bytes)
        .ok()
        .filter(ImageFormat::reading_enabled)
        .ok_or(NotAPicture::Format("PNG, PNM, JPEG or TIFF"))?;
    decode_as(bytes, format)
}

fn decode_as(bytes: &[u8], format: ImageFormat) -> Result<Samples, NotAPicture> {
    if format == ImageFormat::Tiff && !tiff_directory::is_proportionate(bytes) {
        return Err(NotAPicture::Broken(
            "its directory claims more values than the file has bytes for".to_owned(),
        ));
    }
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let honest_pixels = bytes
        .len()
        .saturating_mul(MOST_PIXELS_PER_BYTE)
        .min(MOST_PIXELS);
    // Eight bytes a pixel are the most that any kind accepted below takes.
    let mut limits = Limits::default();
    limits.max_alloc = Some(8 * honest_pixels as u64 + SPARE_BYTES);
    reader.limits(limits);
    let mut decoder = reader.into_decoder().map_err(broken)?;

    let other = |found: &str| NotAPicture::Samples {
        found: found.to_owned(),
        wanted: "8-bit or 16-bit grey or colour ones",
    };
    // Before the pixels are unpacked, which takes three times as much of these.
    if matches!(decoder.color_type(), ColorType::Rgb32F | ColorType::Rgba32F) {
        return Err(other("floats, whose white is anyone's guess"));
    }
    let (width, height) = decoder.dimensions();
    let size = Size {
        width: width as usize,
        height: height as usize,
    };
    let pixels = size.width.checked_mul(size.height);
    match pixels {
        Some(0) => return Err(NotAPicture::Empty(size)),
        Some(pixels) if pixels <= honest_pixels => {}
        Some(pixels) if pixels <= MOST_PIXELS => {
            return Err(NotAPicture::OutOfProportion {
                size,
                bytes: bytes.len(),
            });
        }
        _ => return Err(NotAPicture::TooLarge(size)),
    }
    // Once more with the true size: the TIFF decoder takes what the picture leaves of the limit
    // as leave to allocate.
    let mut limits = Limits::default();
    limits.max_alloc = Some(decoder.total_bytes() + SPARE_BYTES);
    decoder.set_limits(limits).map_err(broken)?;

    match DynamicImage::from_decoder(decoder).map_err(broken)? {
        DynamicImage::ImageLuma8(grey) => plane(size, grey.into_raw()).map(Samples::Grey8),
        DynamicImage::ImageLuma16(grey) => plane(size, grey.into_raw()).map(Samples::Grey16),
        DynamicImage::ImageLumaA8(grey) => {
            plane(size, grey.pixels().map(|p| p.0[0]).collect()).map(Samples::Grey8)
        }
        DynamicImage::ImageLumaA16(grey) => {
            plane(size, grey.pixels().map(|p| p.0[0]).collect()).map(Samples::Grey16)
        }
        DynamicImage::ImageRgb8(rgb) => {
            plane(size, rgb.pixels().map(|p| p.0).collect()).map(Samples::Rgb8)
        }
        DynamicImage::ImageRgb16(rgb) => {
            plane(size, rgb.pixels().map(|p| p.0).collect()).map(Samples::Rgb16)
        }
        DynamicImage::ImageRgba8(rgba) => plane(
            size,
            rgba.pixels().map(|p| [p.0[0], p.0[1], p.0[2]]).collect(),
        )
        .map(Samples::Rgb8),
        DynamicImage::ImageRgba16(rgba) => plane(
            size,
            rgba.pixels().map(|p| [p.0[0], p.0[1], p.0[2]]).collect(),
        )
        .map(Samples::Rgb16),
        _ => Err(other("of an unknown kind")),
    }
}

/// Decodes the numbers in a grey or indexed PNG without the scaling that makes white white.
pub(crate) fn decode_codes(bytes: &[u8]) -> Result<PngCodes, NotAPicture> {
    let header = PngHeader::of(bytes).ok_or(NotAPicture::Format("PNG"))?;
    let samples = match header.kind {
        PngHeader::GREY => decode_as(bytes, ImageFormat::Png)?,
        // The samples of an indexed PNG are laid out like those of a grey one. Called grey, they
        // come through as the indices they are, and not as the colours they stand for.
        PngHeader::INDEXED => decode_as(&header.as_grey(bytes), ImageFormat::Png)?,
        _ => {
            return Err(NotAPicture::Samples {
                found: "colours".to_owned(),
                wanted: "grey values that stand for numbers",
            });
        }
    };
    let plane = match samples {
        // Samples of fewer than 8 bits were stretched to 0..=255, an exact multiple.
        Samples::Grey8(grey) => {
            let step = match header.bits {
                1 => 255,
                2 => 85,
                4 => 17,
                _ => 1,
            };
            grey.mapv(|grey| u16::from(grey / step))
        }
        Samples::Grey16(grey) => grey,
        Samples::Rgb8(_) | Samples::Rgb16(_) => {
            return Err(NotAPicture::Broken(
                "it says grey and holds colours".to_owned(),
            ));
        }
    };
    Ok(PngCodes {
        bits: header.bits,
        indexed: header.kind == PngHeader::INDEXED,
        plane,
    })
}

impl PngCodes {
    /// The plane, if its samples are grey (not indexed) ones of at most 8 bits.
    pub(crate) fn grey8(self) -> Result<Array2<u16>, NotAPicture> {
        self.grey(|bits| bits <= 8, "8-bit grey ones")
    }

    /// The plane, if its samples are grey (not indexed) ones of 16 bits.
    pub(crate) fn grey16(self) -> Result<Array2<u16>, NotAPicture> {
        self.grey(|bits| bits == 16, "16-bit grey ones")
    }

    fn grey(
        self,
        fits: impl FnOnce(u8) -> bool,
        wanted: &'static str,
    ) -> Result<Array2<u16>, NotAPicture> {
        if !self.indexed && fits(self.bits) {
            return Ok(self.plane);
        }
        let kind = if self.indexed { "palette" } else { "grey" };
        Err(NotAPicture::Samples {
            found: format!("{}-bit {kind} ones", self.bits),
            wanted,
        })
    }
}

/// What the first chunk of a PNG says of its samples.
struct PngHeader {
    bits: u8,
    kind: u8,
}

impl PngHeader {
    const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";
    const GREY: u8 = 0;
    const INDEXED: u8 = 3;
    /// Signature, and the first chunk: length, name, thirteen bytes, checksum.
    const LENGTH: usize = 8 + 4 + 4 + 13 + 4;

    fn of(bytes: &[u8]) -> Option<Self> {
        let header = bytes.get(..Self::LENGTH)?;
        (header.starts_with(Self::SIGNATURE) && &header[12..16] == b"IHDR").then(|| Self {
            bits: header[24],
            kind: header[25],
        })
    }

    /// The same PNG, called grey: the palette and its transparencies left out.
    fn as_grey(&self, bytes: &[u8]) -> Vec<u8> {
        let (header, mut rest) = bytes.split_at(Self::LENGTH);
        let mut grey = header.to_vec();
        grey[25] = Self::GREY;
        let checksum = crc32(&grey[12..29]);
        grey[29..33].copy_from_slice(&checksum.to_be_bytes());
        while let Some((length, _)) = rest.split_first_chunk() {
            let whole = (u32::from_be_bytes(*length) as usize).saturating_add(12);
            let (chunk, after) = rest.split_at(whole.min(rest.len()));
            if !matches!(chunk.get(4..8), Some(b"PLTE" | b"tRNS" | b"bKGD" | b"hIST")) {
                grey.extend_from_slice(chunk);
            }
            rest = after;
        }
        grey
    }
}

/// The checksum of PNG chunks (ISO 3309), bit by bit: it runs over seventeen bytes a file.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| {
            (crc >> 1) ^ (0xEDB8_8320 & (crc & 1).wrapping_neg())
        })
    })
}

fn plane<T>(size: Size, samples: Vec<T>) -> Result<Array2<T>, NotAPicture> {
    Array2::from_shape_vec(size.dim(), samples)
        .map_err(|shape| NotAPicture::Broken(shape.to_string()))
}

fn broken(error: image::ImageError) -> NotAPicture {
    NotAPicture::Broken(error.to_string())
}

/// An 8-bit grey PNG.
pub(crate) fn encode_grey8(plane: ArrayView2<'_, u8>) -> Result<Vec<u8>, NotAPng> {
    encode(
        Size::of_dim(plane.dim()),
        &plane.iter().copied().collect::<Vec<_>>(),
        ExtendedColorType::L8,
        CompressionType::Fast,
    )
}

/// A 16-bit grey PNG.
pub(crate) fn encode_grey16(plane: ArrayView2<'_, u16>) -> Result<Vec<u8>, NotAPng> {
    // The encoder takes the machine's byte order and writes the file's.
    let samples: Vec<u8> = plane.iter().flat_map(|code| code.to_ne_bytes()).collect();
    let size = Size::of_dim(plane.dim());
    encode(
        size,
        &samples,
        ExtendedColorType::L16,
        CompressionType::Fast,
    )
}

/// An 8-bit colour PNG.
pub(crate) fn encode_rgb8(
    plane: ArrayView2<'_, [u8; 3]>,
    compression: CompressionType,
) -> Result<Vec<u8>, NotAPng> {
    let samples: Vec<u8> = plane.iter().flatten().copied().collect();
    let size = Size::of_dim(plane.dim());
    encode(size, &samples, ExtendedColorType::Rgb8, compression)
}

fn encode(
    size: Size,
    samples: &[u8],
    kind: ExtendedColorType,
    compression: CompressionType,
) -> Result<Vec<u8>, NotAPng> {
    let side = |pixels: usize| u32::try_from(pixels).ok().filter(|&side| side > 0);
    let (Some(width), Some(height)) = (side(size.width), side(size.height)) else {
        return Err(NotAPng(size));
    };
    let mut bytes = Vec::new();
    // The encoder refuses sizes alone: a growing buffer takes every byte.
    PngEncoder::new_with_quality(&mut bytes, compression, FilterType::Adaptive)
        .write_image(samples, width, height, kind)
        .map_err(|_| NotAPng(size))?;
    Ok(bytes)
}

/// A colour JPEG of so much quality, 1 to 100.
pub(crate) fn encode_jpeg(plane: ArrayView2<'_, [u8; 3]>, quality: u8) -> Result<Vec<u8>, NotAPng> {
    let size = Size::of_dim(plane.dim());
    let side = |pixels: usize| u16::try_from(pixels).ok().filter(|&side| side > 0);
    let (Some(width), Some(height)) = (side(size.width), side(size.height)) else {
        return Err(NotAPng(size));
    };
    let samples: Vec<u8> = plane.iter().flatten().copied().collect();
    let mut bytes = Vec::new();
    image::codecs::jpeg::JpegEncoder::new_with_quality(&mut bytes, quality)
        .encode(
            &samples,
            width.into(),
            height.into(),
            ExtendedColorType::Rgb8,
        )
        .map_err(|_| NotAPng(size))?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The check value that every description of this checksum gives.
    #[test]
    fn the_checksum_is_the_known_one() {
        assert_eq!(crc32(b"123456789"), 0xCBF4_3926);
    }

    /// A PNG with one chunk of each kind, samples stored without compression.
    pub(super) fn png(bits: u8, kind: u8, size: (u32, u32), rows: &[u8], palette: bool) -> Vec<u8> {
        let mut bytes = PngHeader::SIGNATURE.to_vec();
        let mut chunk = |name: &[u8; 4], body: &[u8]| {
            bytes.extend(u32::try_from(body.len()).unwrap().to_be_bytes());
            let named = [name, body].concat();
            bytes.extend(&named);
            bytes.extend(crc32(&named).to_be_bytes());
        };
        let mut header = [size.0.to_be_bytes(), size.1.to_be_bytes()].concat();
        header.extend([bits, kind, 0, 0, 0]);
        chunk(b"IHDR", &header);
        if palette {
            chunk(b"PLTE", &[9, 9, 9, 9, 9, 9, 200, 0, 0, 0, 200, 0]);
            chunk(b"tRNS", &[0]);
        }
        let adler = {
            let (mut a, mut b) = (1u32, 0u32);
            for &byte in rows {
                a = (a + u32::from(byte)) % 65521;
                b = (b + a) % 65521;
            }
            (b << 16) | a
        };
        let length = u16::try_from(rows.len()).unwrap();
        let mut zlib = vec![0x78, 0x01, 0x01];
        zlib.extend(length.to_le_bytes());
        zlib.extend((!length).to_le_bytes());
        zlib.extend(rows);
        zlib.extend(adler.to_be_bytes());
        chunk(b"IDAT", &zlib);
        chunk(b"IEND", &[]);
        bytes
    }

    #[test]
    fn indices_come_through_as_they_stand() {
        // Four 2-bit samples a row: 0 1 2 3 and 3 2 1 0, each row behind its filter byte.
        let rows = [0, 0b00_01_10_11, 0, 0b11_10_01_00];
        let want = ndarray::array![[0, 1, 2, 3], [3, 2, 1, 0]];
        for (kind, palette) in [(PngHeader::INDEXED, true), (PngHeader::GREY, false)] {
            let codes = decode_codes(&png(2, kind, (4, 2), &rows, palette)).unwrap();
            assert_eq!((codes.bits, codes.indexed), (2, palette));
            assert_eq!(codes.plane, want);
        }
        let eight = decode_codes(&png(8, 3, (2, 1), &[0, 3, 1], true)).unwrap();
        assert_eq!(eight.plane, ndarray::array![[3, 1]]);
    }

    #[test]
    fn a_claim_beyond_the_file_is_refused_before_it_costs_memory() {
        let small = png(8, 0, (8_000, 8_000), &[0, 1], false);
        assert!(matches!(
            decode(&small),
            Err(NotAPicture::OutOfProportion { .. })
        ));
        let huge = png(8, 0, (2_000_000_000, 2_000_000_000), &[0, 1], false);
        assert!(decode(&huge).is_err());
        assert!(matches!(
            decode(b"P5 0 3 255\n"),
            Err(NotAPicture::Empty(_) | NotAPicture::Broken(_))
        ));
    }
}
