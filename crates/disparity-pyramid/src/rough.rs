use pulp::{Scalar, Simd};

/// Quotients and roots as exact as what they are for, where a machine has them at less than the price of
/// exact ones: AVX-512 does, and its exact ones take a seventh of a warp's time.
///
/// What a machine does not have is exact.
pub(crate) trait Rough: Simd {
    /// `a / b` to a unit or two in the last place, for `b` of ordinary size.
    #[inline(always)]
    fn quotient(self, a: Self::f32s, b: Self::f32s) -> Self::f32s {
        self.div_f32s(a, b)
    }

    /// `1 / x` to a ten-thousandth of it: good enough for a weight.
    #[inline(always)]
    fn rough_reciprocal(self, x: Self::f32s) -> Self::f32s {
        self.div_f32s(self.splat_f32s(1.0), x)
    }

    /// The square root of `x` to a ten-thousandth of it, for `x > 0`: good enough for a weight.
    #[inline(always)]
    fn rough_root(self, x: Self::f32s) -> Self::f32s {
        self.sqrt_f32s(x)
    }

    /// One over the square root of `x` to a ten-thousandth of it, for `x > 0`.
    #[inline(always)]
    fn rough_inverse_root(self, x: Self::f32s) -> Self::f32s {
        self.div_f32s(self.splat_f32s(1.0), self.sqrt_f32s(x))
    }
}

impl Rough for Scalar {}

#[cfg(target_arch = "x86_64")]
impl Rough for pulp::x86::V3 {}

#[cfg(target_arch = "x86_64")]
impl Rough for pulp::x86::V4 {
    #[inline(always)]
    fn quotient(self, a: Self::f32s, b: Self::f32s) -> Self::f32s {
        // A step of Newton's doubles the fourteen bits.
        let reciprocal = self.rough_reciprocal(b);
        let quotient = self.mul_f32s(a, reciprocal);
        let missing = self.negate_mul_add_e_f32s(quotient, b, a);
        self.mul_add_e_f32s(missing, reciprocal, quotient)
    }

    #[inline(always)]
    fn rough_reciprocal(self, x: Self::f32s) -> Self::f32s {
        pulp::cast(self.avx512f._mm512_rcp14_ps(pulp::cast(x)))
    }

    #[inline(always)]
    fn rough_root(self, x: Self::f32s) -> Self::f32s {
        self.mul_f32s(x, self.rough_inverse_root(x))
    }

    #[inline(always)]
    fn rough_inverse_root(self, x: Self::f32s) -> Self::f32s {
        pulp::cast(self.avx512f._mm512_rsqrt14_ps(pulp::cast(x)))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use pulp::{Arch, NullaryFnOnce};

    use super::*;

    /// `a / b`, `1 / b`, the root of `b` and one over it in every lane.
    struct Compute<S>(S, f32, f32);

    impl<S: Rough> NullaryFnOnce for Compute<S> {
        type Output = [f32; 4];

        #[inline(always)]
        fn call(self) -> [f32; 4] {
            let Self(simd, a, b) = self;
            let (a, b) = (simd.splat_f32s(a), simd.splat_f32s(b));
            let first = |values: S::f32s| {
                let mut lanes = [0.0; 16];
                S::as_mut_simd_f32s(&mut lanes).0[0] = values;
                lanes[0]
            };
            let results = [
                simd.quotient(a, b),
                simd.rough_reciprocal(b),
                simd.rough_root(b),
                simd.rough_inverse_root(b),
            ];
            results.map(first)
        }
    }

    proptest! {
        #[test]
        fn are_near_the_exact_ones(a in -10.0f32..10.0, exponent in -12.0f32..3.0) {
            let b = 10.0f32.powf(exponent);
            let [quotient, reciprocal, root, inverse] = match Arch::new() {
                #[cfg(target_arch = "x86_64")]
                Arch::V4(v4) => v4.vectorize(Compute(v4, a, b)),
                #[cfg(target_arch = "x86_64")]
                Arch::V3(v3) => v3.vectorize(Compute(v3, a, b)),
                _ => Compute(Scalar, a, b).call(),
            };
            let off = |value: f32, exact: f32| (value / exact - 1.0).abs();
            prop_assert!(a == 0.0 || off(quotient, a / b) < 3e-7);
            prop_assert!(off(reciprocal, 1.0 / b) < 1e-4);
            prop_assert!(off(root, b.sqrt()) < 1e-4);
            prop_assert!(off(inverse, 1.0 / b.sqrt()) < 1e-4);
        }
    }
}
