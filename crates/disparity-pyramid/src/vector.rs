use pulp::Simd;

/// As many numbers as a vector holds, from `start` on.
///
/// # Panics
/// If there are fewer.
#[inline(always)]
pub(crate) fn vector<S: Simd>(_simd: S, numbers: &[f32], start: usize) -> S::f32s {
    S::as_simd_f32s(&numbers[start..start + S::F32_LANES]).0[0]
}

/// Writes a vector's values from `start` on. The library's own partial store is a call, even for
/// whole vectors.
///
/// # Panics
/// If there is room for fewer.
#[inline(always)]
pub(crate) fn store<S: Simd>(_simd: S, numbers: &mut [f32], start: usize, values: S::f32s) {
    S::as_mut_simd_f32s(&mut numbers[start..start + S::F32_LANES]).0[0] = values;
}
