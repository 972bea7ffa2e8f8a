/// Adding and taking away 1.5 * 2^23 rounds to the nearest whole number.
pub(crate) const ROUNDER: f32 = 12_582_912.0;

/// The nearest whole number to one of at most six digits, without a call.
#[inline(always)]
pub(crate) fn nearest(value: f32) -> f32 {
    (value + ROUNDER) - ROUNDER
}

/// The nearest whole number to one of at most six digits as a place in a row: beyond the end of every
/// row if it is negative or no number.
#[inline(always)]
pub(crate) fn place(value: f32) -> usize {
    // The lower bits of the sum count up from those of the rounder itself.
    (value + ROUNDER).to_bits().wrapping_sub(ROUNDER.to_bits()) as usize
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn places_are_nearest(value in -99_999.0f32..99_999.0) {
            let whole = nearest(value);
            prop_assert!((whole - value).abs() <= 0.5);
            if whole >= 0.0 {
                prop_assert_eq!(place(value), whole as usize);
            } else {
                prop_assert!(place(value) > 99_999);
            }
            prop_assert!(place(f32::NAN) > 99_999);
        }
    }
}
