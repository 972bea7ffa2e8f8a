use crate::general_form::tangent_of_sum;
use crate::rotation::cross;
use crate::{Head, Position, RigDrift, StereoRig};

/// A step along the line of sight, as a part of the depth, over which the shift is taken for linear.
const STEP: f64 = 1e-5;

impl StereoRig {
    /// How uncertain the depth of a point is, in metres, where its horizontal disparity is
    /// uncertain by `disparity_sigma_px`: one standard deviation, to first order.
    ///
    /// What is uncertain of the rig itself ([`StereoRig::sigma`]) counts as a shift of its own
    /// ([`StereoRig::pose_sigma_px`]), independent of the other.
    ///
    /// A parallel rig has `sigma_Z = Z^2 sigma_d / (b f)`. For eyes that pan
    /// `Z = b / (tan left - tan right)`, so that `dZ = Z^2 / b` times the change of the tangent of
    /// the right azimuth, which is `(1 + tan^2) / (1 + x^2) / f` a pixel with `x` the point's
    /// normalised abscissa in the right eye. For all others it is the inverse of how fast the right
    /// pixel moves as the point goes along the left line of sight. The result is infinite where the
    /// right eye cannot see the point.
    ///
    /// `disparity_sigma_px` is the caller's: the measured error of the estimator in use, or, pixel
    /// by pixel, the noise that the covariance of a disparity field tells of.
    #[must_use]
    pub fn depth_sigma_m(&self, point: Position<Head>, disparity_sigma_px: f64) -> f64 {
        let shift_px = if self.sigma() == RigDrift::default() {
            disparity_sigma_px
        } else {
            disparity_sigma_px.hypot(self.pose_sigma_px(point))
        };
        let sigma_m = self.depth_per_px(point) * shift_px;
        if point.z_m > 0.0 && sigma_m.is_finite() {
            sigma_m
        } else {
            f64::INFINITY
        }
    }

    /// How far the depth of a point moves if its right pixel moves by one along the row, in metres;
    /// NaN where the right eye cannot see it.
    #[must_use]
    pub fn depth_per_px(&self, point: Position<Head>) -> f64 {
        if self.only_pans() {
            let azimuth = (point.x_m - self.baseline_m() / 2.0) / point.z_m;
            let abscissa = tangent_of_sum(azimuth, -self.pan_rad().right.tan());
            let (focal_px, _) = self.intrinsics().right.focal_px;
            let tangent_per_px = (1.0 + azimuth * azimuth) / (1.0 + abscissa * abscissa) / focal_px;
            return point.z_m * point.z_m / self.baseline_m() * tangent_per_px;
        }
        let eyes = self.eyes();
        let (from, to) = (eyes.left.centre.to_array(), point.to_array());
        let column = |stretch: f64| {
            let along = std::array::from_fn(|i| from[i] + stretch * (to[i] - from[i]));
            eyes.right
                .project(Position::from_array(along))
                .map_or(f64::NAN, |(u, _)| u)
        };
        (2.0 * STEP * point.z_m / (column(1.0 + STEP) - column(1.0 - STEP))).abs()
    }

    /// How far the right pixel of a point lies from where this rig expects it, along the row: one
    /// standard deviation in pixels, to first order, of what is uncertain of the rig
    /// ([`StereoRig::sigma`]). It is common to all pixels of a look, so no mean over pixels takes it
    /// away.
    #[must_use]
    pub fn pose_sigma_px(&self, point: Position<Head>) -> f64 {
        let right = self.eyes().right;
        let seen = right.coordinates(point);
        let [x, _, z] = seen;
        let (focal_px, _) = right.intrinsics.focal_px;
        let column = |[dx, _, dz]: [f64; 3]| focal_px * (dx / z - x * dz / (z * z));
        // A turn of the eye moves what it sees by the opposite turn, a step by the opposite step.
        let turned = |axis: [f64; 3]| column(cross(seen, axis));
        let stepped = |step: [f64; 3]| column(right.rotation.apply_inverse(step));
        let baseline_m = self.baseline_m();
        let slopes = [
            turned([1.0, 0.0, 0.0]),
            turned([0.0, 1.0, 0.0]),
            turned([0.0, 0.0, 1.0]),
            stepped([0.0, -baseline_m, 0.0]),
            stepped([0.0, 0.0, -baseline_m]),
        ];
        let terms = slopes.into_iter().zip(self.sigma().to_array());
        // What is known exactly adds nothing, whatever its slope.
        let square: f64 = terms
            .filter(|(_, sigma)| *sigma > 0.0)
            .map(|(slope, sigma)| (slope * sigma).powi(2))
            .sum();
        // An empty sum is -0, and no deviation is negative.
        square.abs().sqrt()
    }
}
