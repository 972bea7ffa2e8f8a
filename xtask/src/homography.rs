use v1_gabor::Size;

/// A projective map of the plane: `(x, y, 1)` goes to the direction of `M (x, y, 1)`, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Homography([[f64; 3]; 3]);

impl Homography {
    /// Everything stays.
    pub(crate) const IDENTITY: Self = Self([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);

    /// Everything moves down by `dy` pixels.
    pub(crate) const fn down(dy: f64) -> Self {
        Self([[1.0, 0.0, 0.0], [0.0, 1.0, dy], [0.0, 0.0, 1.0]])
    }

    /// The picture turns clockwise about its middle.
    pub(crate) fn roll(degrees: f64, size: Size) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Self([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]]).about_the_middle(size)
    }

    /// The picture grows about its middle.
    pub(crate) fn scale(factor: f64, size: Size) -> Self {
        Self([[factor, 0.0, 0.0], [0.0, factor, 0.0], [0.0, 0.0, 1.0]]).about_the_middle(size)
    }

    /// The camera nods up, for a focal length of `focal_px` and a principal point in the middle:
    /// `K R K^-1`, so that the picture moves down, more at its top and bottom than in the middle.
    pub(crate) fn pitch(degrees: f64, focal_px: f64, size: Size) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Self([
            [1.0, 0.0, 0.0],
            [0.0, cos, sin * focal_px],
            [0.0, -sin / focal_px, cos],
        ])
        .about_the_middle(size)
    }

    /// This map, then another.
    pub(crate) fn then(self, next: Self) -> Self {
        let product = |i: usize, j: usize| (0..3).map(|k| next.0[i][k] * self.0[k][j]).sum();
        Self(std::array::from_fn(|i| {
            std::array::from_fn(|j| product(i, j))
        }))
    }

    /// Where a point goes.
    pub(crate) fn at(&self, x: f64, y: f64) -> (f64, f64) {
        let [u, v, w] = self.0.map(|row| row[0] * x + row[1] * y + row[2]);
        (u / w, v / w)
    }

    /// The map back, by cofactors: maps close to the identity have a determinant close to 1.
    pub(crate) fn inverse(&self) -> Self {
        let m = &self.0;
        let cofactor = |i: usize, j: usize| {
            let (r, s, c, d) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
            m[r][c] * m[s][d] - m[r][d] * m[s][c]
        };
        // A common factor cancels in the division by the third component.
        Self(std::array::from_fn(|i| {
            std::array::from_fn(|j| cofactor(j, i))
        }))
    }

    fn about_the_middle(self, size: Size) -> Self {
        let middle = |side: usize| (side as f64 - 1.0) / 2.0;
        let (x, y) = (middle(size.width), middle(size.height));
        let moved = |x, y| Self([[1.0, 0.0, x], [0.0, 1.0, y], [0.0, 0.0, 1.0]]);
        moved(-x, -y).then(self).then(moved(x, y))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SIZE: Size = Size {
        width: 401,
        height: 301,
    };

    #[test]
    fn the_middle_of_a_turn_and_a_growth_stays() {
        for map in [
            Homography::roll(7.0, SIZE),
            Homography::scale(1.2, SIZE),
            Homography::IDENTITY,
        ] {
            let (x, y) = map.at(200.0, 150.0);
            assert!((x - 200.0).abs() < 1e-9 && (y - 150.0).abs() < 1e-9);
        }
        let (x, y) = Homography::roll(90.0, SIZE).at(210.0, 150.0);
        assert!(
            (x - 200.0).abs() < 1e-9 && (y - 160.0).abs() < 1e-9,
            "clockwise"
        );
        // tan 1 degree of 400 px is 6.98 px, downwards.
        let (x, y) = Homography::pitch(1.0, 400.0, SIZE).at(200.0, 150.0);
        assert!((x - 200.0).abs() < 1e-9 && (y - 156.98).abs() < 0.01, "{y}");
    }

    proptest! {
        /// There and back again.
        #[test]
        fn the_inverse_undoes(
            roll in -5.0f64..5.0, pitch in -3.0f64..3.0, scale in 0.9f64..1.1, down in -9.0f64..9.0,
            x in 0.0f64..400.0, y in 0.0f64..300.0,
        ) {
            let map = Homography::roll(roll, SIZE)
                .then(Homography::pitch(pitch, 400.0, SIZE))
                .then(Homography::scale(scale, SIZE))
                .then(Homography::down(down));
            let (u, v) = map.at(x, y);
            let (back_x, back_y) = map.inverse().at(u, v);
            prop_assert!((back_x - x).abs() < 1e-8 && (back_y - y).abs() < 1e-8);
        }
    }
}
