/// A turn of three-dimensional space: a proper orthogonal matrix, row by row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    rows: [[f64; 3]; 3],
}

impl Rotation {
    /// No turn at all.
    pub const IDENTITY: Self = Self {
        rows: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    };

    /// The right-handed turn about the direction of `vector` by its length in radians.
    ///
    /// With x right, y down and z forward, a camera turned by `[pitch, yaw, roll]` looks up for
    /// positive pitch, to the right for positive yaw, and leans clockwise for positive roll.
    #[must_use]
    pub fn from_vector(vector: [f64; 3]) -> Self {
        let [x, y, z] = vector;
        let angle = dot(vector, vector).sqrt();
        // Rodrigues' formula, I + a [v] + b [v]^2; below the threshold the first terms of the two
        // series are exact to the last bit, while the quotients would be 0/0.
        let (a, b) = if angle < 1e-4 {
            (
                1.0 - angle * angle / 6.0,
                0.5 * (1.0 - angle * angle / 12.0),
            )
        } else {
            let half = (angle / 2.0).sin() / angle;
            (angle.sin() / angle, 2.0 * half * half)
        };
        Self {
            rows: [
                [
                    1.0 - b * (y * y + z * z),
                    b * x * y - a * z,
                    b * x * z + a * y,
                ],
                [
                    b * x * y + a * z,
                    1.0 - b * (x * x + z * z),
                    b * y * z - a * x,
                ],
                [
                    b * x * z - a * y,
                    b * y * z + a * x,
                    1.0 - b * (x * x + y * y),
                ],
            ],
        }
    }

    /// The turn that a matrix is, row by row: its columns are the images of the axes.
    ///
    /// Files round their numbers, so a matrix within [`Rotation::MOST_DEFECT`] of a turn is taken
    /// for the turn nearest to it.
    ///
    /// # Errors
    /// [`NoRotation`] says by how much it is none.
    pub fn from_matrix(rows: [[f64; 3]; 3]) -> Result<Self, NoRotation> {
        let defect = defect(&rows);
        let known = defect <= Self::MOST_DEFECT;
        if !known {
            return Err(NoRotation::NotOrthogonal { defect });
        }
        let determinant = dot(rows[0], cross(rows[1], rows[2]));
        if determinant < 0.0 {
            return Err(NoRotation::Mirror { determinant });
        }
        // Already a turn to the last bits: left as it is, so that what is written comes back.
        if defect < 4.0 * f64::EPSILON {
            return Ok(Self { rows });
        }
        // Each round squares the defect (Newton's method for the nearest orthogonal matrix):
        // R (3 I - R^T R) / 2.
        let mut rows = rows;
        for _ in 0..4 {
            let columns: [[f64; 3]; 3] =
                std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i]));
            let half: [[f64; 3]; 3] = std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    let own = if i == j { 3.0 } else { 0.0 };
                    (own - dot(columns[i], columns[j])) / 2.0
                })
            });
            // The factor is symmetric, so its rows are its columns.
            rows = rows.map(|row| half.map(|column| dot(row, column)));
        }
        Ok(Self { rows })
    }

    /// How far `R R^T` may be from the identity in any entry: two digits after the point.
    pub const MOST_DEFECT: f64 = 1e-2;

    /// The axis of the turn times its angle in radians: the inverse of
    /// [`Rotation::from_vector`] for turns of less than half a circle.
    #[must_use]
    pub fn to_vector(&self) -> [f64; 3] {
        let r = &self.rows;
        // The skew part is the axis times the sine, the trace holds the cosine; the arc tangent of
        // both is accurate for small and for large angles, where either alone is not.
        let skew =
            [r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]].map(|twice| twice / 2.0);
        let sine = dot(skew, skew).sqrt();
        let cosine = (r[0][0] + r[1][1] + r[2][2] - 1.0) / 2.0;
        let stretch = if sine < 1e-12 {
            1.0
        } else {
            sine.atan2(cosine) / sine
        };
        skew.map(|component| component * stretch)
    }

    /// The turn into a frame whose axes these are: right-handed, of length 1, square to one another.
    pub(crate) const fn of_axes(axes: [[f64; 3]; 3]) -> Self {
        Self { rows: axes }
    }

    /// The matrix, row by row: the images of the axes are its columns.
    #[must_use]
    pub const fn matrix(&self) -> [[f64; 3]; 3] {
        self.rows
    }

    /// The vector, turned.
    #[must_use]
    pub fn apply(&self, vector: [f64; 3]) -> [f64; 3] {
        self.rows.map(|row| dot(row, vector))
    }

    /// The vector, turned back.
    #[must_use]
    pub fn apply_inverse(&self, vector: [f64; 3]) -> [f64; 3] {
        self.inverse().apply(vector)
    }

    /// The turn back.
    #[must_use]
    pub fn inverse(&self) -> Self {
        let r = &self.rows;
        Self {
            rows: std::array::from_fn(|i| std::array::from_fn(|j| r[j][i])),
        }
    }

    /// First `first`, then this turn.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        let columns = first.inverse().rows;
        Self {
            rows: self.rows.map(|row| columns.map(|column| dot(row, column))),
        }
    }
}

/// Why a matrix turns nothing.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoRotation {
    /// Its rows are not of length 1 and square to one another.
    #[error(
        "a matrix whose product with its transpose is {defect:.3e} from the identity is no rotation"
    )]
    NotOrthogonal {
        /// The largest difference of an entry.
        defect: f64,
    },
    /// It mirrors.
    #[error("a matrix with determinant {determinant:.3} mirrors; a rotation has 1")]
    Mirror {
        /// The determinant.
        determinant: f64,
    },
}

/// How far a matrix times its transpose is from the identity, NaN if an entry is no number.
fn defect(rows: &[[f64; 3]; 3]) -> f64 {
    let mut most = 0.0f64;
    for i in 0..3 {
        for j in 0..3 {
            let own = if i == j { 1.0 } else { 0.0 };
            let apart = (dot(rows[i], rows[j]) - own).abs();
            // A maximum would let a NaN pass unseen.
            if apart.is_nan() {
                return apart;
            }
            most = apart.max(most);
        }
    }
    most
}

/// The scalar product.
pub(crate) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product, right-handed.
pub(crate) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// The vector of a turn comes back, for tiny and for large angles.
        #[test]
        fn a_turn_gives_its_vector_back(
            axis in prop::array::uniform3(-1.0f64..1.0),
            exponent in -9.0f64..0.0,
        ) {
            let vector = axis.map(|component| component * 10f64.powf(exponent));
            let back = Rotation::from_vector(vector).to_vector();
            for (sent, got) in vector.iter().zip(back) {
                // Differences of entries near 1 lose all but some 1e-16 absolutely.
                prop_assert!((sent - got).abs() < 1e-14);
            }
        }

        /// A turn keeps lengths and angles, and its inverse undoes it.
        #[test]
        fn a_turn_is_orthogonal(
            turn in prop::array::uniform3(-1.5f64..1.5),
            vector in prop::array::uniform3(-10.0f64..10.0),
        ) {
            let rotation = Rotation::from_vector(turn);
            let turned = rotation.apply(vector);
            prop_assert!((dot(turned, turned) - dot(vector, vector)).abs() < 1e-12);
            let back = rotation.apply_inverse(turned);
            for (sent, got) in vector.iter().zip(back) {
                prop_assert!((sent - got).abs() < 1e-13);
            }
            let none = rotation.after(&rotation.inverse());
            for (row, expected) in none.matrix().iter().zip(Rotation::IDENTITY.matrix()) {
                for (a, b) in row.iter().zip(expected) {
                    prop_assert!((a - b).abs() < 1e-14);
                }
            }
        }
    }

    /// A matrix written with four digits is the turn it was; others are refused with the number.
    #[test]
    fn only_turns_are_taken() {
        let turn = Rotation::from_vector([0.2, -0.3, 0.1]);
        let rounded = turn
            .matrix()
            .map(|row| row.map(|entry| (entry * 1e4).round() / 1e4));
        let taken = Rotation::from_matrix(rounded).unwrap();
        assert!(defect(&taken.matrix()) < 1e-15);
        let apart = taken.after(&turn.inverse()).to_vector();
        assert!(dot(apart, apart).sqrt() < 1e-4);
        assert_eq!(Rotation::from_matrix(taken.matrix()), Ok(taken));

        let mut scaled = turn.matrix();
        scaled[1] = scaled[1].map(|entry| entry * 1.1);
        let refused = Rotation::from_matrix(scaled).unwrap_err();
        assert!(refused.to_string().contains("2.100e-1"), "{refused}");
        let mirror = Rotation::from_matrix([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]);
        assert_eq!(mirror, Err(NoRotation::Mirror { determinant: -1.0 }));
        let nan = Rotation::from_matrix([[1.0, 0.0, 0.0], [0.0, f64::NAN, 0.0], [0.0, 0.0, 1.0]]);
        assert!(matches!(nan, Err(NoRotation::NotOrthogonal { defect }) if defect.is_nan()));
    }

    /// The signs that the documentation promises.
    #[test]
    fn pitch_looks_up_yaw_right_and_roll_leans_clockwise() {
        let forward = [0.0, 0.0, 1.0];
        assert!(Rotation::from_vector([0.1, 0.0, 0.0]).apply(forward)[1] < 0.0);
        assert!(Rotation::from_vector([0.0, 0.1, 0.0]).apply(forward)[0] > 0.0);
        assert!(Rotation::from_vector([0.0, 0.0, 0.1]).apply([1.0, 0.0, 0.0])[1] > 0.0);
    }
}
