use crate::ObjectId;
use crate::ground_estimate::GroundEstimate;
use crate::ground_extent::GroundExtent;
use crate::ground_pose::GroundPose;
use crate::life::Life;
use crate::scene_memory::SceneMemory;

/// From where a relation is told.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Observer {
    /// The robot, where it last was.
    Robot,
    /// Somebody at the place of this object.
    Object(ObjectId),
    /// Somebody at this pose of the present frame.
    At(GroundPose),
}

impl SceneMemory {
    /// Where an observer may stand in a frame: best guess and extent. The robot stands in the
    /// present frame only.
    pub(crate) fn observer_extent(
        &self,
        frame: u32,
        observer: &Observer,
    ) -> Option<(GroundPose, GroundExtent)> {
        let sigmas = self.params.qualify.sigmas;
        let at = |pose: GroundPose| GroundExtent::point([pose.x_m(), pose.z_m()]);
        match observer {
            Observer::Robot if frame == self.frame => {
                let pose = self.robot.pose();
                if self.robot.is_exact() {
                    return Some((pose, at(pose)));
                }
                let place =
                    GroundEstimate::of([pose.x_m(), pose.z_m()], self.robot.covariance_m2());
                Some((pose, GroundExtent::of(&place, sigmas)))
            }
            Observer::At(pose) if frame == self.frame => Some((*pose, at(*pose))),
            Observer::Robot | Observer::At(_) => None,
            Observer::Object(object) => {
                let kept = self.objects.get(object)?;
                let seen = kept
                    .places
                    .get(&frame)
                    .filter(|_| kept.life != Life::Removed)
                    .copied();
                let carried = || self.here(object).filter(|_| frame == self.frame);
                let place = seen.or_else(carried)?;
                let [x, z] = place.position_m();
                let pose = GroundPose::new(x, z, 0.0).ok()?;
                Some((pose, GroundExtent::of(&place, sigmas)))
            }
        }
    }
}
