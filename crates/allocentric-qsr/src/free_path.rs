use std::fmt;

use serde::{Deserialize, Serialize};

use crate::ground_extent::GroundExtent;
use crate::life::Life;
use crate::scene_memory::SceneMemory;
use crate::{ObjectId, Observer};

/// What the memory knows of a straight way over the ground.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(tag = "path", rename_all = "snake_case")]
pub enum FreePath {
    /// Every square of the way has been seen free, lately and since anything was lost, and no remembered object can reach into it.
    Clear,
    /// These objects may stand in the way, by name.
    Blocked {
        /// The objects.
        by: Vec<ObjectId>,
    },
    /// Nothing known stands in the way, but part of it was never seen free, or too long ago: before the
    /// looks for which the world is trusted, or before something was lost that may stand there now.
    Unknown {
        /// The middle of the first such square from the start, `[x, z]` in the map frame, in
        /// metres.
        at_m: [f64; 2],
    },
}

impl fmt::Display for FreePath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Clear => f.write_str("clear"),
            Self::Blocked { by } => {
                let names: Vec<&str> = by.iter().map(ObjectId::as_str).collect();
                write!(f, "blocked by {}", names.join(", "))
            }
            Self::Unknown { at_m: [x, z] } => {
                write!(f, "not known to be free at ({x:.2}, {z:.2}) m")
            }
        }
    }
}

/// One end of the way: a point of the map frame, and how much ground around it is its own.
struct End {
    at: [f64; 2],
    own_m: f64,
}

impl SceneMemory {
    /// Whether something of this radius can go straight from one place to the other.
    ///
    /// The objects at the two ends are not in the way. Every object counts with its radius and
    /// all its possible places, whether it is in view or not; a missing one does not count, for
    /// its place has been seen free. `None` if an end is unknown in the present frame.
    #[must_use]
    pub fn free_path(&self, from: &Observer, to: &Observer, radius_m: f64) -> Option<FreePath> {
        let ends = [self.end(from, radius_m)?, self.end(to, radius_m)?];
        let line = [ends[0].at, ends[1].at];
        let at_an_end = |name: &ObjectId| {
            [from, to]
                .iter()
                .any(|end| **end == Observer::Object(name.clone()))
        };
        let sigmas = self.params.qualify.sigmas;
        let by: Vec<ObjectId> = self
            .present()
            .filter(|(name, kept, place)| {
                let reach = radius_m + f64::from(kept.radius_mm) / 1e3;
                kept.life != Life::Missing
                    && !at_an_end(name)
                    && GroundExtent::of(place, sigmas).distance_to_line(line) <= reach
            })
            .map(|(name, ..)| name.clone())
            .collect();
        if !by.is_empty() {
            return Some(FreePath::Blocked { by });
        }
        let unseen = self.unseen_square(&ends, radius_m);
        Some(unseen.map_or(FreePath::Clear, |at_m| FreePath::Unknown { at_m }))
    }

    fn end(&self, end: &Observer, radius_m: f64) -> Option<End> {
        match end {
            Observer::Robot => Some(End {
                at: [self.robot.pose().x_m(), self.robot.pose().z_m()],
                own_m: radius_m,
            }),
            Observer::At(pose) => Some(End {
                at: [pose.x_m(), pose.z_m()],
                own_m: radius_m,
            }),
            Observer::Object(object) => {
                let place = self.here(object)?;
                let [[xx, _], [_, zz]] = place.covariance_m2();
                let unsure_m = self.params.qualify.sigmas * xx.max(zz).sqrt();
                let radius = f64::from(self.objects.get(object)?.radius_mm) / 1e3;
                let at = place.position_m();
                // Not all ground that it may cover, which may be another's too. Who is wider than a ring as
                // wide as the traveller reaches out of it, onto ground that must have been seen free.
                let own_m = radius + unsure_m.min(radius_m);
                Some(End { at, own_m })
            }
        }
    }

    /// The first square of the way that does not count as free. Where the traveller stands at a place that
    /// is told, and the ground that the object at an end covers where it is believed, need not have been; ground
    /// beside that must, for another may stand there.
    fn unseen_square(&self, ends: &[End; 2], radius_m: f64) -> Option<[f64; 2]> {
        let line = [ends[0].at, ends[1].at];
        let side = f64::from(self.params.cell_mm) / 1e3;
        // A square counts where its middle is covered; half its diagonal more reaches its corners.
        let corner = self.half_diagonal_m();
        let reach = radius_m + corner;
        let squares = |axis: usize| {
            let low = line[0][axis].min(line[1][axis]) - reach;
            let high = line[0][axis].max(line[1][axis]) + reach;
            (low / side).floor() as i32..=(high / side).floor() as i32
        };
        let free = self.trusted_ground();
        let mut first: Option<(f64, [f64; 2])> = None;
        for column in squares(0) {
            for row in squares(1) {
                let centre = [self.centre_m(column), self.centre_m(row)];
                let own = |end: &End| distance(centre, end.at) <= end.own_m + corner;
                let on_the_way = point_to_line(centre, line) <= reach;
                if on_the_way && !ends.iter().any(own) && !free((column, row)) {
                    let away = distance(centre, line[0]);
                    if first.is_none_or(|(nearest, _)| away < nearest) {
                        first = Some((away, centre));
                    }
                }
            }
        }
        first.map(|(_, centre)| centre)
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The distance of a point from a segment.
pub(crate) fn point_to_line(point: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let way = [b[0] - a[0], b[1] - a[1]];
    let length = way[0] * way[0] + way[1] * way[1];
    let along = (point[0] - a[0]) * way[0] + (point[1] - a[1]) * way[1];
    let part = if length > 0.0 {
        (along / length).clamp(0.0, 1.0)
    } else {
        0.0
    };
    distance(point, [a[0] + part * way[0], a[1] + part * way[1]])
}
