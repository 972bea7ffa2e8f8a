use std::io::{self, Read};

use dorsal::v1_gabor::{Binocular, Size};
use ndarray::{Array2, s};
use stereo_formats::MOST_PIXELS;
use stereo_formats::picture::{Picture, Samples};

/// Why a stream gives no frame.
#[derive(Debug, thiserror::Error)]
pub enum NotAStream {
    /// The bytes do not come.
    #[error("frame {frame}: {cause}")]
    Disk {
        /// The frame, counted from 1.
        frame: u64,
        /// What the system says.
        cause: io::Error,
    },
    /// The stream ends within a frame.
    #[error(
        "the stream ends in the middle of frame {frame}; whole frames before it have been used"
    )]
    Truncated {
        /// The frame, counted from 1.
        frame: u64,
    },
    /// The stream is not what it should be.
    #[error("{what}; as ffmpeg gives it: ffmpeg -i INPUT -f yuv4mpegpipe -pix_fmt yuv420p -")]
    Header {
        /// What is wrong.
        what: String,
    },
    /// The frame has no two halves.
    #[error(
        "frames of {0} pixels have no two halves of a size; a side-by-side pair is an even number of pixels wide, and of \
         at most {MOST_PIXELS} pixels"
    )]
    Halves(Size),
}

/// Frames with the left eye's picture in their left half and the right eye's in the right one, in grey.
#[derive(Debug)]
pub struct SideBySide<R> {
    source: R,
    layout: Layout,
    frames: u64,
}

/// How frames lie in the stream.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Layout {
    size: Size,
    /// A line stands before each frame, as in Y4M.
    heads: bool,
    /// What follows the grey plane, in bytes.
    rest: usize,
}

/// The longest line of a header.
const LONGEST_LINE: usize = 1024;

impl<R: Read> SideBySide<R> {
    /// Grey frames of eight bits and this size, one after another, without any header.
    ///
    /// # Errors
    /// [`NotAStream::Halves`] if there are no two halves.
    pub fn raw(source: R, size: Size) -> Result<Self, NotAStream> {
        Self::of(
            source,
            Layout {
                size,
                heads: false,
                rest: 0,
            },
        )
    }

    /// Frames of a YUV4MPEG2 stream, of which the luma is used.
    ///
    /// # Errors
    /// [`NotAStream`] if the header is none, or names samples that are not of eight bits.
    pub fn y4m(mut source: R) -> Result<Self, NotAStream> {
        let line = line(&mut source).map_err(|cause| NotAStream::Disk { frame: 1, cause })?;
        let layout = header(&line).map_err(|what| NotAStream::Header { what })?;
        Self::of(source, layout)
    }

    fn of(source: R, layout: Layout) -> Result<Self, NotAStream> {
        let Size { width, height } = layout.size;
        let pixels = width.saturating_mul(height);
        if pixels == 0 || !width.is_multiple_of(2) || pixels > MOST_PIXELS {
            return Err(NotAStream::Halves(layout.size));
        }
        Ok(Self {
            source,
            layout,
            frames: 0,
        })
    }

    /// The size of one eye's picture.
    #[must_use]
    pub const fn size(&self) -> Size {
        Size {
            width: self.layout.size.width / 2,
            height: self.layout.size.height,
        }
    }

    fn frame(&mut self) -> Result<Option<Binocular<Picture>>, NotAStream> {
        let frame = self.frames + 1;
        let failed = |cause: io::Error| match cause.kind() {
            io::ErrorKind::UnexpectedEof => NotAStream::Truncated { frame },
            _ => NotAStream::Disk { frame, cause },
        };
        if self.layout.heads {
            let head = line(&mut self.source).map_err(failed)?;
            if head.is_empty() {
                return Ok(None);
            }
            if !head.starts_with(b"FRAME") {
                let what = format!("frame {frame} does not begin with FRAME");
                return Err(NotAStream::Header { what });
            }
        }
        let Size { width, height } = self.layout.size;
        let mut bytes = vec![0; width * height];
        let mut filled = 0;
        while filled < bytes.len() {
            match self.source.read(&mut bytes[filled..]) {
                Ok(0) if filled == 0 && !self.layout.heads => return Ok(None),
                Ok(0) => return Err(NotAStream::Truncated { frame }),
                Ok(read) => filled += read,
                Err(cause) if cause.kind() == io::ErrorKind::Interrupted => {}
                Err(cause) => return Err(failed(cause)),
            }
        }
        let mut rest = (&mut self.source).take(self.layout.rest as u64);
        let skipped = io::copy(&mut rest, &mut io::sink()).map_err(failed)?;
        if skipped < self.layout.rest as u64 {
            return Err(NotAStream::Truncated { frame });
        }
        self.frames = frame;
        let halves = |size| NotAStream::Halves(size);
        let plane =
            Array2::from_shape_vec((height, width), bytes).map_err(|_| halves(self.layout.size))?;
        let eye = |columns: std::ops::Range<usize>| {
            let half = plane.slice(s![.., columns]).to_owned();
            Picture::of_samples(Samples::Grey8(half)).map_err(|_| halves(self.layout.size))
        };
        Ok(Some(Binocular {
            left: eye(0..width / 2)?,
            right: eye(width / 2..width)?,
        }))
    }
}

impl<R: Read> Iterator for SideBySide<R> {
    type Item = Result<Binocular<Picture>, NotAStream>;

    fn next(&mut self) -> Option<Self::Item> {
        self.frame().transpose()
    }
}

/// The bytes before the next line feed; none at the end of the stream. A line that never ends is cut.
fn line(source: &mut impl Read) -> io::Result<Vec<u8>> {
    let mut line = Vec::new();
    let mut byte = [0];
    while line.len() < LONGEST_LINE {
        match source.read(&mut byte) {
            Ok(0) if line.is_empty() => break,
            Ok(0) => return Err(io::ErrorKind::UnexpectedEof.into()),
            Ok(_) if byte[0] == b'\n' => break,
            Ok(_) => line.push(byte[0]),
            Err(cause) if cause.kind() == io::ErrorKind::Interrupted => {}
            Err(cause) => return Err(cause),
        }
    }
    Ok(line)
}

/// What a Y4M header says.
fn header(line: &[u8]) -> Result<Layout, String> {
    let text = String::from_utf8_lossy(line);
    let mut words = text.split(' ');
    if words.next() != Some("YUV4MPEG2") {
        return Err("the stream does not begin with YUV4MPEG2".to_owned());
    }
    let (mut width, mut height, mut colours) = (0usize, 0usize, "420jpeg".to_owned());
    for word in words {
        let number = || {
            word[1..]
                .parse()
                .map_err(|_| format!("'{word}' is no size"))
        };
        match word.as_bytes().first() {
            Some(b'W') => width = number()?,
            Some(b'H') => height = number()?,
            Some(b'C') => word[1..].clone_into(&mut colours),
            _ => {}
        }
    }
    let pixels = width.saturating_mul(height);
    let quarter = width.div_ceil(2).saturating_mul(height.div_ceil(2));
    let rest = match &*colours {
        "420" | "420jpeg" | "420paldv" | "420mpeg2" => quarter.saturating_mul(2),
        "422" => width.div_ceil(2).saturating_mul(height).saturating_mul(2),
        "444" => pixels.saturating_mul(2),
        "mono" => 0,
        other => {
            return Err(format!(
                "samples of kind {other} are not read, only 420, 422, 444 and mono of eight bits"
            ));
        }
    };
    Ok(Layout {
        size: Size { width, height },
        heads: true,
        rest,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn y4m(colours: &str, frames: usize) -> Vec<u8> {
        let mut bytes = format!("YUV4MPEG2 W6 H2 F30:1 Ip A1:1 {colours}\n").into_bytes();
        let rest = match colours {
            "Cmono" => 0,
            "C444" => 24,
            "C422" => 12,
            _ => 6,
        };
        for frame in 0..frames {
            bytes.extend(b"FRAME\n");
            bytes.extend((0..12).map(|at| (frame * 20 + at) as u8));
            bytes.extend(vec![128; rest]);
        }
        bytes
    }

    #[test]
    fn every_frame_comes_in_two_halves() {
        for colours in ["C420jpeg", "C422", "C444", "Cmono", "XYSCSS=420"] {
            let bytes = y4m(colours, 3);
            let frames: Vec<_> = SideBySide::y4m(&bytes[..])
                .expect("a stream")
                .collect::<Result<_, _>>()
                .expect("whole frames");
            assert_eq!(frames.len(), 3, "{colours}");
            assert_eq!(frames[1].left.rgb()[[1, 2]], [28; 3]);
            assert_eq!(frames[1].right.rgb()[[0, 0]], [23; 3]);
        }
    }

    #[test]
    fn a_cut_stream_says_in_which_frame() {
        let bytes = y4m("C420jpeg", 2);
        let cut = &bytes[..bytes.len() - 1];
        let mut frames = SideBySide::y4m(cut).expect("a stream");
        assert!(matches!(frames.next(), Some(Ok(_))));
        assert!(matches!(
            frames.next(),
            Some(Err(NotAStream::Truncated { frame: 2 }))
        ));
        let raw = SideBySide::raw(
            &bytes[..13],
            Size {
                width: 6,
                height: 2,
            },
        );
        let mut raw = raw.expect("a stream");
        assert!(matches!(raw.next(), Some(Ok(_))));
        assert!(matches!(
            raw.next(),
            Some(Err(NotAStream::Truncated { frame: 2 }))
        ));
    }

    #[test]
    fn what_is_no_stream_is_refused() {
        let not = |bytes: &[u8]| SideBySide::y4m(bytes).expect_err("refused").to_string();
        assert!(not(b"RIFF....\n").contains("YUV4MPEG2"));
        assert!(not(b"YUV4MPEG2 W5 H2\n").contains("even number"));
        assert!(not(b"YUV4MPEG2 W4 H2 C420p10\n").contains("420p10"));
        assert!(not(b"YUV4MPEG2 W4x H2\n").contains("W4x"));
        assert!(not(b"").contains("YUV4MPEG2"));
    }
}
