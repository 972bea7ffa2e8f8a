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
    /// pixel moves along its epipolar line as the point goes along the left line of sight. The result is infinite where the
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

    /// How far the depth of a point moves if its right pixel moves by one along its epipolar line, in
    /// metres; NaN where the right eye cannot see it.
    ///
    /// Eyes that only pan count along the row, from which the line leans but little.
    #[must_use]
    pub fn depth_per_px(&self, point: Position<Head>) -> f64 {
        if self.only_pans() {
            let azimuth = (point.x_m - self.baseline_m() / 2.0) / point.z_m;
            let abscissa = tangent_of_sum(azimuth, -self.pan_rad().right.tan());
            let (focal_px, _) = self.intrinsics().right.focal_px;
            let tangent_per_px = (1.0 + azimuth * azimuth) / (1.0 + abscissa * abscissa) / focal_px;
            return point.z_m * point.z_m / self.baseline_m() * tangent_per_px;
        }
        let (across, down) = self.step_of_depth(point);
        2.0 * STEP * point.z_m / across.hypot(down)
    }

    /// How the right pixel moves as the point goes along the left line of sight, from a [`STEP`] before
    /// to one behind it; NaN where the right eye does not see it.
    fn step_of_depth(&self, point: Position<Head>) -> (f64, f64) {
        let eyes = self.eyes();
        let (from, to) = (eyes.left.centre.to_array(), point.to_array());
        let seen = |stretch: f64| {
            let along = std::array::from_fn(|i| from[i] + stretch * (to[i] - from[i]));
            eyes.right
                .project(Position::from_array(along))
                .unwrap_or((f64::NAN, f64::NAN))
        };
        let (near, far) = (seen(1.0 - STEP), seen(1.0 + STEP));
        (far.0 - near.0, far.1 - near.1)
    }

    /// How far the right pixel of a point lies from where this rig expects it, along its epipolar line:
    /// one standard deviation in pixels, to first order, of what is uncertain of the rig
    /// ([`StereoRig::sigma`]). It is common to all pixels of a look, so no mean over pixels takes it
    /// away.
    #[must_use]
    pub fn pose_sigma_px(&self, point: Position<Head>) -> f64 {
        let (across, down) = if self.only_pans() {
            (1.0, 0.0)
        } else {
            let (across, down) = self.step_of_depth(point);
            let length = across.hypot(down);
            (across / length, down / length)
        };
        let right = self.eyes().right;
        let seen = right.coordinates(point);
        let [x, y, z] = seen;
        let (fx, fy) = right.intrinsics.focal_px;
        let along = |[dx, dy, dz]: [f64; 3]| {
            let (du, dv) = (dx / z - x * dz / (z * z), dy / z - y * dz / (z * z));
            across * fx * du + down * fy * dv
        };
        // A turn of the eye moves what it sees by the opposite turn, a step by the opposite step.
        let turned = |axis: [f64; 3]| along(cross(seen, axis));
        let stepped = |step: [f64; 3]| along(right.rotation.apply_inverse(step));
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
