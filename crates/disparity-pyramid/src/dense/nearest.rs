/// Adding and taking away 1.5 * 2^23 rounds to the nearest whole number.
pub(crate) const ROUNDER: f32 = 12_582_912.0;

/// The nearest whole number to one of at most six digits, without a call.
#[inline(always)]
pub(crate) fn nearest(value: f32) -> f32 {
    (value + ROUNDER) - ROUNDER
}
