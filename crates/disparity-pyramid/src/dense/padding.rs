use crate::SearchRange;
use crate::dense::pixel_cost::LANES;

/// How many pixels a row is continued beyond its ends, so that every shift of the search leads to
/// a stored one, and whole vectors of shifts can be read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Padding {
    before: usize,
    after: usize,
    /// The least shift: where the first of a pixel's costs is read.
    least_dx: i32,
}

impl Padding {
    pub(crate) fn of(search: SearchRange) -> Self {
        let whole = search.shifts().next_multiple_of(LANES);
        let beyond = search.least_dx() + whole as i32;
        Self {
            before: (-search.least_dx()).max(0) as usize,
            after: beyond.max(0) as usize,
            least_dx: search.least_dx(),
        }
    }

    /// Length of a padded row.
    pub(crate) const fn stride(self, width: usize) -> usize {
        self.before + width + self.after
    }

    /// Where pixel `x` lies in a padded row.
    #[inline(always)]
    pub(crate) const fn place(self, x: usize) -> usize {
        self.before + x
    }

    /// Where the least shift leads from pixel `x`, in a padded row of the other eye.
    #[inline(always)]
    pub(crate) const fn first(self, x: usize) -> usize {
        (self.before + x).wrapping_add_signed(self.least_dx as isize)
    }

    /// Continues a row, whose own pixels are in place, beyond its ends.
    pub(crate) fn replicate<T: Copy>(self, row: &mut [T]) {
        let last = row.len() - self.after - 1;
        let (first, last_value) = (row[self.before], row[last]);
        row[..self.before].fill(first);
        row[last + 1..].fill(last_value);
    }

    /// Mirrors a padded row: its own pixels exchange their places, the borders follow.
    pub(crate) fn mirror<T: Copy>(self, row: &mut [T]) {
        let end = row.len() - self.after;
        row[self.before..end].reverse();
        self.replicate(row);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Every shift of the search leads from every pixel to the pixel there, or to the last one
        /// on that side.
        #[test]
        fn shifts_lead_to_pixels(width in 1usize..30, least in -40i32..40, more in 0i32..40) {
            let search = SearchRange::new(least, least + more).unwrap();
            let padding = Padding::of(search);
            let mut row = vec![-1; padding.stride(width)];
            for x in 0..width {
                row[padding.place(x)] = x as i32;
            }
            padding.replicate(&mut row);
            for x in 0..width {
                let first = padding.first(x);
                for (i, dx) in (search.least_dx()..=search.most_dx()).enumerate() {
                    let seen = (x as i32 + dx).clamp(0, width as i32 - 1);
                    prop_assert_eq!(row[first + i], seen);
                }
                // Whole vectors can be read.
                prop_assert!(first + search.shifts().next_multiple_of(LANES) <= row.len());
            }
            let mut mirrored = row.clone();
            padding.mirror(&mut mirrored);
            for x in 0..width {
                prop_assert_eq!(mirrored[padding.place(x)], (width - 1 - x) as i32);
            }
        }
    }
}
