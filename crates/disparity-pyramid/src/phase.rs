use std::f32::consts::{FRAC_PI_2, PI};

use pulp::Simd;

use crate::rough::Rough;

/// The angles of `x + j y`, in `[-pi, pi]`, to 4e-5 rad; 0 at the origin.
///
/// A minimax polynomial of the ratio, folded over the octants, without a branch, lane by lane, which
/// the standard library's `atan2` is not. Its error is a fortieth of a thousandth of a pixel of
/// disparity.
#[inline(always)]
pub(crate) fn angle<S: Rough>(simd: S, y: S::f32s, x: S::f32s) -> S::f32s {
    let (shorter, longer) = sides(simd, y, x);
    of_ratio(simd, y, x, simd.quotient(shorter, longer))
}

/// The shorter and the longer of two sides, this one never 0.
#[inline(always)]
fn sides<S: Simd>(simd: S, y: S::f32s, x: S::f32s) -> (S::f32s, S::f32s) {
    let (ax, ay) = (simd.abs_f32s(x), simd.abs_f32s(y));
    let longer = simd.max_f32s(simd.max_f32s(ax, ay), simd.splat_f32s(f32::MIN_POSITIVE));
    (simd.min_f32s(ax, ay), longer)
}

/// The angle of `x + j y` whose sides have this ratio.
#[inline(always)]
fn of_ratio<S: Simd>(simd: S, y: S::f32s, x: S::f32s, ratio: S::f32s) -> S::f32s {
    let zero = simd.splat_f32s(0.0);
    let (ax, ay) = (simd.abs_f32s(x), simd.abs_f32s(y));
    let polynomial = polynomial(
        simd,
        simd.mul_f32s(ratio, ratio),
        [0.999_866, -0.330_299_5, 0.180_141, -0.085_133, 0.020_835_1],
    );
    let octant = simd.mul_f32s(ratio, polynomial);
    let beyond = simd.sub_f32s(simd.splat_f32s(FRAC_PI_2), octant);
    let quadrant = simd.select_f32s(simd.less_than_f32s(ax, ay), beyond, octant);
    let behind = simd.sub_f32s(simd.splat_f32s(PI), quadrant);
    let half = simd.select_f32s(simd.less_than_f32s(x, zero), behind, quadrant);
    simd.select_f32s(simd.less_than_f32s(y, zero), simd.neg_f32s(half), half)
}

/// Angles brought into `[-pi, pi]` by whole turns.
#[inline(always)]
pub(crate) fn wrap<S: Simd>(simd: S, angle: S::f32s) -> S::f32s {
    const TURN: f32 = 2.0 * PI;
    // Adding and taking away 1.5 * 2^23 rounds to the nearest integer in two additions. Angles here
    // stay below a thousand turns.
    let rounder = simd.splat_f32s(12_582_912.0);
    let rounded = simd.mul_add_e_f32s(angle, simd.splat_f32s(1.0 / TURN), rounder);
    let turns = simd.sub_f32s(rounded, rounder);
    simd.mul_add_e_f32s(turns, simd.splat_f32s(-TURN), angle)
}

/// Cosines good to 2e-4 at every angle: wrapped, then the power series as far as the twelfth.
#[inline(always)]
pub(crate) fn cosine<S: Simd>(simd: S, angle: S::f32s) -> S::f32s {
    let angle = wrap(simd, angle);
    polynomial(
        simd,
        simd.mul_f32s(angle, angle),
        [
            1.0,
            -1.0 / 2.0,
            1.0 / 24.0,
            -1.0 / 720.0,
            1.0 / 40_320.0,
            -1.0 / 3_628_800.0,
            1.0 / 479_001_600.0,
        ],
    )
}

/// `c_0 + c_1 x + c_2 x^2 + ...`
#[inline(always)]
fn polynomial<S: Simd, const N: usize>(simd: S, x: S::f32s, coefficients: [f32; N]) -> S::f32s {
    let mut sum = simd.splat_f32s(coefficients[N - 1]);
    for k in (0..N - 1).rev() {
        sum = simd.mul_add_e_f32s(sum, x, simd.splat_f32s(coefficients[k]));
    }
    sum
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use pulp::Scalar;

    use super::*;

    proptest! {
        #[test]
        fn the_angle_is_the_standard_library_s(x in -10.0f32..10.0, y in -10.0f32..10.0) {
            prop_assert!((angle(Scalar, y, x) - y.atan2(x)).abs() < 4e-5);
        }

        #[test]
        fn wrapping_takes_whole_turns(start in -3000.0f32..3000.0) {
            let wrapped = wrap(Scalar, start);
            // Near 3000 rad one step of f32 is 2.4e-4.
            prop_assert!(wrapped.abs() <= PI + 1e-3);
            let turns = (start - wrapped) / (2.0 * PI);
            prop_assert!((turns - turns.round()).abs() < 1e-3);
        }
    }

    #[test]
    fn the_axes_and_the_origin() {
        assert_eq!(angle(Scalar, 0.0, 0.0), 0.0);
        assert_eq!(angle(Scalar, 0.0, 1.0), 0.0);
        assert_eq!(angle(Scalar, 1.0, 0.0), FRAC_PI_2);
        assert_eq!(angle(Scalar, 0.0, -1.0), PI);
        assert_eq!(angle(Scalar, -1.0, 0.0), -FRAC_PI_2);
    }

    /// The cosine is the cosine, to what its comment says.
    #[test]
    fn the_cosine_is_the_cosine() {
        for step in -400..400 {
            let angle = step as f32 * 0.02;
            assert!(
                (cosine(Scalar, angle) - angle.cos()).abs() < 2e-4,
                "at {angle}"
            );
        }
    }
}
