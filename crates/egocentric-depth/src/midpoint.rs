use v1_gabor::Binocular;

use crate::eye::Ray;
use crate::rotation::{cross, dot};
use crate::{Head, Position};

/// Where two lines of sight come nearest to one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Midpoint {
    /// Midway along their shortest connection.
    pub position: Position<Head>,
    /// The length of that connection in metres: 0 for a perfect match of perfectly known eyes,
    /// so a large gap marks a false match or a rig that has drifted.
    pub gap_m: f64,
}

/// The midpoint of the shortest connection of two lines of sight; `None` if they are parallel or
/// come nearest behind either eye.
///
/// This is the triangulation for eyes of any attitude: it serves where pitch, roll or vertical
/// disparity keep the lines from meeting, which [`general_form`](crate::general_form()) presumes.
#[must_use]
pub fn midpoint(rays: Binocular<Ray>) -> Option<Midpoint> {
    let Binocular { left, right } = rays;
    let (p, q) = (left.origin.to_array(), right.origin.to_array());
    let (d, e) = (left.direction, right.direction);
    let across: [f64; 3] = std::array::from_fn(|i| q[i] - p[i]);
    let normal = cross(d, e);
    let area = dot(normal, normal);
    // How far along each line, in lengths of its direction, the shortest connection starts.
    let along_left = dot(cross(across, e), normal) / area;
    let along_right = dot(cross(across, d), normal) / area;
    let in_front = along_left > 0.0 && along_right > 0.0;
    // Parallel lines have no normal: both quotients are then infinite or no number.
    (in_front && along_left.is_finite() && along_right.is_finite()).then(|| {
        let near_left: [f64; 3] = std::array::from_fn(|i| p[i] + along_left * d[i]);
        let near_right: [f64; 3] = std::array::from_fn(|i| q[i] + along_right * e[i]);
        Midpoint {
            position: Position::from_array(std::array::from_fn(|i| {
                (near_left[i] + near_right[i]) / 2.0
            })),
            gap_m: dot(across, normal).abs() / area.sqrt(),
        }
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn ray(origin: [f64; 3], direction: [f64; 3]) -> Ray {
        Ray {
            origin: Position::from_array(origin),
            direction,
        }
    }

    proptest! {
        /// Two lines drawn through the ends of a segment that is square to both come nearest at
        /// its middle, and the gap is its length.
        #[test]
        fn the_connection_is_square_to_both_lines(
            x in -1.0f64..1.0,
            z in 0.5f64..5.0,
            gap in 0.0f64..0.05,
        ) {
            let (left, right) = ([-0.135, 0.0, 0.0], [0.135, gap, 0.0]);
            let rays = Binocular {
                left: ray(left, [x + 0.135, 0.0, z]),
                right: ray(right, [x - 0.135, 0.0, z]),
            };
            let found = midpoint(rays).expect("the lines meet in front");
            let expected = [x, gap / 2.0, z];
            for (got, expected) in found.position.to_array().iter().zip(expected) {
                // The sine of the angle between the lines is at least 0.05, and enters squared.
                prop_assert!((got - expected).abs() < 1e-11);
            }
            prop_assert!((found.gap_m - gap).abs() < 1e-12);
        }
    }

    #[test]
    fn parallel_and_parting_lines_have_no_midpoint() {
        let left = ray([-0.1, 0.0, 0.0], [0.0, 0.0, 1.0]);
        for direction in [[0.0, 0.0, 1.0], [0.1, 0.0, 1.0]] {
            let right = ray([0.1, 0.0, 0.0], direction);
            assert_eq!(midpoint(Binocular { left, right }), None);
        }
    }
}
