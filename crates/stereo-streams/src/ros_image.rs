use ndarray::Array2;
use stereo_formats::picture::{self, Picture, Samples};
use stereo_formats::{MOST_PIXELS, NotAPicture};

use crate::cdr::{Cdr, NotCdr};

/// The messages that are pictures, as a bag names them.
pub const IMAGE_TYPES: [&str; 2] = ["sensor_msgs/msg/Image", "sensor_msgs/msg/CompressedImage"];

/// Why a message is no picture.
#[derive(Debug, thiserror::Error)]
pub enum NotARosImage {
    /// The bytes are no message.
    #[error(transparent)]
    Cdr(#[from] NotCdr),
    /// The message is of another type.
    #[error(
        "it is a {0}; a picture is a sensor_msgs/msg/Image or a sensor_msgs/msg/CompressedImage"
    )]
    Type(String),
    /// The samples are of a kind that is not read here.
    #[error(
        "its encoding is {0}, and read are mono8, mono16, rgb8, bgr8, rgba8, bgra8, rgb16, bgr16, 8UC1, 8UC3 and 16UC1; \
         convert it, as image_proc does for Bayer patterns"
    )]
    Encoding(String),
    /// The numbers in the message contradict each other.
    #[error(
        "its {height} rows of {step} bytes for {width} pixels of {encoding} need {needed} bytes and it has {length}"
    )]
    Length {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
        /// Bytes of a row.
        step: usize,
        /// The kind of the samples.
        encoding: String,
        /// Bytes that these need.
        needed: usize,
        /// Bytes that are there.
        length: usize,
    },
    /// It has no pixel, or too many.
    #[error("it has {width} x {height} pixels; from 1 to {MOST_PIXELS} are read")]
    Size {
        /// Pixels in a row.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The compressed picture is none.
    #[error("its {format} data: {cause}")]
    Compressed {
        /// The format that the message claims.
        format: String,
        /// What is wrong.
        cause: NotAPicture,
    },
}

/// When a picture was taken: the stamp in its header, in nanoseconds.
///
/// # Errors
/// [`NotCdr`] if the bytes are no message with a header.
pub fn image_stamp_ns(bytes: &[u8]) -> Result<u64, NotCdr> {
    Cdr::new(bytes)?.stamp_ns()
}

/// The picture in a message of type `kind`, one of [`IMAGE_TYPES`].
///
/// # Errors
/// [`NotARosImage`] says what is wrong and what is read.
pub fn decode_image(kind: &str, bytes: &[u8]) -> Result<Picture, NotARosImage> {
    match kind {
        "sensor_msgs/msg/Image" => raw(bytes),
        "sensor_msgs/msg/CompressedImage" => compressed(bytes),
        other => Err(NotARosImage::Type(other.to_owned())),
    }
}

fn compressed(bytes: &[u8]) -> Result<Picture, NotARosImage> {
    let mut cdr = Cdr::new(bytes)?;
    cdr.stamp_ns()?;
    let format = cdr.text("format")?;
    picture::decode(cdr.sequence("data")?).map_err(|cause| NotARosImage::Compressed {
        format: format.to_owned(),
        cause,
    })
}

fn raw(bytes: &[u8]) -> Result<Picture, NotARosImage> {
    let mut cdr = Cdr::new(bytes)?;
    cdr.stamp_ns()?;
    let height = cdr.u32("height")? as usize;
    let width = cdr.u32("width")? as usize;
    let encoding = cdr.text("encoding")?;
    let big = cdr.u8("is_bigendian")? != 0;
    let step = cdr.u32("step")? as usize;
    let data = cdr.sequence("data")?;

    let kind = Kind::named(encoding).ok_or_else(|| NotARosImage::Encoding(encoding.to_owned()))?;
    let pixels = width.saturating_mul(height);
    if pixels == 0 || pixels > MOST_PIXELS {
        return Err(NotARosImage::Size { width, height });
    }
    // The last row need not be padded.
    let row = width * kind.bytes();
    let needed = step.max(row).saturating_mul(height - 1) + row;
    if step < row || data.len() < needed {
        return Err(NotARosImage::Length {
            width,
            height,
            step,
            encoding: encoding.to_owned(),
            needed: needed.max(row * height),
            length: data.len(),
        });
    }
    let sample = |y: usize, x: usize, channel: usize| {
        let at = y * step + x * kind.bytes() + channel * kind.sample_bytes;
        if kind.sample_bytes == 1 {
            u16::from(data[at])
        } else {
            let two = [data[at], data[at + 1]];
            if big {
                u16::from_be_bytes(two)
            } else {
                u16::from_le_bytes(two)
            }
        }
    };
    let colour = |(y, x): (usize, usize)| kind.rgb.map(|channel| sample(y, x, channel));
    let shape = (height, width);
    let samples = match (kind.channels, kind.sample_bytes) {
        (1, 1) => Samples::Grey8(Array2::from_shape_fn(shape, |(y, x)| sample(y, x, 0) as u8)),
        (1, _) => Samples::Grey16(Array2::from_shape_fn(shape, |(y, x)| sample(y, x, 0))),
        (_, 1) => Samples::Rgb8(Array2::from_shape_fn(shape, |at| {
            colour(at).map(|sample| sample as u8)
        })),
        _ => Samples::Rgb16(Array2::from_shape_fn(shape, colour)),
    };
    Picture::of_samples(samples).map_err(|_| NotARosImage::Size { width, height })
}

/// How the samples of a pixel lie in memory.
#[derive(Clone, Copy, Debug)]
struct Kind {
    channels: usize,
    sample_bytes: usize,
    /// Which channels are red, green and blue.
    rgb: [usize; 3],
}

impl Kind {
    const fn bytes(self) -> usize {
        self.channels * self.sample_bytes
    }

    /// The encodings of `sensor_msgs/image_encodings.hpp` that are pictures; OpenCV's three channels are
    /// blue, green, red.
    fn named(encoding: &str) -> Option<Self> {
        const RGB: [usize; 3] = [0, 1, 2];
        const BGR: [usize; 3] = [2, 1, 0];
        let (channels, sample_bytes, rgb) = match encoding {
            "mono8" | "8UC1" => (1, 1, [0; 3]),
            "mono16" | "16UC1" => (1, 2, [0; 3]),
            "rgb8" => (3, 1, RGB),
            "bgr8" | "8UC3" => (3, 1, BGR),
            "rgba8" => (4, 1, RGB),
            "bgra8" => (4, 1, BGR),
            "rgb16" => (3, 2, RGB),
            "bgr16" => (3, 2, BGR),
            _ => return None,
        };
        Some(Self {
            channels,
            sample_bytes,
            rgb,
        })
    }
}
