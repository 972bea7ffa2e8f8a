use std::fmt;

use dorsal::allocentric_qsr::{
    BadSighting, FreePath, GroundPose, Inference, Life, Mode, ObjectId, Observer, Places,
    QualitativeScene, SceneMemory, Sighting,
};
use stereo_scenes::{Head, Room};

use crate::footprint::Footprint;
use crate::true_places::TruePlaces;

/// A map beside the truth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Score {
    /// Objects that the head can see.
    pub objects: usize,
    /// Of these, the ones that the memory does not believe in.
    pub missed: Vec<ObjectId>,
    /// Objects believed more than [`Score::GHOST_M`] from where they are.
    pub ghosts: Vec<ObjectId>,
    /// Where each believed object is off, in metres, and in its own standard errors.
    pub off: Vec<Off>,
    /// Ordered pairs by the sound calculus, from the map's places.
    pub sound: Pairs,
    /// The same pairs by the paper's composition from the same places.
    pub published: Pairs,
    /// Straight ways asked for.
    pub ways: Ways,
}

/// How far a believed object is from where it is.
#[derive(Clone, Debug, PartialEq)]
pub struct Off {
    /// The object.
    pub object: ObjectId,
    /// Over the ground, in metres.
    pub metres: f64,
    /// The larger of the two axes' errors in standard errors: beyond 3 its relations promise nothing.
    pub sigmas: f64,
}

/// What answers about ordered pairs of objects came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Pairs {
    /// How many were asked.
    pub asked: usize,
    /// Answers with the true distance class.
    pub depth_right: usize,
    /// Answers with the true orientation.
    pub orientation_right: usize,
    /// Distance classes in all answers together.
    pub depths: usize,
    /// Orientations in all answers together.
    pub orientations: usize,
}

/// What straight ways came to.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Ways {
    /// Answers `clear`.
    pub clear: usize,
    /// Answers `blocked`.
    pub blocked: usize,
    /// Answers `unknown`.
    pub unknown: usize,
    /// Answers `clear` where something stands in the way.
    pub wrong: usize,
}

impl Pairs {
    fn count(&mut self, answer: Places, truth: Places) {
        self.asked += 1;
        self.depth_right += usize::from(answer.depth & truth.depth == truth.depth);
        let both = answer.orientation & truth.orientation;
        self.orientation_right += usize::from(both == truth.orientation);
        self.depths += answer.depth.iter().count();
        self.orientations += answer.orientation.iter().count();
    }

    /// Adds the counts of another map.
    pub const fn add(&mut self, other: &Self) {
        self.asked += other.asked;
        self.depth_right += other.depth_right;
        self.orientation_right += other.orientation_right;
        self.depths += other.depths;
        self.orientations += other.orientations;
    }

    /// The part of the answers that hold the true class, and the part that hold the true label.
    #[must_use]
    pub fn right(&self) -> (f64, f64) {
        let of = self.asked.max(1) as f64;
        (
            self.depth_right as f64 / of,
            self.orientation_right as f64 / of,
        )
    }

    /// How many classes and labels are left in the mean.
    #[must_use]
    pub fn left(&self) -> (f64, f64) {
        let of = self.asked.max(1) as f64;
        (self.depths as f64 / of, self.orientations as f64 / of)
    }
}

impl Ways {
    /// Adds the counts of another map.
    pub const fn add(&mut self, other: &Self) {
        self.clear += other.clear;
        self.blocked += other.blocked;
        self.unknown += other.unknown;
        self.wrong += other.wrong;
    }
}

/// The radius of a hand, in metres.
pub const HAND_M: f64 = 0.03;

impl Score {
    /// An object believed farther than this from its place is a ghost, in metres.
    pub const GHOST_M: f64 = 0.1;

    /// The part of the answers that may lack the truth: each of four coordinates lies beyond three
    /// standard errors with 0.27 %.
    pub const MISCOVERAGE: f64 = 0.011;

    pub(crate) fn of(
        memory: &SceneMemory,
        truth: &TruePlaces,
        room: &Room,
        head: &Head,
    ) -> Result<Self, BadSighting> {
        let mut score = Self::default();
        let mut believed = Vec::new();
        for (name, place) in truth.iter() {
            score.objects += 1;
            let life = memory.object(name).map(|kept| kept.life);
            let Some(found) = memory.from_robot(name).filter(|_| believes(life)) else {
                score.missed.push(name.clone());
                continue;
            };
            let error = [
                found.right_m - place.position.x_m,
                found.forward_m - place.position.z_m,
            ];
            let [[rr, _], [_, ff]] = found.covariance_m2;
            let metres = error[0].hypot(error[1]);
            let sigmas = (error[0].abs() / rr.sqrt()).max(error[1].abs() / ff.sqrt());
            if metres > Self::GHOST_M {
                score.ghosts.push(name.clone());
            }
            score.off.push(Off {
                object: name.clone(),
                metres,
                sigmas,
            });
            believed.push(name.clone());
        }
        score.pairs(memory, truth, &believed)?;
        score.paths(memory, room, head, &believed);
        Ok(score)
    }

    fn pairs(
        &mut self,
        memory: &SceneMemory,
        truth: &TruePlaces,
        believed: &[ObjectId],
    ) -> Result<(), BadSighting> {
        let (reference, params) = (memory.reference(), memory.params().qualify);
        let exact = truth.scene(reference, params)?;
        let places = believed.iter().filter_map(|name| sighting(memory, name));
        let scene = QualitativeScene::qualify_with(places, reference, params)?;
        let published = Inference::of_scene(&scene, Mode::Published);
        for from in believed {
            for to in believed.iter().filter(|to| *to != from) {
                let Some(so) = exact.relation(from, to) else {
                    continue;
                };
                if let Some(answer) = memory.relation(from, to, &Observer::Robot) {
                    self.sound.count(answer.places, so.places);
                }
                if let Some(answer) = published.relation(from, to) {
                    self.published.count(answer.places, so.places);
                }
            }
        }
        Ok(())
    }

    /// The straight ways between the objects, and from three places of a hand at the near end.
    fn paths(&mut self, memory: &SceneMemory, room: &Room, head: &Head, believed: &[ObjectId]) {
        let hands = [-0.3, 0.0, 0.3].into_iter();
        let hands = hands.filter_map(|right| GroundPose::new(right, 0.75, 0.0).ok());
        let hands = hands.map(Observer::At);
        let objects = believed.iter().cloned().map(Observer::Object);
        let starts: Vec<Observer> = hands.chain(objects).collect();
        for from in &starts {
            for to in believed {
                let to = Observer::Object(to.clone());
                if *from == to {
                    continue;
                }
                match memory.free_path(from, &to, HAND_M) {
                    Some(FreePath::Clear) => {
                        self.ways.clear += 1;
                        let free = is_free(memory, room, head, from, &to);
                        self.ways.wrong += usize::from(!free);
                    }
                    Some(FreePath::Blocked { .. }) => self.ways.blocked += 1,
                    Some(FreePath::Unknown { .. }) => self.ways.unknown += 1,
                    None => {}
                }
            }
        }
    }

    /// Whether everything holds that a map must hold: no wrong `clear`, and no more answers without
    /// the truth than the intervals allow.
    #[must_use]
    pub fn holds(&self) -> bool {
        let (depth, orientation) = self.sound.right();
        self.ways.wrong == 0 && depth.min(orientation) >= 1.0 - Self::MISCOVERAGE
    }
}

impl fmt::Display for Score {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = |names: &[ObjectId]| {
            let names: Vec<&str> = names.iter().map(ObjectId::as_str).collect();
            if names.is_empty() {
                "none".to_owned()
            } else {
                names.join(", ")
            }
        };
        writeln!(
            f,
            "objects   {} to be seen; missed: {}; ghosts: {}",
            self.objects,
            names(&self.missed),
            names(&self.ghosts)
        )?;
        let worst = |by: fn(&Off) -> f64| self.off.iter().map(by).fold(0.0, f64::max);
        writeln!(
            f,
            "places    off by {:.1} cm and {:.1} standard errors at the most",
            100.0 * worst(|off| off.metres),
            worst(|off| off.sigmas)
        )?;
        for (name, pairs) in [("sound", &self.sound), ("published", &self.published)] {
            let ((depth, orientation), (classes, labels)) = (pairs.right(), pairs.left());
            writeln!(
                f,
                "{name:<9} {} pairs: true class in {:.1} %, true orientation in {:.1} %; {classes:.2} \
                 classes and {labels:.2} labels left",
                pairs.asked,
                100.0 * depth,
                100.0 * orientation
            )?;
        }
        write!(
            f,
            "ways      {} clear, {} of them wrongly; {} blocked, {} not known",
            self.ways.clear, self.ways.wrong, self.ways.blocked, self.ways.unknown
        )
    }
}

/// Whether an object in this life is believed to be where it is remembered.
pub(crate) fn believes(life: Option<Life>) -> bool {
    matches!(
        life,
        Some(Life::Confirmed | Life::InView | Life::OutOfView | Life::Occluded)
    )
}

/// The place of a remembered object as a sighting of the robot: what the paper's calculus starts from.
pub(crate) fn sighting(memory: &SceneMemory, object: &ObjectId) -> Option<Sighting> {
    let place = memory.from_robot(object)?;
    let (right, forward) = (place.right_m, place.forward_m);
    let distance_m = right.hypot(forward);
    let [[rr, rf], [_, ff]] = place.covariance_m2;
    let along = |a: f64, b: f64| (a * a * rr + 2.0 * a * b * rf + b * b * ff).max(0.0).sqrt();
    Some(Sighting {
        object: object.clone(),
        distance_m,
        bearing_rad: forward.atan2(right),
        sigma_distance_m: along(right / distance_m, forward / distance_m),
        sigma_bearing_rad: along(-forward / distance_m, right / distance_m) / distance_m,
    })
}

/// Whether the straight way is free in the room, but for the objects at its ends.
pub(crate) fn is_free(
    memory: &SceneMemory,
    room: &Room,
    head: &Head,
    from: &Observer,
    to: &Observer,
) -> bool {
    let end = |at: &Observer| match at {
        Observer::Object(name) => {
            let place = memory.from_robot(name)?;
            Some([place.right_m, place.forward_m])
        }
        Observer::At(pose) => Some([pose.x_m(), pose.z_m()]),
        Observer::Robot => Some([0.0, 0.0]),
    };
    let (Some(a), Some(b)) = (end(from), end(to)) else {
        return false;
    };
    let at_end = |name: &str| {
        [from, to]
            .iter()
            .any(|end| matches!(end, Observer::Object(object) if object.as_str() == name))
    };
    let feet = room.objects().iter().filter(|thing| !at_end(&thing.name));
    let feet: Vec<Footprint> = feet.map(|thing| Footprint::of(&thing.shape)).collect();
    // A step of 2 mm: what is grazed by less is not hit.
    let steps = ((a[0] - b[0]).hypot(a[1] - b[1]) / 0.002).ceil() as usize + 1;
    let (sin, cos) = head.heading_rad.sin_cos();
    (0..=steps).all(|step| {
        let part = step as f64 / steps as f64;
        let (right, forward) = (a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1]));
        let point = [
            head.position_m[0] + right * cos + forward * sin,
            head.position_m[1] - right * sin + forward * cos,
        ];
        feet.iter().all(|foot| foot.distance_m(point) > HAND_M)
    })
}
