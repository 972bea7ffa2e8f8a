use crate::Rotation;

/// How the right camera stands to the left one, as calibration files of the field have it:
/// `x_right = rotation * x_left + translation`, in camera coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RelativePose {
    /// Turns a direction of the left camera's frame into one of the right camera's.
    pub rotation: Rotation,
    /// Where the left camera's centre is in the right camera's frame, in metres.
    pub translation_m: [f64; 3],
}

impl RelativePose {
    /// The same with the cameras exchanged: how the left one stands to the right one.
    #[must_use]
    pub fn inverse(&self) -> Self {
        Self {
            rotation: self.rotation.inverse(),
            translation_m: self
                .rotation
                .apply_inverse(self.translation_m)
                .map(|metres| 0.0 - metres),
        }
    }
}
