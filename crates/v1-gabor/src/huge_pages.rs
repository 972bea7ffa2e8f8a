/// Least size of a buffer that pages of 2 MiB are worth it for, in bytes.
const WORTH_IT: usize = 4 << 20;

/// Asks for the memory of a large buffer to come in pages of 2 MiB, which no result depends on.
///
/// A frame's responses at the finest scale are 50 MB an eye: 12 000 pages of the usual size, and a
/// reader that follows three rows at once comes to a new one at every twenty-first pixel. With large
/// ones the frames of a matcher that reads them take a sixth less time, and filling them a tenth.
/// Where the system has none to give, or is not Linux, nothing happens.
pub(crate) fn ask(numbers: &mut [f32]) {
    if size_of_val(numbers) >= WORTH_IT {
        advise(numbers);
    }
}

#[cfg(target_os = "linux")]
#[expect(
    unsafe_code,
    reason = "a hint about the pages of a buffer, which changes none of its bytes"
)]
fn advise(numbers: &mut [f32]) {
    /// Every page of the usual size begins at a multiple of this, on every machine.
    const PAGE: usize = 64 << 10;
    let bytes = numbers.as_mut_ptr().cast::<u8>();
    let before = bytes.align_offset(PAGE);
    if let Some(len) = size_of_val(numbers).checked_sub(before) {
        // SAFETY: the range lies within the buffer, which is borrowed alone, and `MADV_HUGEPAGE` says
        // how it shall be mapped and leaves what it holds as it is. A refusal changes nothing.
        unsafe {
            libc::madvise(
                bytes.add(before).cast(),
                len / PAGE * PAGE,
                libc::MADV_HUGEPAGE,
            )
        };
    }
}

#[cfg(not(target_os = "linux"))]
const fn advise(_: &mut [f32]) {}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the length, the numbers are those that were there.
    #[test]
    fn numbers_stay() {
        for len in [0, 1, WORTH_IT / 4 - 1, WORTH_IT / 4, 3 * WORTH_IT / 4 + 5] {
            let mut numbers: Vec<f32> = (0..len).map(|i| i as f32).collect();
            ask(&mut numbers);
            assert!(
                numbers
                    .iter()
                    .enumerate()
                    .all(|(i, &number)| number == i as f32)
            );
        }
    }
}
