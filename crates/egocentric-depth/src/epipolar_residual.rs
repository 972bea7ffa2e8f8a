use v1_gabor::Binocular;

use crate::rotation::{Rotation, cross, dot};
use crate::{CameraIntrinsics, Lens, RigDrift, StereoRig};

/// Two eyes as the epipolar constraint knows them: turns and a direction, no length.
pub(crate) struct EpipolarGeometry {
    pub(crate) intrinsics: Binocular<CameraIntrinsics>,
    pub(crate) lenses: Binocular<Lens>,
    pub(crate) rotation: Binocular<Rotation>,
    /// From the left to the right centre in the head frame, in baselines.
    pub(crate) baseline: [f64; 3],
}

/// How badly a match fits two eyes, and how that changes with the drift of the right one.
pub(crate) struct EpipolarResidual {
    /// The Sampson distance in pixels, signed.
    pub(crate) sampson_px: f64,
    /// Its derivative by pitch, yaw, roll, down and forward.
    pub(crate) gradient: [f64; 5],
    /// How far below the epipolar line the right pixel lies, in pixels.
    pub(crate) vertical_px: f64,
}

impl StereoRig {
    /// How far below the epipolar line the right pixel of a match lies, in pixels: 0 if this rig can
    /// see one point at both. `None` where the constraint says nothing.
    #[must_use]
    pub fn misalignment_px(&self, pixels: Binocular<(f64, f64)>) -> Option<f64> {
        EpipolarGeometry::of(self, &RigDrift::default())
            .residual(pixels)
            .map(|residual| residual.vertical_px)
    }
}

impl EpipolarGeometry {
    /// The eyes of a rig whose right one has drifted.
    pub(crate) fn of(rig: &StereoRig, drift: &RigDrift) -> Self {
        let (down, forward) = rig.slip();
        Self {
            intrinsics: rig.intrinsics(),
            lenses: rig.lenses(),
            rotation: Binocular {
                left: rig.attitude().left.rotation(),
                right: drift.right_rotation(rig),
            },
            baseline: [1.0, down + drift.down, forward + drift.forward],
        }
    }

    /// The residual of the match of two pixels; `None` where the constraint says nothing, as it
    /// does for a pixel that shows the other eye.
    ///
    /// With lines of sight `d` in the head frame the constraint is the triple product
    /// `t . (d_left x d_right) = 0`. The Sampson distance divides it by the length of its gradient
    /// over the four pixel coordinates, which makes it, to first order, the distance in pixels to
    /// the nearest match that fits. The gradient by the drift holds that length fixed: the
    /// neglected term is the residual times a small change, and vanishes with the residual.
    pub(crate) fn residual(&self, pixels: Binocular<(f64, f64)>) -> Option<EpipolarResidual> {
        let eye = self.intrinsics;
        let (xl, yl) = self
            .lenses
            .left
            .undistort(eye.left.normalised(pixels.left))?;
        let (xr, yr) = self
            .lenses
            .right
            .undistort(eye.right.normalised(pixels.right))?;
        let sight = Binocular {
            left: self.rotation.left.apply([xl, yl, 1.0]),
            right: self.rotation.right.apply([xr, yr, 1.0]),
        };
        let normal = cross(sight.left, sight.right);
        let triple = dot(self.baseline, normal);

        // The epipolar lines in either eye's own axes: the gradients by the normalised pixels.
        let line_right = self
            .rotation
            .right
            .apply_inverse(cross(self.baseline, sight.left));
        let line_left = self
            .rotation
            .left
            .apply_inverse(cross(sight.right, self.baseline));
        let length = {
            let (fx_l, fy_l) = eye.left.focal_px;
            let (fx_r, fy_r) = eye.right.focal_px;
            let in_left = (line_left[0] / fx_l).hypot(line_left[1] / fy_l);
            let in_right = (line_right[0] / fx_r).hypot(line_right[1] / fy_r);
            in_left.hypot(in_right)
        };

        // A turn by w in the right eye's axes moves its line of sight by w x r.
        let by_turn = cross([xr, yr, 1.0], line_right);
        let by_drift = [by_turn[0], by_turn[1], by_turn[2], normal[1], normal[2]];
        let residual = EpipolarResidual {
            sampson_px: triple / length,
            gradient: by_drift.map(|derivative| derivative / length),
            vertical_px: triple / line_right[1] * eye.right.focal_px.1,
        };
        (residual.sampson_px.is_finite() && residual.vertical_px.is_finite()).then_some(residual)
    }
}
