use std::f64::consts::TAU;
use std::marker::PhantomData;

/// The frame fixed to the head: origin midway between the eyes, x right along the baseline,
/// y down, z forward.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Head {}

/// The level frame of the observer: the head frame with the tilt undone, so that y points along
/// gravity and x and z span the ground. Its origin is the head's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Observer {}

/// A metric position in the frame `F`, in metres: x right, y down, z forward.
///
/// The frame is part of the type because a depth of a tilted head and a distance over the ground
/// are both "z" and must not be mistaken for one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position<F> {
    /// To the right, in metres.
    pub x_m: f64,
    /// Down, in metres.
    pub y_m: f64,
    /// Forward, in metres.
    pub z_m: f64,
    frame: PhantomData<F>,
}

impl<F> Position<F> {
    /// The position with these coordinates in metres.
    #[must_use]
    pub const fn new(x_m: f64, y_m: f64, z_m: f64) -> Self {
        Self {
            x_m,
            y_m,
            z_m,
            frame: PhantomData,
        }
    }

    /// The coordinates `[x, y, z]` in metres.
    #[must_use]
    pub const fn to_array(&self) -> [f64; 3] {
        [self.x_m, self.y_m, self.z_m]
    }

    /// The position with the coordinates `[x, y, z]` in metres.
    #[must_use]
    pub const fn from_array([x_m, y_m, z_m]: [f64; 3]) -> Self {
        Self::new(x_m, y_m, z_m)
    }

    /// The length of the line from the origin, in metres.
    #[must_use]
    pub fn range_m(&self) -> f64 {
        self.x_m.hypot(self.y_m).hypot(self.z_m)
    }
}

impl Position<Observer> {
    /// How far away over the ground, in metres, whatever the height.
    #[must_use]
    pub fn distance_m(&self) -> f64 {
        self.x_m.hypot(self.z_m)
    }

    /// The direction over the ground in radians, in `[0, 2 pi)`: 0 is right, `pi / 2` front,
    /// `pi` left.
    #[must_use]
    pub fn bearing_rad(&self) -> f64 {
        let bearing = self.z_m.atan2(self.x_m).rem_euclid(TAU);
        // A negative angle below half a step of f64 at 2 pi rounds up to the full circle.
        if bearing < TAU { bearing } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    #[test]
    fn front_is_a_right_angle_and_left_is_half_a_circle() {
        let bearing = |x, z| Position::<Observer>::new(x, 0.3, z).bearing_rad();
        assert_eq!(bearing(0.0, 2.0), FRAC_PI_2);
        assert_eq!(bearing(2.0, 0.0), 0.0);
        assert_eq!(bearing(-2.0, 0.0), PI);
        assert_eq!(bearing(0.0, -2.0), 3.0 * FRAC_PI_2);
        assert_eq!(bearing(1.0, -1e-300), 0.0);
    }
}
