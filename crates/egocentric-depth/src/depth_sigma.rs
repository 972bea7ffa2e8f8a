use crate::general_form::tangent_of_sum;
use crate::{Head, Position, StereoRig};

impl StereoRig {
    /// How uncertain the depth of a point is, in metres, where its horizontal disparity is
    /// uncertain by `disparity_sigma_px`: one standard deviation, to first order.
    ///
    /// A parallel rig has `sigma_Z = Z^2 sigma_d / (b f)`. In general
    /// `Z = b / (tan left - tan right)`, so that `dZ = Z^2 / b` times the change of the tangent of
    /// the right azimuth, which is `(1 + tan^2) / (1 + x^2) / f` a pixel with `x` the point's
    /// normalised abscissa in the right eye. The result is infinite where the right eye cannot
    /// see the point.
    ///
    /// `disparity_sigma_px` is the caller's: the measured error of the estimator in use, or, pixel
    /// by pixel, the noise that the covariance of a disparity field tells of.
    #[must_use]
    pub fn depth_sigma_m(&self, point: Position<Head>, disparity_sigma_px: f64) -> f64 {
        let azimuth = (point.x_m - self.baseline_m() / 2.0) / point.z_m;
        let abscissa = tangent_of_sum(azimuth, -self.pan_rad().right.tan());
        let (focal_px, _) = self.intrinsics().right.focal_px;
        let tangent_per_px = (1.0 + azimuth * azimuth) / (1.0 + abscissa * abscissa) / focal_px;
        let sigma_m =
            point.z_m * point.z_m / self.baseline_m() * tangent_per_px * disparity_sigma_px;
        if point.z_m > 0.0 && sigma_m.is_finite() {
            sigma_m
        } else {
            f64::INFINITY
        }
    }
}
