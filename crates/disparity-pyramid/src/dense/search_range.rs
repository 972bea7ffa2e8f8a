use crate::DisparityField;

/// The horizontal shifts that the dense estimator tries: whole pixels of `dx`, right minus left,
/// both ends included.
///
/// On a parallel rig every `dx` is 0 or less; eyes that converge see positive ones beyond the
/// fixation. (Files and command lines speak of `d = -dx`.)
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SearchRange {
    least_dx: i32,
    most_dx: i32,
}

/// Two shifts that are no range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum BadRange {
    /// The ends are in the wrong order.
    #[error(
        "no shift lies between dx = {least_dx} and {most_dx} px; the first end must not be above the second"
    )]
    Empty {
        /// The end that should be the least.
        least_dx: i32,
        /// The end that should be the most.
        most_dx: i32,
    },
    /// More shifts than the estimator counts.
    #[error(
        "{shifts} shifts are more than the {} that are counted; narrow the range",
        SearchRange::MOST_SHIFTS
    )]
    TooWide {
        /// How many shifts were asked for.
        shifts: u64,
    },
}

impl SearchRange {
    /// Most shifts of one range: as many as an index of 15 bits tells apart in any picture that a
    /// camera takes.
    pub const MOST_SHIFTS: usize = 16_384;

    /// The shifts from `least_dx` to `most_dx`, in pixels.
    ///
    /// # Errors
    /// [`BadRange`] if there is none, or more than [`Self::MOST_SHIFTS`].
    pub const fn new(least_dx: i32, most_dx: i32) -> Result<Self, BadRange> {
        if least_dx > most_dx {
            return Err(BadRange::Empty { least_dx, most_dx });
        }
        let shifts = most_dx.abs_diff(least_dx) as u64 + 1;
        if shifts > Self::MOST_SHIFTS as u64 {
            return Err(BadRange::TooWide { shifts });
        }
        Ok(Self { least_dx, most_dx })
    }

    /// The least shift, in pixels: the nearest surface that is found.
    #[must_use]
    pub const fn least_dx(self) -> i32 {
        self.least_dx
    }

    /// The largest shift, in pixels: the farthest surface that is found.
    #[must_use]
    pub const fn most_dx(self) -> i32 {
        self.most_dx
    }

    /// How many shifts there are, at least one.
    #[must_use]
    pub const fn shifts(self) -> usize {
        self.most_dx.abs_diff(self.least_dx) as usize + 1
    }

    /// The range that covers what a field of the vector pyramid sees: from the shift that one valid
    /// pixel in 200 lies below to the one that as many lie above, and beyond by 6 px and a sixth of
    /// the span on either side. `None` if nothing is valid.
    ///
    /// A mismatch here and there does not widen it; a thing that covers less than one pixel in 200
    /// and lies far before everything else may be missed.
    #[must_use]
    pub fn covering(field: &DisparityField) -> Option<Self> {
        Self::covering_in(field, &mut Vec::new())
    }

    /// The same in a buffer that is kept from field to field; what it holds means nothing.
    #[must_use]
    pub fn covering_in(field: &DisparityField, valid: &mut Vec<f32>) -> Option<Self> {
        const OUTLIERS: usize = 200;
        const MARGIN_PX: f32 = 6.0;
        const MARGIN_SPAN: f32 = 1.0 / 6.0;
        valid.clear();
        valid.reserve(field.dx.len());
        let shifts = field.dx.iter().zip(&field.validity);
        valid.extend(shifts.filter_map(|(dx, validity)| validity.is_valid().then_some(*dx)));
        if valid.is_empty() {
            return None;
        }
        let skipped = valid.len() / OUTLIERS;
        // Of two numbers only the ranks are asked: a selection, where a sort would take ten times as long.
        let most = valid.len() - 1 - skipped;
        let (below, &mut most, _) = valid.select_nth_unstable_by(most, f32::total_cmp);
        let least = if skipped < below.len() {
            *below.select_nth_unstable_by(skipped, f32::total_cmp).1
        } else {
            most
        };
        let margin_px = MARGIN_PX + MARGIN_SPAN * (most - least);
        let width = field.size().width;
        let range = Self {
            least_dx: (least - margin_px).floor() as i32,
            most_dx: (most + margin_px).ceil() as i32,
        };
        Some(range.within(width))
    }

    /// The range in pixels of half the size, both ends rounded towards nothing: what lies half a
    /// pixel further is found from its neighbour.
    pub(crate) const fn halved(self) -> Self {
        Self {
            least_dx: self.least_dx / 2,
            most_dx: self.most_dx / 2,
        }
    }

    /// The same range without shifts that lead out of an image of this width at every pixel. What
    /// lies wholly outside becomes the one shift nearest to it that does not.
    pub(crate) fn within(self, width: usize) -> Self {
        let reach = i32::try_from(width - 1).unwrap_or(i32::MAX);
        Self {
            least_dx: self.least_dx.clamp(-reach, reach),
            most_dx: self.most_dx.clamp(-reach, reach),
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// A range inside an image is the range; one that is wider becomes all that leads somewhere.
        #[test]
        fn a_range_stays_within_the_image(least in -90i32..90, most in -90i32..90, width in 1usize..60) {
            match SearchRange::new(least, most) {
                Err(refused) => {
                    prop_assert!(least > most);
                    prop_assert_eq!(refused, BadRange::Empty { least_dx: least, most_dx: most });
                }
                Ok(range) => {
                    let within = range.within(width);
                    prop_assert!(within.shifts() < 2 * width);
                    for dx in within.least_dx()..=within.most_dx() {
                        prop_assert!(dx.unsigned_abs() < width as u32);
                    }
                    if within != range {
                        prop_assert!(within.shifts() <= range.shifts());
                    }
                }
            }
        }
    }

    #[test]
    fn ends_of_the_number_line_are_too_wide() {
        assert_eq!(
            SearchRange::new(i32::MIN, i32::MAX),
            Err(BadRange::TooWide { shifts: 1 << 32 })
        );
    }
}
