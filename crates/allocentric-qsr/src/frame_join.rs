//! How one map frame lies in another, from the landmarks that both have.

use std::collections::{BTreeMap, BTreeSet, VecDeque};

use crate::fusion::{add, inverse};
use crate::ground_estimate::GroundEstimate;
use crate::life::Life;
use crate::scene_memory::SceneMemory;
use crate::{ObjectId, Observer};

/// The most a turn may be uncertain by, one standard error in radians, for its effect to be told to
/// first order and a bound on the second.
const VAGUEST_TURN_RAD: f64 = 0.2;

/// Steps of the least-squares fit; it starts at the answer of equal weights, so few are enough.
const STEPS: usize = 4;

/// A rigid motion of the plane with its covariance: turned by `turn_rad` about the middle of the
/// landmarks in the one frame, which comes to lie on their middle in the other.
#[derive(Clone, Debug)]
pub(crate) struct FrameJoin {
    from: [f64; 2],
    to: [f64; 2],
    turn_rad: f64,
    /// Of `to` and `turn_rad`.
    covariance: [[f64; 3]; 3],
    /// The landmarks, by name.
    pub(crate) landmarks: Vec<ObjectId>,
}

impl FrameJoin {
    /// Fits the motion to two or more landmarks; `None` if there are fewer, if they lie too close
    /// together to tell the turn, or if some are beyond `gate` standard errors from where the motion
    /// takes them: then something has moved between the frames.
    ///
    /// Errors of landmarks seen from one pose are correlated in a way nobody knows, so the
    /// information of n of them counts as their mean and not as their sum: covariance intersection
    /// with equal weights.
    pub(crate) fn fit(
        landmarks: &[(ObjectId, GroundEstimate, GroundEstimate)],
        gate: f64,
    ) -> Option<Self> {
        if landmarks.len() < 2 {
            return None;
        }
        let count = landmarks.len() as f64;
        let middle = |of: fn(&(ObjectId, GroundEstimate, GroundEstimate)) -> &GroundEstimate| {
            let places = landmarks.iter().map(|mark| of(mark).position_m());
            let sum = places.fold([0.0, 0.0], |sum, at| [sum[0] + at[0], sum[1] + at[1]]);
            sum.map(|part| part / count)
        };
        let (from, mut to) = (middle(|mark| &mark.1), middle(|mark| &mark.2));
        let offsets = |mark: &(ObjectId, GroundEstimate, GroundEstimate)| {
            let (p, q) = (mark.1.position_m(), mark.2.position_m());
            ([p[0] - from[0], p[1] - from[1]], q)
        };
        let (mut ahead, mut aside) = (0.0, 0.0);
        for mark in landmarks {
            let (u, q) = offsets(mark);
            let v = [q[0] - to[0], q[1] - to[1]];
            ahead += u[0] * v[0] + u[1] * v[1];
            aside += u[0] * v[1] - u[1] * v[0];
        }
        let mut turn_rad = f64::atan2(aside, ahead);
        let mut covariance = [[0.0; 3]; 3];
        for _ in 0..STEPS {
            let (mut normal, mut pull) = ([[0.0; 3]; 3], [0.0; 3]);
            for mark in landmarks {
                let (u, q) = offsets(mark);
                let (there, slope) = (turned(u, turn_rad), turned_on(u, turn_rad));
                let residual = [q[0] - to[0] - there[0], q[1] - to[1] - there[1]];
                let spread = add(
                    rotated(mark.1.covariance_m2(), turn_rad),
                    mark.2.covariance_m2(),
                );
                let weight = inverse(spread);
                let columns = [[1.0, 0.0], [0.0, 1.0], slope];
                for (row, left) in columns.iter().enumerate() {
                    let seen =
                        [0, 1].map(|k| (left[0] * weight[0][k] + left[1] * weight[1][k]) / count);
                    pull[row] += seen[0] * residual[0] + seen[1] * residual[1];
                    for (column, right) in columns.iter().enumerate() {
                        normal[row][column] += seen[0] * right[0] + seen[1] * right[1];
                    }
                }
            }
            covariance = inverse_3(normal)?;
            let step = covariance.map(|row| row[0] * pull[0] + row[1] * pull[1] + row[2] * pull[2]);
            to = [to[0] + step[0], to[1] + step[1]];
            turn_rad += step[2];
        }
        let join = Self {
            from,
            to,
            turn_rad,
            covariance,
            landmarks: landmarks.iter().map(|mark| mark.0.clone()).collect(),
        };
        let sure = join.covariance[2][2] <= VAGUEST_TURN_RAD * VAGUEST_TURN_RAD;
        let held = landmarks.iter().all(|mark| {
            let there = join.moved(&mark.1).position_m();
            let spread = add(
                rotated(mark.1.covariance_m2(), turn_rad),
                mark.2.covariance_m2(),
            );
            let [dx, dz] = [0, 1].map(|k| mark.2.position_m()[k] - there[k]);
            let weight = inverse(spread);
            let off = dx * (weight[0][0] * dx + weight[0][1] * dz)
                + dz * (weight[1][0] * dx + weight[1][1] * dz);
            off <= gate * gate
        });
        (sure && held).then_some(join)
    }

    /// A place of the one frame in the other, with the errors of the motion.
    pub(crate) fn moved(&self, place: &GroundEstimate) -> GroundEstimate {
        let [x, z] = place.position_m();
        let offset = [x - self.from[0], z - self.from[1]];
        let (there, slope) = (
            turned(offset, self.turn_rad),
            turned_on(offset, self.turn_rad),
        );
        let c = &self.covariance;
        let of_motion = |i: usize, j: usize| {
            c[i][j] + c[i][2] * slope[j] + slope[i] * c[2][j] + slope[i] * c[2][2] * slope[j]
        };
        // What a turn of k standard errors moves beyond its tangent is k^2 / 2 of this; a variance of
        // its square holds that up to k = 3 where the half is taken three times.
        let curved = 1.5 * offset[0].hypot(offset[1]) * c[2][2];
        let motion = [
            [of_motion(0, 0) + curved * curved, of_motion(0, 1)],
            [of_motion(1, 0), of_motion(1, 1) + curved * curved],
        ];
        let covariance = add(rotated(place.covariance_m2(), self.turn_rad), motion);
        GroundEstimate::of([self.to[0] + there[0], self.to[1] + there[1]], covariance)
    }
}

impl SceneMemory {
    /// Where an object is in the present frame, seen there or carried there from an earlier frame by
    /// the landmarks they share; `None` if nothing joins them, or it is gone.
    pub(crate) fn here(&self, object: &ObjectId) -> Option<GroundEstimate> {
        self.estimate(object)
            .or_else(|| Some(self.carried(object, &self.joins())?.0))
    }

    /// Where an object of an earlier frame is in the present one, and the landmarks that say so.
    pub(crate) fn carried(
        &self,
        object: &ObjectId,
        joins: &BTreeMap<u32, Vec<FrameJoin>>,
    ) -> Option<(GroundEstimate, Vec<ObjectId>)> {
        let kept = self.objects.get(object)?;
        if kept.life == Life::Removed {
            return None;
        }
        let mut frames = kept.places.iter().rev();
        frames.find_map(|(frame, place)| {
            let path = joins.get(frame)?;
            let there = path.iter().fold(*place, |place, join| join.moved(&place));
            let mut landmarks: Vec<ObjectId> = path
                .iter()
                .flat_map(|join| join.landmarks.clone())
                .collect();
            landmarks.sort_unstable();
            landmarks.dedup();
            Some((there, landmarks))
        })
    }

    /// The way from each earlier frame that landmarks join to the present one, directly or through
    /// others; the shortest chain, and of those the one over the latest frames.
    pub(crate) fn joins(&self) -> BTreeMap<u32, Vec<FrameJoin>> {
        let places = self.objects.values().flat_map(|kept| kept.places.keys());
        let mut apart: BTreeSet<u32> = places.copied().collect();
        apart.remove(&self.frame);
        let mut joins: BTreeMap<u32, Vec<FrameJoin>> = BTreeMap::new();
        let mut reached = VecDeque::from([self.frame]);
        while let Some(to) = reached.pop_front() {
            for from in Vec::from_iter(apart.iter().rev().copied()) {
                if let Some(join) = self.join(from, to) {
                    let mut path = vec![join];
                    path.extend(joins.get(&to).into_iter().flatten().cloned());
                    joins.insert(from, path);
                    reached.push_back(from);
                    apart.remove(&from);
                }
            }
        }
        joins
    }

    fn join(&self, from: u32, to: u32) -> Option<FrameJoin> {
        let landmarks = self.objects.iter().filter_map(|(name, kept)| {
            let believed = !matches!(kept.life, Life::Stale | Life::Missing | Life::Removed);
            let places = kept.places.get(&from).zip(kept.places.get(&to));
            let (p, q) = places.filter(|_| believed)?;
            Some((name.clone(), *p, *q))
        });
        let landmarks: Vec<_> = landmarks.collect();
        FrameJoin::fit(&landmarks, f64::from(self.params.gate_sigmas))
    }

    /// Whether an observer is somewhere in the present frame.
    pub(crate) fn is_here(&self, observer: &Observer) -> bool {
        match observer {
            Observer::Robot | Observer::At(_) => true,
            Observer::Object(object) => self.here(object).is_some(),
        }
    }
}

/// A vector turned to the left.
fn turned([x, z]: [f64; 2], by_rad: f64) -> [f64; 2] {
    let (sin, cos) = by_rad.sin_cos();
    [cos * x - sin * z, sin * x + cos * z]
}

/// How the turned vector changes with the angle: it turned by a quarter more.
fn turned_on(vector: [f64; 2], by_rad: f64) -> [f64; 2] {
    let [x, z] = turned(vector, by_rad);
    [-z, x]
}

/// A covariance in a frame that is turned.
fn rotated(covariance: [[f64; 2]; 2], by_rad: f64) -> [[f64; 2]; 2] {
    let columns = [0, 1].map(|k| turned([covariance[0][k], covariance[1][k]], by_rad));
    let rows = [0, 1].map(|k| turned([columns[0][k], columns[1][k]], by_rad));
    let aside = (rows[0][1] + rows[1][0]) / 2.0;
    [[rows[0][0], aside], [aside, rows[1][1]]]
}

/// The inverse of a symmetric matrix with positive diagonal, by cofactors; `None` if it has none
/// worth having.
fn inverse_3(m: [[f64; 3]; 3]) -> Option<[[f64; 3]; 3]> {
    let minor = |r: usize, c: usize| {
        let ([r1, r2], [c1, c2]) = (others(r), others(c));
        m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]
    };
    let determinant = m[0][0] * minor(0, 0) - m[0][1] * minor(0, 1) + m[0][2] * minor(0, 2);
    let size = m[0][0] * m[1][1] * m[2][2];
    (determinant > 1e-12 * size && determinant.is_finite()).then(|| {
        std::array::from_fn(|r| {
            std::array::from_fn(|c| {
                let sign = if (r + c) % 2 == 0 { 1.0 } else { -1.0 };
                sign * minor(c, r) / determinant
            })
        })
    })
}

const fn others(k: usize) -> [usize; 2] {
    [[1, 2], [0, 2], [0, 1]][k]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        /// Landmarks whose errors are within a standard error carry any place to within three, and
        /// to within the errors of its own.
        #[test]
        fn a_place_is_carried_to_where_it_is(
            marks in proptest::collection::vec((-2.0..2.0f64, -2.0..2.0f64), 2..6),
            place in (-3.0..3.0f64, -3.0..3.0f64), turn in -3.0..3.0f64, shift in (-5.0..5.0f64, -5.0..5.0f64),
            errors in proptest::collection::vec((-0.7..0.7f64, -0.7..0.7f64), 12),
        ) {
            let there = |(x, z): (f64, f64)| {
                let [a, b] = turned([x, z], turn);
                [a + shift.0, b + shift.1]
            };
            let variance = [[1e-4, 0.0], [0.0, 1e-4]];
            let off = |at: [f64; 2], k: usize| {
                GroundEstimate::of([at[0] + 0.01 * errors[k].0, at[1] + 0.01 * errors[k].1], variance)
            };
            let landmarks: Vec<_> = marks.iter().enumerate().map(|(k, &mark)| {
                (ObjectId::new(format!("{k}")), off([mark.0, mark.1], 2 * k), off(there(mark), 2 * k + 1))
            }).collect();
            let Some(join) = FrameJoin::fit(&landmarks, 4.0) else {
                // Landmarks too close together tell no turn.
                let wide = marks.iter().flat_map(|a| marks.iter().map(move |b| (a.0 - b.0).hypot(a.1 - b.1)));
                prop_assert!(wide.fold(0.0, f64::max) < 0.3);
                return Ok(());
            };
            let carried = join.moved(&GroundEstimate::of([place.0, place.1], variance));
            let (is, [x, z]) = (there(place), carried.position_m());
            let spread = carried.covariance_m2();
            let weight = inverse(spread);
            let (dx, dz) = (is[0] - x, is[1] - z);
            let off = dx * (weight[0][0] * dx + weight[0][1] * dz) + dz * (weight[1][0] * dx + weight[1][1] * dz);
            prop_assert!(off <= 9.0, "{off} {spread:?}");
            prop_assert!(spread[0][0] >= 1e-4 - 1e-12 && spread[1][1] >= 1e-4 - 1e-12);
        }
    }

    #[test]
    fn what_moved_between_the_frames_joins_nothing() {
        let at = |x: f64, z: f64| GroundEstimate::of([x, z], [[1e-4, 0.0], [0.0, 1e-4]]);
        let mark = |name: &str, p, q| (ObjectId::new(name), p, q);
        let marks = [
            mark("a", at(0.0, 1.0), at(1.0, 1.0)),
            mark("b", at(1.0, 1.0), at(2.0, 1.0)),
        ];
        assert!(FrameJoin::fit(&marks, 4.0).is_some());
        assert!(FrameJoin::fit(&marks[..1], 4.0).is_none());
        let torn = [marks[0].clone(), mark("b", at(1.0, 1.0), at(2.4, 1.0))];
        assert!(FrameJoin::fit(&torn, 4.0).is_none());
    }
}
