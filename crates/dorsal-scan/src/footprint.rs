use stereo_scenes::Shape;

/// The ground that a body covers, in the room's x and y.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Footprint {
    centre: [f64; 2],
    /// Half its extent along its own x and y, without the rounding.
    half: [f64; 2],
    round_m: f64,
    turn_rad: f64,
}

impl Footprint {
    pub(crate) fn of(shape: &Shape) -> Self {
        let flat = |[x, y, _]: [f64; 3]| [x, y];
        match *shape {
            Shape::Box {
                base_m,
                size_m: [width, depth, _],
                turn_deg,
            } => Self {
                centre: flat(base_m),
                half: [width / 2.0, depth / 2.0],
                round_m: 0.0,
                turn_rad: turn_deg.to_radians(),
            },
            Shape::Sphere { centre_m, radius_m } => Self::disc(flat(centre_m), radius_m),
            Shape::Cylinder {
                base_m, radius_m, ..
            } => Self::disc(flat(base_m), radius_m),
            Shape::Rectangle {
                centre_m,
                size_m: [width, height],
                turn_deg,
                lean_deg,
            } => Self {
                centre: flat(centre_m),
                half: [
                    width / 2.0,
                    height / 2.0 * lean_deg.to_radians().sin().abs(),
                ],
                round_m: 0.0,
                turn_rad: turn_deg.to_radians(),
            },
        }
    }

    const fn disc(centre: [f64; 2], radius_m: f64) -> Self {
        Self {
            centre,
            half: [0.0; 2],
            round_m: radius_m,
            turn_rad: 0.0,
        }
    }

    /// How far the body reaches from its middle over the ground, in metres.
    pub(crate) fn reach_m(&self) -> f64 {
        self.half[0].hypot(self.half[1]) + self.round_m
    }

    /// How far a point of the room's ground is from the body; 0 under it.
    pub(crate) fn distance_m(&self, [x, y]: [f64; 2]) -> f64 {
        let (sin, cos) = self.turn_rad.sin_cos();
        let (dx, dy) = (x - self.centre[0], y - self.centre[1]);
        // Turns are clockwise seen from above, as in `Shape`.
        let (across, away) = (dx * cos - dy * sin, dx * sin + dy * cos);
        let beyond = |at: f64, half: f64| (at.abs() - half).max(0.0);
        let off = beyond(across, self.half[0]).hypot(beyond(away, self.half[1]));
        (off - self.round_m).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turned_box_reaches_where_its_corner_is() {
        let shape = Shape::Box {
            base_m: [1.0, 2.0, 0.0],
            size_m: [0.4, 0.2, 0.1],
            turn_deg: 90.0,
        };
        let foot = Footprint::of(&shape);
        // Turned by a quarter, its width lies along y.
        assert!((foot.distance_m([1.0, 2.5]) - 0.3).abs() < 1e-12);
        assert!((foot.distance_m([1.5, 2.0]) - 0.4).abs() < 1e-12);
        assert_eq!(foot.distance_m([1.05, 2.15]), 0.0);
    }
}
