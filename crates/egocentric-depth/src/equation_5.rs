/// Depth of a point relative to the fixation point, in metres, positive if it lies farther: the
/// paper's equation 5,
/// `z = D (4 + (b / D)^2) / (2 ((b / D) - 2 tan(delta / 2))) tan(delta / 2)`.
///
/// `fixation_m` is the distance `D` from the midpoint of the baseline to the fixation point; the
/// paper calls it `f`, and the formula is exact only under this reading. `angular_disparity_rad`
/// is the vergence angle at the fixation point less the vergence angle at the point. The absolute
/// depth is `D + z`.
///
/// It holds on the midline of a symmetrically verging head and errs elsewhere: with `b = 270` mm
/// and at 1 m by 7.5, 30 and 122 mm at azimuths of 5, 10 and 20 degrees. So it is here as
/// published, and [`triangulate`](crate::triangulate()) uses [`general_form`](crate::general_form()),
/// with which it agrees on the midline.
///
/// # Errors
/// [`OutOfDomain`] if the lines of sight do not meet in front of the head, or the head has no
/// fixation point.
pub fn equation_5(
    fixation_m: f64,
    baseline_m: f64,
    angular_disparity_rad: f64,
) -> Result<f64, OutOfDomain> {
    for length in [fixation_m, baseline_m] {
        if !(length.is_finite() && length > 0.0) {
            return Err(OutOfDomain::NoFixation {
                fixation_m,
                baseline_m,
            });
        }
    }
    let vergence_rad = 2.0 * (baseline_m / (2.0 * fixation_m)).atan();
    // A disparity that is no number falls out of the domain too.
    let meet = angular_disparity_rad < vergence_rad;
    if !meet {
        return Err(OutOfDomain::NotNearerThanInfinity {
            angular_disparity_rad,
            vergence_rad,
        });
    }
    if angular_disparity_rad <= vergence_rad - std::f64::consts::PI {
        return Err(OutOfDomain::NotInFront {
            angular_disparity_rad,
            vergence_rad,
        });
    }
    let slope = baseline_m / fixation_m;
    let tangent = (angular_disparity_rad / 2.0).tan();
    Ok(fixation_m * (4.0 + slope * slope) / (2.0 * (slope - 2.0 * tangent)) * tangent)
}

/// Why equation 5 has no answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum OutOfDomain {
    /// There is no fixation point to measure from.
    #[error(
        "eyes {baseline_m} m apart that fixate at {fixation_m} m: both lengths must be positive \
         and finite"
    )]
    NoFixation {
        /// Distance to the fixation point, in metres.
        fixation_m: f64,
        /// Distance between the eyes, in metres.
        baseline_m: f64,
    },
    /// The lines of sight are parallel or part.
    #[error(
        "an angular disparity of {angular_disparity_rad} rad reaches the vergence at the fixation \
         point, {vergence_rad} rad: the point is at infinity or beyond"
    )]
    NotNearerThanInfinity {
        /// The angular disparity asked for, in radians.
        angular_disparity_rad: f64,
        /// The vergence at the fixation point, in radians.
        vergence_rad: f64,
    },
    /// The lines of sight meet on the baseline or behind it.
    #[error(
        "an angular disparity of {angular_disparity_rad} rad with a vergence of {vergence_rad} rad \
         at the fixation point lies behind the eyes"
    )]
    NotInFront {
        /// The angular disparity asked for, in radians.
        angular_disparity_rad: f64,
        /// The vergence at the fixation point, in radians.
        vergence_rad: f64,
    },
}
