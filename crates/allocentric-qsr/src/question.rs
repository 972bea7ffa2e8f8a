//! Questions about where things are, each with what is certain and what is possible.

use crate::certainty::Certainty;
use crate::ground_extent::GroundExtent;
use crate::observer::Observer;
use crate::scene_memory::SceneMemory;
use crate::{DepthSet, FreePath, ObjectId, OrientationSet};

impl SceneMemory {
    /// How sure it is that an object is at one of these distance classes from the observer or
    /// object; `None` if one is unknown.
    #[must_use]
    pub fn is_within(
        &self,
        object: &ObjectId,
        classes: DepthSet,
        of: &Observer,
    ) -> Option<Certainty> {
        let depth = match of {
            Observer::Robot => self.place_from(self.robot, object)?.places.depth,
            Observer::At(pose) => self.place_from((*pose).into(), object)?.places.depth,
            Observer::Object(other) => self.relation(other, object, &Observer::Robot)?.places.depth,
        };
        Some(Certainty::of(depth, classes))
    }

    /// How sure it is that an object bears one of these labels: at an object, against the
    /// direction to it from `seen_from`; at the robot or a pose, against its heading, and then
    /// `seen_from` plays no part. `None` if one is unknown.
    #[must_use]
    pub fn is_oriented(
        &self,
        object: &ObjectId,
        labels: OrientationSet,
        of: &Observer,
        seen_from: &Observer,
    ) -> Option<Certainty> {
        let orientation = match of {
            Observer::Robot => self.place_from(self.robot, object)?.places.orientation,
            Observer::At(pose) => self.place_from((*pose).into(), object)?.places.orientation,
            Observer::Object(other) => self.relation(other, object, seen_from)?.places.orientation,
        };
        Some(Certainty::of(orientation, labels))
    }

    /// Every object that may be at one of these distance classes from the centre, by name.
    #[must_use]
    pub fn within(&self, centre: &Observer, classes: DepthSet) -> Vec<(ObjectId, Certainty)> {
        self.which(|object| self.is_within(object, classes, centre))
    }

    /// Every object that may bear one of these labels at the reference, by name.
    #[must_use]
    pub fn oriented(
        &self,
        reference: &Observer,
        labels: OrientationSet,
        seen_from: &Observer,
    ) -> Vec<(ObjectId, Certainty)> {
        self.which(|object| self.is_oriented(object, labels, reference, seen_from))
    }

    /// Every object that may lie between two others: beyond the one and before the other on the
    /// way between them, however far aside. `None` if one is not in the present frame.
    #[must_use]
    pub fn between(&self, one: &ObjectId, other: &ObjectId) -> Option<Vec<(ObjectId, Certainty)>> {
        let sigmas = self.params.qualify.sigmas;
        let extent = |object: &ObjectId| Some(GroundExtent::of(&self.here(object)?, sigmas));
        let (from, to) = (extent(one)?, extent(other)?);
        Some(self.which(|object| {
            if object == one || object == other {
                return None;
            }
            let ways = extent(object)?.between(from, to);
            Some(if ways.iter().all(|way| way.low > 0.0) {
                Certainty::Certain
            } else if ways.iter().all(|way| way.high > 0.0) {
                Certainty::Possible
            } else {
                Certainty::No
            })
        }))
    }

    /// How sure it is that an object is within reach of the robot, and what is on the straight
    /// way to it. `None` if it is not in the present frame.
    #[must_use]
    pub fn reachable(
        &self,
        object: &ObjectId,
        reach_m: f64,
        radius_m: f64,
    ) -> Option<(Certainty, FreePath)> {
        let sigmas = self.params.qualify.sigmas;
        let place = self.here(object)?;
        let robot = self.robot.pose();
        let relative = place.widened(self.robot.covariance_m2());
        let here = GroundExtent::point([robot.x_m(), robot.z_m()]);
        let distances = here.distances_to(GroundExtent::of(&relative, sigmas));
        let certainty = if distances.high <= reach_m {
            Certainty::Certain
        } else if distances.low <= reach_m {
            Certainty::Possible
        } else {
            Certainty::No
        };
        let path = self.free_path(
            &Observer::Robot,
            &Observer::Object(object.clone()),
            radius_m,
        )?;
        Some((certainty, path))
    }

    /// The look that shows an object last and its time, tombstones included.
    #[must_use]
    pub fn last_seen(&self, object: &ObjectId) -> Option<(u64, u64)> {
        let kept = self.objects.get(object)?;
        Some((kept.last_look, kept.last_time_ms))
    }

    /// The living objects of which something is not impossible, by name.
    pub(crate) fn which(
        &self,
        sure: impl Fn(&ObjectId) -> Option<Certainty>,
    ) -> Vec<(ObjectId, Certainty)> {
        self.living()
            .filter_map(|name| Some((name.clone(), sure(name)?)))
            .filter(|(_, certainty)| *certainty != Certainty::No)
            .collect()
    }
}
