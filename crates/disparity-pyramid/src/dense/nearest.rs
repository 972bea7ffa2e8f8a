/// The nearest whole number to one of at most six digits, without a call: adding and taking away
/// 1.5 * 2^23 rounds.
#[inline(always)]
pub(crate) fn nearest(value: f32) -> f32 {
    const ROUNDER: f32 = 12_582_912.0;
    (value + ROUNDER) - ROUNDER
}
