/// How a lens bends lines of sight: from where a line crosses the plane `z = 1` of the camera to
/// where it appears there.
///
/// Coefficients are those of OpenCV and ROS, without unit, in their order.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Lens {
    /// It bends nothing: a pinhole.
    #[default]
    Pinhole,
    /// Brown and Conrady, `k1 k2 p1 p2 k3 k4 k5 k6`: the radius is stretched by
    /// `(1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)`, and `p1, p2` lean the lens.
    /// The five-term model has `k4 = k5 = k6 = 0`; ROS calls it `plumb_bob`, and the other
    /// `rational_polynomial`.
    BrownConrady([f64; 8]),
    /// Equidistant fisheye, `k1 k2 k3 k4`: a line at the angle `t` from the axis appears at the
    /// radius `t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8)`.
    Fisheye([f64; 4]),
}

/// A pixel is some thousandth of the plane `z = 1`; a billionth of that is beyond any picture.
const SETTLED: f64 = 1e-12;

/// Newton's rounds: from the distorted place itself, lenses of 120 degrees settle within ten.
const ROUNDS: usize = 30;

impl Lens {
    /// The coefficients in the order of the field's files: 0, 8 or 4 of them.
    #[must_use]
    pub const fn coefficients(&self) -> &[f64] {
        match self {
            Self::Pinhole => &[],
            Self::BrownConrady(terms) => terms,
            Self::Fisheye(terms) => terms,
        }
    }

    /// Whether every coefficient is finite.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.coefficients().iter().all(|term| term.is_finite())
    }

    /// Where the line of sight that crosses `z = 1` at `(x, y)` appears.
    #[must_use]
    pub fn distort(&self, (x, y): (f64, f64)) -> (f64, f64) {
        match self {
            Self::Pinhole => (x, y),
            Self::BrownConrady(terms) => brown_conrady(terms, x, y).0,
            Self::Fisheye(terms) => {
                let radius = x.hypot(y);
                let stretch = if radius > 0.0 {
                    fisheye_radius(terms, radius.atan()).0 / radius
                } else {
                    1.0
                };
                (x * stretch, y * stretch)
            }
        }
    }

    /// Where the line of sight that appears at `(x, y)` crosses `z = 1`: the inverse of
    /// [`Lens::distort`] on the part of the image around the axis where the lens is one to one.
    ///
    /// `None` beyond it: a polynomial turns back somewhere, and a fisheye sees lines that never
    /// cross the plane.
    #[must_use]
    pub fn undistort(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        match self {
            Self::Pinhole => Some((x, y)),
            Self::BrownConrady(terms) => undo_brown_conrady(terms, x, y),
            Self::Fisheye(terms) => {
                let radius = x.hypot(y);
                if radius == 0.0 {
                    return Some((0.0, 0.0));
                }
                let angle = undo_fisheye_radius(terms, radius)?;
                let stretch = angle.tan() / radius;
                Some((x * stretch, y * stretch))
            }
        }
    }
}

/// The distorted place and the Jacobian, row by row.
fn brown_conrady(terms: &[f64; 8], x: f64, y: f64) -> ((f64, f64), [f64; 4]) {
    let [k1, k2, p1, p2, k3, k4, k5, k6] = *terms;
    let square = x * x + y * y;
    let above = 1.0 + square * (k1 + square * (k2 + square * k3));
    let below = 1.0 + square * (k4 + square * (k5 + square * k6));
    let stretch = above / below;
    let above_slope = k1 + square * (2.0 * k2 + square * 3.0 * k3);
    let below_slope = k4 + square * (2.0 * k5 + square * 3.0 * k6);
    // By the square of the radius, whose own derivatives are 2 x and 2 y.
    let slope = (above_slope - stretch * below_slope) / below;
    let place = (
        x * stretch + 2.0 * p1 * x * y + p2 * (square + 2.0 * x * x),
        y * stretch + p1 * (square + 2.0 * y * y) + 2.0 * p2 * x * y,
    );
    let across = 2.0 * x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y;
    let jacobian = [
        stretch + 2.0 * x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
        across,
        across,
        stretch + 2.0 * y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
    ];
    (place, jacobian)
}

/// Newton's method from the distorted place, kept where the mapping has not folded over: there the
/// determinant of its Jacobian is positive.
fn undo_brown_conrady(terms: &[f64; 8], x: f64, y: f64) -> Option<(f64, f64)> {
    let (mut u, mut v) = (x, y);
    for _ in 0..ROUNDS {
        let ((at_x, at_y), [a, b, c, d]) = brown_conrady(terms, u, v);
        let determinant = a * d - b * c;
        let (miss_x, miss_y) = (x - at_x, y - at_y);
        if determinant > 0.0 && miss_x.abs().max(miss_y.abs()) < SETTLED * (1.0 + x.hypot(y)) {
            return Some((u, v));
        }
        if determinant <= 0.0 || !determinant.is_finite() {
            // Beyond the fold: half the way back to the axis, from where the method goes on.
            (u, v) = (u / 2.0, v / 2.0);
            continue;
        }
        u += (d * miss_x - b * miss_y) / determinant;
        v += (a * miss_y - c * miss_x) / determinant;
    }
    None
}

/// The radius at which an angle appears, and its derivative.
fn fisheye_radius([k1, k2, k3, k4]: &[f64; 4], angle: f64) -> (f64, f64) {
    let square = angle * angle;
    let stretch = 1.0 + square * (k1 + square * (k2 + square * (k3 + square * k4)));
    let slope =
        1.0 + square * (3.0 * k1 + square * (5.0 * k2 + square * (7.0 * k3 + square * 9.0 * k4)));
    (angle * stretch, slope)
}

fn undo_fisheye_radius(terms: &[f64; 4], radius: f64) -> Option<f64> {
    let mut angle = radius;
    for _ in 0..ROUNDS {
        let (at, slope) = fisheye_radius(terms, angle);
        let miss = radius - at;
        if slope > 0.0 && miss.abs() < SETTLED * (1.0 + radius) {
            return (0.0..std::f64::consts::FRAC_PI_2)
                .contains(&angle)
                .then_some(angle);
        }
        if slope <= 0.0 || !slope.is_finite() {
            angle /= 2.0;
            continue;
        }
        angle += miss / slope;
    }
    None
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The lens of a wide webcam, and the tangential terms of a leaning sensor.
    fn brown() -> impl Strategy<Value = Lens> {
        (
            (-0.35f64..0.1, -0.05f64..0.15, -0.05f64..0.05),
            (-0.005f64..0.005, -0.005f64..0.005),
            prop::array::uniform3(-0.02f64..0.02),
        )
            .prop_map(|((k1, k2, k3), (p1, p2), [k4, k5, k6])| {
                Lens::BrownConrady([k1, k2, p1, p2, k3, k4, k5, k6])
            })
    }

    proptest! {
        /// What a lens bends it can straighten, within the part that pictures use.
        #[test]
        fn undistortion_undoes_distortion(lens in brown(), x in -0.6f64..0.6, y in -0.45f64..0.45) {
            let bent = lens.distort((x, y));
            let (u, v) = lens.undistort(bent).expect("lenses are one to one near the axis");
            // A residue of 1e-12 over a Jacobian of at least some tenths.
            prop_assert!((u - x).abs() < 1e-10 && (v - y).abs() < 1e-10, "{u} {v}");
        }

        /// A fisheye too, out to seventy degrees.
        #[test]
        fn a_fisheye_is_straightened(
            terms in prop::array::uniform4(-0.01f64..0.01),
            angle in 0.0f64..1.2,
            around in 0.0f64..6.3,
        ) {
            let (x, y) = (angle.tan() * around.cos(), angle.tan() * around.sin());
            let lens = Lens::Fisheye(terms);
            let (u, v) = lens.undistort(lens.distort((x, y))).expect("seventy degrees are seen");
            // The tangent magnifies an angle's residue by up to 8 there.
            prop_assert!((u - x).abs() < 1e-9 && (v - y).abs() < 1e-9, "{u} {v}");
        }

        /// No number makes it panic, and what comes back is what was asked for.
        #[test]
        fn an_answer_is_right_or_none(
            terms in prop::array::uniform8(-5.0f64..5.0),
            x in -10.0f64..10.0,
            y in -10.0f64..10.0,
        ) {
            let lens = Lens::BrownConrady(terms);
            if let Some(straight) = lens.undistort((x, y)) {
                let (back_x, back_y) = lens.distort(straight);
                prop_assert!((back_x - x).abs() < 1e-9 && (back_y - y).abs() < 1e-9);
            }
        }
    }

    /// Against values worked out by hand from OpenCV's printed formulas.
    #[test]
    fn the_terms_have_their_places() {
        let (x, y) =
            Lens::BrownConrady([0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]).distort((0.5, 0.0));
        assert!((x - 0.5 * (1.0 + 0.1 * 0.25)).abs() < 1e-15 && y == 0.0);
        let (x, y) =
            Lens::BrownConrady([0.0, 0.0, 0.01, 0.02, 0.0, 0.0, 0.0, 0.0]).distort((0.5, 0.2));
        let square = 0.29;
        assert!((x - (0.5 + 2.0 * 0.01 * 0.1 + 0.02 * (square + 0.5))).abs() < 1e-15);
        assert!((y - (0.2 + 0.01 * (square + 2.0 * 0.04) + 2.0 * 0.02 * 0.1)).abs() < 1e-15);
        let (x, _) =
            Lens::BrownConrady([0.0, 0.0, 0.0, 0.0, 0.0, 0.1, 0.0, 0.0]).distort((0.5, 0.0));
        assert!((x - 0.5 / 1.025).abs() < 1e-15);
        let (x, _) = Lens::Fisheye([0.0; 4]).distort((1.0, 0.0));
        assert!((x - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
        // Beyond a right angle a fisheye still sees; the plane z = 1 does not.
        assert_eq!(Lens::Fisheye([0.0; 4]).undistort((1.6, 0.0)), None);
    }
}
