/// Why bytes are no message of ROS 2.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotCdr {
    /// The first four bytes name no encapsulation that is read here.
    #[error(
        "its encapsulation is {0:02x} {1:02x}, and only plain CDR (00 00 or 00 01) is read; record the bag \
         with serialization_format cdr, the default of ROS 2"
    )]
    Encapsulation(u8, u8),
    /// The bytes end before the value does.
    #[error(
        "{field} needs {needed} bytes from byte {at} on and the message has {length}; the recording is damaged or \
         the message is of another type"
    )]
    Short {
        /// What was being read.
        field: &'static str,
        /// Where it begins, counted from 0.
        at: usize,
        /// How long it is.
        needed: usize,
        /// Length of the message in bytes.
        length: usize,
    },
    /// A text is not UTF-8.
    #[error(
        "{field} is not UTF-8 text; the recording is damaged or the message is of another type"
    )]
    Text {
        /// What was being read.
        field: &'static str,
    },
}

/// A reader of plain CDR, the encoding of ROS 2: numbers of `n` bytes begin at a multiple of `n` from the
/// end of the encapsulation header, texts and sequences begin with their length.
#[derive(Clone, Debug)]
pub(crate) struct Cdr<'a> {
    bytes: &'a [u8],
    at: usize,
    little: bool,
}

/// The encapsulation header, which alignment does not count.
const HEADER: usize = 4;

impl<'a> Cdr<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Result<Self, NotCdr> {
        let Some(&[representation, order, _, _]) = bytes.first_chunk::<HEADER>() else {
            return Err(NotCdr::Short {
                field: "the encapsulation",
                at: 0,
                needed: HEADER,
                length: bytes.len(),
            });
        };
        if representation != 0 || order > 1 {
            return Err(NotCdr::Encapsulation(representation, order));
        }
        Ok(Self {
            bytes,
            at: HEADER,
            little: order == 1,
        })
    }

    pub(crate) fn bytes(&mut self, field: &'static str, count: usize) -> Result<&'a [u8], NotCdr> {
        let taken = self.bytes.get(self.at..).and_then(|rest| rest.get(..count));
        let taken = taken.ok_or(NotCdr::Short {
            field,
            at: self.at,
            needed: count,
            length: self.bytes.len(),
        })?;
        self.at += count;
        Ok(taken)
    }

    /// The bytes of a number, lowest first.
    fn number<const N: usize>(&mut self, field: &'static str) -> Result<[u8; N], NotCdr> {
        self.at += (self.at - HEADER).next_multiple_of(N) - (self.at - HEADER);
        let mut number = [0; N];
        number.copy_from_slice(self.bytes(field, N)?);
        if !self.little {
            number.reverse();
        }
        Ok(number)
    }

    pub(crate) fn u8(&mut self, field: &'static str) -> Result<u8, NotCdr> {
        Ok(self.number::<1>(field)?[0])
    }

    pub(crate) fn u32(&mut self, field: &'static str) -> Result<u32, NotCdr> {
        Ok(u32::from_le_bytes(self.number(field)?))
    }

    pub(crate) fn f64(&mut self, field: &'static str) -> Result<f64, NotCdr> {
        Ok(f64::from_le_bytes(self.number(field)?))
    }

    pub(crate) fn f64s<const N: usize>(&mut self, field: &'static str) -> Result<[f64; N], NotCdr> {
        let mut all = [0.0; N];
        for one in &mut all {
            *one = self.f64(field)?;
        }
        Ok(all)
    }

    pub(crate) fn sequence(&mut self, field: &'static str) -> Result<&'a [u8], NotCdr> {
        let length = self.u32(field)? as usize;
        self.bytes(field, length)
    }

    pub(crate) fn text(&mut self, field: &'static str) -> Result<&'a str, NotCdr> {
        let bytes = self.sequence(field)?;
        let text = std::str::from_utf8(bytes).map_err(|_| NotCdr::Text { field })?;
        // The length counts the zero at the end.
        Ok(text.strip_suffix('\0').unwrap_or(text))
    }

    /// A `std_msgs/Header`: its stamp in nanoseconds; whose frame it is does not matter here.
    pub(crate) fn stamp_ns(&mut self) -> Result<u64, NotCdr> {
        let seconds = self.u32("header.stamp.sec")?;
        let nanoseconds = self.u32("header.stamp.nanosec")?;
        self.text("header.frame_id")?;
        Ok(u64::from(seconds) * 1_000_000_000 + u64::from(nanoseconds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_aligned_from_the_end_of_the_header() {
        // A byte, three bytes of padding, a number of four; padding again, a number of eight.
        let mut little = vec![0, 1, 0, 0, 7, 0, 0, 0, 1, 2, 0, 0];
        little.extend(1.5f64.to_le_bytes());
        let mut big = vec![0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 2, 1];
        big.extend(1.5f64.to_be_bytes());
        for bytes in [little, big] {
            let mut cdr = Cdr::new(&bytes).expect("CDR");
            assert_eq!(cdr.u8("a"), Ok(7));
            assert_eq!(cdr.u32("b"), Ok(0x0201));
            assert_eq!(cdr.f64("c"), Ok(1.5));
            assert!(matches!(cdr.u8("d"), Err(NotCdr::Short { at: 20, .. })));
        }
    }

    #[test]
    fn a_length_that_the_bytes_do_not_bear_out_is_refused() {
        let bytes = [0, 1, 0, 0, 255, 255, 255, 255, 65];
        let refused = Cdr::new(&bytes).and_then(|mut cdr| cdr.text("encoding").map(str::to_owned));
        assert!(
            matches!(refused, Err(NotCdr::Short { needed, .. }) if needed == u32::MAX as usize)
        );
    }
}
