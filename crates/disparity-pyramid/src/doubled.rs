use pulp::Simd;

use crate::phase::cosine;
use crate::rough::Rough;
use crate::vector::{store, vector};

/// Two vectors that go through the same arithmetic side by side.
///
/// A fit is a long chain of steps, each of which waits for the one before: two of them at a time keep
/// the processor busy where one leaves it idle for a third of the time.
#[derive(Clone, Copy)]
pub(crate) struct Doubled<S: Simd>(pub(crate) [S::f32s; 2]);

/// A choice for each lane of a [`Doubled`].
#[derive(Clone, Copy)]
pub(crate) struct Choice<S: Simd>([S::m32s; 2]);

impl<S: Rough> Doubled<S> {
    #[inline(always)]
    pub(crate) fn splat(simd: S, value: f32) -> Self {
        Self([simd.splat_f32s(value); 2])
    }

    #[inline(always)]
    pub(crate) fn load(simd: S, numbers: &[f32], start: usize) -> Self {
        Self([
            vector(simd, numbers, start),
            vector(simd, numbers, start + S::F32_LANES),
        ])
    }

    #[inline(always)]
    pub(crate) fn store(self, simd: S, numbers: &mut [f32], start: usize) {
        store(simd, numbers, start, self.0[0]);
        store(simd, numbers, start + S::F32_LANES, self.0[1]);
    }

    #[inline(always)]
    pub(crate) fn add(self, simd: S, other: Self) -> Self {
        Self([
            simd.add_f32s(self.0[0], other.0[0]),
            simd.add_f32s(self.0[1], other.0[1]),
        ])
    }

    #[inline(always)]
    pub(crate) fn sub(self, simd: S, other: Self) -> Self {
        Self([
            simd.sub_f32s(self.0[0], other.0[0]),
            simd.sub_f32s(self.0[1], other.0[1]),
        ])
    }

    #[inline(always)]
    pub(crate) fn mul(self, simd: S, other: Self) -> Self {
        Self([
            simd.mul_f32s(self.0[0], other.0[0]),
            simd.mul_f32s(self.0[1], other.0[1]),
        ])
    }

    /// `self * factor + summand`.
    #[inline(always)]
    pub(crate) fn mul_add(self, simd: S, factor: Self, summand: Self) -> Self {
        Self([
            simd.mul_add_e_f32s(self.0[0], factor.0[0], summand.0[0]),
            simd.mul_add_e_f32s(self.0[1], factor.0[1], summand.0[1]),
        ])
    }

    /// `summand - self * factor`.
    #[inline(always)]
    pub(crate) fn negate_mul_add(self, simd: S, factor: Self, summand: Self) -> Self {
        Self([
            simd.negate_mul_add_e_f32s(self.0[0], factor.0[0], summand.0[0]),
            simd.negate_mul_add_e_f32s(self.0[1], factor.0[1], summand.0[1]),
        ])
    }

    #[inline(always)]
    pub(crate) fn abs(self, simd: S) -> Self {
        Self([simd.abs_f32s(self.0[0]), simd.abs_f32s(self.0[1])])
    }

    #[inline(always)]
    pub(crate) fn neg(self, simd: S) -> Self {
        Self([simd.neg_f32s(self.0[0]), simd.neg_f32s(self.0[1])])
    }

    #[inline(always)]
    pub(crate) fn max(self, simd: S, other: Self) -> Self {
        Self([
            simd.max_f32s(self.0[0], other.0[0]),
            simd.max_f32s(self.0[1], other.0[1]),
        ])
    }

    #[inline(always)]
    pub(crate) fn sqrt(self, simd: S) -> Self {
        Self([simd.sqrt_f32s(self.0[0]), simd.sqrt_f32s(self.0[1])])
    }

    #[inline(always)]
    pub(crate) fn quotient(self, simd: S, other: Self) -> Self {
        Self([
            simd.quotient(self.0[0], other.0[0]),
            simd.quotient(self.0[1], other.0[1]),
        ])
    }

    #[inline(always)]
    pub(crate) fn rough_reciprocal(self, simd: S) -> Self {
        Self([
            simd.rough_reciprocal(self.0[0]),
            simd.rough_reciprocal(self.0[1]),
        ])
    }

    #[inline(always)]
    pub(crate) fn cosine(self, simd: S) -> Self {
        Self([cosine(simd, self.0[0]), cosine(simd, self.0[1])])
    }

    #[inline(always)]
    pub(crate) fn less_than(self, simd: S, other: Self) -> Choice<S> {
        Choice([
            simd.less_than_f32s(self.0[0], other.0[0]),
            simd.less_than_f32s(self.0[1], other.0[1]),
        ])
    }

    #[inline(always)]
    pub(crate) fn at_most(self, simd: S, other: Self) -> Choice<S> {
        Choice([
            simd.less_than_or_equal_f32s(self.0[0], other.0[0]),
            simd.less_than_or_equal_f32s(self.0[1], other.0[1]),
        ])
    }
}

impl<S: Simd> Choice<S> {
    #[inline(always)]
    pub(crate) fn select(self, simd: S, yes: Doubled<S>, no: Doubled<S>) -> Doubled<S> {
        Doubled([
            simd.select_f32s(self.0[0], yes.0[0], no.0[0]),
            simd.select_f32s(self.0[1], yes.0[1], no.0[1]),
        ])
    }
}
