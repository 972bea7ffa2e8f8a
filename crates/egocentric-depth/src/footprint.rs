/// A convex polygon on a plane: what lies within a table's edge.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Footprint {
    /// Counterclockwise.
    corners: Vec<[f64; 2]>,
}

impl Footprint {
    /// The smallest convex polygon about the points, by Andrew's monotone chain.
    pub(crate) fn about(mut points: Vec<[f64; 2]>) -> Self {
        points.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        let lower = chain(points.iter());
        let upper = chain(points.iter().rev());
        Self {
            corners: [lower, upper].concat(),
        }
    }

    /// Whether a point lies within, or outside by no more than `margin`.
    pub(crate) fn holds(&self, point: [f64; 2], margin: f64) -> bool {
        if self.corners.len() < 3 {
            return false;
        }
        let edges = || self.corners.iter().zip(self.corners.iter().cycle().skip(1));
        edges().all(|(from, to)| turn(*from, *to, point) >= 0.0)
            || edges().any(|(from, to)| distance(*from, *to, point) <= margin)
    }
}

/// One half of the hull, without its last corner, with which the other half begins.
fn chain<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> Vec<[f64; 2]> {
    let mut chain: Vec<[f64; 2]> = Vec::new();
    for &point in points {
        while let [.., before, last] = chain[..]
            && turn(before, last, point) <= 0.0
        {
            chain.pop();
        }
        chain.push(point);
    }
    chain.pop();
    chain
}

/// How far a point is from the line between two corners.
fn distance(from: [f64; 2], to: [f64; 2], point: [f64; 2]) -> f64 {
    let (along, aside) = (
        [to[0] - from[0], to[1] - from[1]],
        [point[0] - from[0], point[1] - from[1]],
    );
    let square = along[0] * along[0] + along[1] * along[1];
    let part = if square > 0.0 {
        ((along[0] * aside[0] + along[1] * aside[1]) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (aside[0] - part * along[0]).hypot(aside[1] - part * along[1])
}

/// Twice the area of the triangle; positive if it goes counterclockwise.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Every point lies within its own hull, and the mean of any two does.
        #[test]
        fn a_hull_holds_its_points(points in prop::collection::vec(prop::array::uniform2(-2.0f64..2.0), 3..40)) {
            let hull = Footprint::about(points.clone());
            for (a, b) in points.iter().zip(points.iter().rev()) {
                // Rounding of areas of a few square metres.
                prop_assert!(hull.holds(*a, 1e-9));
                prop_assert!(hull.holds([(a[0] + b[0]) / 2.0, (a[1] + b[1]) / 2.0], 1e-9));
            }
            prop_assert!(!hull.holds([5.0, 0.0], 1.0));
        }
    }

    #[test]
    fn a_margin_widens_a_square() {
        let square = Footprint::about(vec![
            [0.0, 0.0],
            [1.0, 0.0],
            [0.5, 0.5],
            [1.0, 1.0],
            [0.0, 1.0],
        ]);
        assert_eq!(square.corners.len(), 4);
        assert!(square.holds([1.05, 0.5], 0.1) && !square.holds([1.15, 0.5], 0.1));
        // Beyond a corner it is the distance to the corner that counts.
        assert!(!square.holds([1.08, 1.08], 0.1));
        assert!(!Footprint::about(Vec::new()).holds([0.0, 0.0], 1.0));
    }
}
