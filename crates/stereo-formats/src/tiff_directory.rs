//! What the directory of a TIFF file claims, looked at before the decoder believes it.

/// Whether every entry of the first directory claims no more values than the file has bytes for.
///
/// The decoder makes room for what an entry claims before it is told any limit, so 315 bytes can
/// ask for 60 MiB. Whatever else is wrong with a directory is left to the decoder, which says so.
pub(crate) fn is_proportionate(bytes: &[u8]) -> bool {
    let big_endian = bytes.starts_with(b"MM");
    let number = |at: usize, length: usize| -> Option<usize> {
        let digits = bytes.get(at..at.checked_add(length)?)?;
        let push = |number: usize, digit: &u8| number << 8 | usize::from(*digit);
        Some(if big_endian {
            digits.iter().fold(0, push)
        } else {
            digits.iter().rev().fold(0, push)
        })
    };
    let Some(directory) = number(4, 4) else {
        return true;
    };
    let entries = number(directory, 2).unwrap_or(0);
    (0..entries)
        .map(|entry| directory + 2 + 12 * entry)
        .map_while(|entry| Some((number(entry + 2, 2)?, number(entry + 4, 4)?)))
        .all(|(kind, count)| count.saturating_mul(bytes_of(kind)) <= bytes.len())
}

/// The length of one value of a field type, in bytes: TIFF 6.0, section 2.
const fn bytes_of(kind: usize) -> usize {
    match kind {
        3 | 8 => 2,
        4 | 9 | 11 | 13 => 4,
        5 | 10 | 12 | 16 | 17 | 18 => 8,
        _ => 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A directory of one entry, in either order of bytes.
    fn file(kind: u16, count: u32, big_endian: bool) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut word = |value: u32, length: usize| {
            let digits = value.to_be_bytes();
            let digits = &digits[4 - length..];
            if big_endian {
                bytes.extend(digits);
            } else {
                bytes.extend(digits.iter().rev());
            }
        };
        word(if big_endian { 0x4d4d } else { 0x4949 }, 2);
        word(42, 2);
        word(8, 4);
        word(1, 2);
        word(273, 2);
        word(u32::from(kind), 2);
        word(count, 4);
        word(0, 4);
        word(0, 4);
        bytes
    }

    #[test]
    fn a_claim_beyond_the_file_is_seen() {
        for big_endian in [false, true] {
            // 26 bytes hold six values of four bytes, and not seven.
            assert!(is_proportionate(&file(4, 6, big_endian)));
            assert!(!is_proportionate(&file(4, 7, big_endian)));
            assert!(!is_proportionate(&file(12, u32::MAX, big_endian)));
        }
    }

    #[test]
    fn a_cut_directory_is_left_to_the_decoder() {
        let whole = file(4, u32::MAX, false);
        for length in 0..18 {
            assert!(is_proportionate(&whole[..length]));
        }
    }
}
