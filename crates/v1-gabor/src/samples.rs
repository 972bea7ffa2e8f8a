/// Bytes that a cache moves at a time.
const LINE: usize = 64;

/// Numbers that begin at a cache line: for eight orientations a pixel's sixteen fill one line, and
/// not halves of two.
#[derive(Debug)]
pub struct Samples {
    /// The numbers, and before and after them what is needed to begin at a line.
    storage: Vec<f32>,
    start: usize,
    len: usize,
}

impl Samples {
    /// As many zeros.
    #[must_use]
    pub fn zeros(len: usize) -> Self {
        // Fresh zeros of the system, of which no page is touched yet.
        let storage = vec![0.0f32; len + LINE / size_of::<f32>()];
        let start = storage.as_ptr().align_offset(LINE);
        // An allocator may, by its contract, not tell; the line is then only not met.
        let start = if start > storage.len() - len {
            0
        } else {
            start
        };
        Self {
            storage,
            start,
            len,
        }
    }

    /// The numbers.
    #[inline(always)]
    #[must_use]
    pub fn as_slice(&self) -> &[f32] {
        &self.storage[self.start..self.start + self.len]
    }

    /// The numbers, to be written over.
    #[inline(always)]
    pub fn as_mut_slice(&mut self) -> &mut [f32] {
        &mut self.storage[self.start..self.start + self.len]
    }
}

impl Clone for Samples {
    /// Copied to where a line begins in the copy.
    fn clone(&self) -> Self {
        let mut copy = Self::zeros(self.len);
        copy.as_mut_slice().copy_from_slice(self.as_slice());
        copy
    }
}

impl PartialEq for Samples {
    fn eq(&self, other: &Self) -> bool {
        self.as_slice() == other.as_slice()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the length, a line begins at the first number, of a copy too, and the numbers are
    /// those that were written.
    #[test]
    fn begin_at_a_line() {
        for len in [0, 1, 15, 16, 1000, 1 << 20] {
            let mut samples = Samples::zeros(len);
            for (i, sample) in samples.as_mut_slice().iter_mut().enumerate() {
                *sample = i as f32;
            }
            let copy = samples.clone();
            for samples in [&samples, &copy] {
                assert_eq!(samples.as_slice().as_ptr().align_offset(LINE), 0);
                assert_eq!(samples.as_slice().len(), len);
            }
            assert_eq!(samples, copy);
        }
    }
}
