use v1_gabor::Binocular;

/// Depth and lateral position `(Z, X)` in metres, in the head frame, of the point that the left
/// and the right eye see at these azimuths: the general form for eyes that pan.
///
/// An azimuth is an eye's pan plus the angle of the pixel's column, `pan + atan((u - cx) / f)`,
/// positive toward +x. With `nu = left - right` and `mu = (left + right) / 2`,
/// `Z = (b / 2) (cos 2 mu + cos nu) / sin nu` and `X = (b / 2) sin 2 mu / sin nu`. For
/// `nu <= 0` the lines of sight part, and for an azimuth beyond a right angle one of them points
/// backwards: both are unknown.
///
/// The row does not enter: an eye that turns about the vertical sees every point of a vertical
/// plane through its centre at one azimuth.
#[must_use]
pub fn general_form(baseline_m: f64, azimuth_rad: Binocular<f64>) -> Option<(f64, f64)> {
    let Binocular { left, right } = azimuth_rad;
    let nu = left - right;
    let twice_mu = left + right;
    let right_angle = std::f64::consts::FRAC_PI_2;
    let meet = nu > 0.0 && left.abs() < right_angle && right.abs() < right_angle;
    meet.then(|| {
        let half = baseline_m / 2.0 / nu.sin();
        (half * (twice_mu.cos() + nu.cos()), half * twice_mu.sin())
    })
}

/// The same depth from the tangents of the azimuths: `Z = b / (tan left - tan right)`, NaN where
/// the lines of sight part.
///
/// The numerator of the general form is `2 cos left cos right` and its denominator the sine of a
/// difference, so their quotient is a difference of tangents. Tangents add without a call to
/// trigonometry ([`tangent_of_sum`]), which is what a pixel can afford.
pub(crate) fn depth_of_tangents(baseline_m: f64, tangent: Binocular<f64>) -> f64 {
    let parting = tangent.left - tangent.right;
    if parting > 0.0 {
        baseline_m / parting
    } else {
        f64::NAN
    }
}

/// `tan(a + b)` from `tan a` and `tan b`, NaN where the sum is not within a right angle: a line
/// of sight that does not point forward.
pub(crate) fn tangent_of_sum(tan_a: f64, tan_b: f64) -> f64 {
    let cosine = 1.0 - tan_a * tan_b;
    if cosine > 0.0 {
        (tan_a + tan_b) / cosine
    } else {
        f64::NAN
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// The fast form by tangents is the general form.
        #[test]
        fn tangents_give_the_general_form(
            pan in -0.7f64..0.7,
            vergence in 0.0f64..0.5,
            left in -0.8f64..0.8,
            nu in 1e-3f64..1.0,
        ) {
            let pans = Binocular { left: pan + vergence / 2.0, right: pan - vergence / 2.0 };
            let azimuth = Binocular { left, right: left - nu };
            prop_assume!(azimuth.right > -1.4);
            let tangent = Binocular {
                left: tangent_of_sum(pans.left.tan(), (azimuth.left - pans.left).tan()),
                right: tangent_of_sum(pans.right.tan(), (azimuth.right - pans.right).tan()),
            };
            let in_camera = (azimuth.left - pans.left).abs().max((azimuth.right - pans.right).abs());
            prop_assume!(in_camera < 1.5);
            let (slow, _) = general_form(0.27, azimuth).expect("the azimuths meet");
            let fast = depth_of_tangents(0.27, tangent);
            // Both take the difference of two numbers up to 14 / 1e-3 times as large as itself.
            prop_assert!((fast / slow - 1.0).abs() < 1e-9, "{} against {}", fast, slow);
        }

        /// As the vergence of a symmetric pair tends to 0, the general form tends to `f b / d`.
        #[test]
        fn without_vergence_it_is_the_rectified_form(
            x in -0.5f64..0.5,
            shift in 0.01f64..0.2,
            vergence in 0.0f64..1e-9,
        ) {
            let azimuth = Binocular {
                left: vergence / 2.0 + x.atan(),
                right: -vergence / 2.0 + (x - shift).atan(),
            };
            let (depth, lateral) = general_form(0.27, azimuth).expect("the azimuths meet");
            let parallel = 0.27 / shift;
            // d(1 / Z) = vergence (1 + x^2) / b, relative to shift / b: at most 1.25e-7.
            prop_assert!((depth / parallel - 1.0).abs() < 2e-7);
            prop_assert!((lateral - (x * parallel - 0.135)).abs() < 2e-6 * parallel);
        }
    }

    #[test]
    fn parting_lines_of_sight_are_unknown() {
        for (left, right) in [(0.1, 0.1), (0.1, 0.2), (1.6, 0.0), (0.0, -1.6)] {
            assert_eq!(general_form(0.27, Binocular { left, right }), None);
        }
    }
}
