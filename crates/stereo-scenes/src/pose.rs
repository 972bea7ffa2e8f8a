use egocentric_depth::Rotation;

use crate::vector::Vector;

/// A place in the room and three directions there: right, down and forward, orthonormal.
///
/// This is the one file that knows how the room frame (z up) and the frames of observer, head and
/// eye (y down, z forward) lie to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pose {
    pub(crate) origin: Vector,
    right: Vector,
    down: Vector,
    pub(crate) forward: Vector,
}

impl Pose {
    /// The observer frame: upright, facing along the ground; heading 0 is the room's y axis.
    pub(crate) fn level(origin: Vector, heading_rad: f64) -> Self {
        let (sin, cos) = heading_rad.sin_cos();
        Self {
            origin,
            right: Vector::new(cos, -sin, 0.0),
            down: Vector::new(0.0, 0.0, -1.0),
            forward: Vector::new(sin, cos, 0.0),
        }
    }

    /// Turned about its own x axis; positive looks up.
    pub(crate) fn tilted(self, tilt_rad: f64) -> Self {
        let (sin, cos) = tilt_rad.sin_cos();
        Self {
            down: self.down * cos + self.forward * sin,
            forward: self.forward * cos - self.down * sin,
            ..self
        }
    }

    /// Turned about its own y axis; positive looks toward its own +x.
    pub(crate) fn panned(self, pan_rad: f64) -> Self {
        let (sin, cos) = pan_rad.sin_cos();
        Self {
            right: self.right * cos - self.forward * sin,
            forward: self.forward * cos + self.right * sin,
            ..self
        }
    }

    /// Moved by a step of its own axes, then turned by a rotation of them.
    pub(crate) fn placed(self, step: [f64; 3], rotation: &Rotation) -> Self {
        let [x, y, z] = step;
        let turned = |axis| Vector::from(rotation.apply(axis));
        Self {
            origin: self.origin + self.direction(Vector::new(x, y, z)),
            right: self.direction(turned([1.0, 0.0, 0.0])),
            down: self.direction(turned([0.0, 1.0, 0.0])),
            forward: self.direction(turned([0.0, 0.0, 1.0])),
        }
    }

    /// Moved along its own x axis.
    pub(crate) fn shifted(self, right_m: f64) -> Self {
        Self {
            origin: self.origin + self.right * right_m,
            ..self
        }
    }

    /// A point of the room in this frame.
    pub(crate) fn coordinates(&self, point: Vector) -> Vector {
        let v = point - self.origin;
        Vector::new(self.right.dot(v), self.down.dot(v), self.forward.dot(v))
    }

    /// A direction of this frame in the room.
    pub(crate) fn direction(&self, v: Vector) -> Vector {
        self.right * v.x + self.down * v.y + self.forward * v.z
    }
}
