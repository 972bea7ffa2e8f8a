use crate::egocentric_place::{EgocentricPlace, read_offset};
use crate::ground_estimate::GroundEstimate;
use crate::robot_pose::RobotPose;
use crate::scene_memory::SceneMemory;
use crate::{Mode, ObjectId};

/// Where an object is for the robot: what an arm needs to reach it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotPlace {
    /// To the right of the robot, in metres.
    pub right_m: f64,
    /// Ahead of the robot, in metres.
    pub forward_m: f64,
    /// The covariance `[[rr, rf], [rf, ff]]` in square metres, the errors of the pose included.
    pub covariance_m2: [[f64; 2]; 2],
}

impl SceneMemory {
    /// Where an object is for the robot, seen or unseen. An object of an earlier map frame is carried
    /// into the present one by the landmarks that both have, two at least, with the errors of that.
    /// `None` if nothing joins the frames, or the object is gone or was never seen.
    #[must_use]
    pub fn from_robot(&self, object: &ObjectId) -> Option<RobotPlace> {
        Some(self.robot_place(&self.here(object)?))
    }

    /// A place of the present frame for the robot, with the errors of the pose.
    pub(crate) fn robot_place(&self, estimate: &GroundEstimate) -> RobotPlace {
        let pose = self.robot.pose();
        let seen = estimate.widened(self.robot.spread_at(estimate.position_m()));
        let [ahead, leftward] = estimate.seen_from(pose);
        let (sin, cos) = pose.heading_rad().sin_cos();
        let [[xx, xz], [_, zz]] = seen.covariance_m2();
        // Right is (cos, sin) and forward (-sin, cos) of the frame's x and z.
        let along = |a: [f64; 2], b: [f64; 2]| {
            a[0] * (xx * b[0] + xz * b[1]) + a[1] * (xz * b[0] + zz * b[1])
        };
        let (right, forward) = ([cos, sin], [-sin, cos]);
        RobotPlace {
            right_m: -leftward,
            forward_m: ahead,
            covariance_m2: [
                [along(right, right), along(right, forward)],
                [along(right, forward), along(forward, forward)],
            ],
        }
    }

    /// Where an object is for an observer at any pose of the present frame, seen or unseen, as
    /// [`SceneMemory::from_robot`].
    #[must_use]
    pub fn place_from(&self, robot: RobotPose, object: &ObjectId) -> Option<EgocentricPlace> {
        let estimate = self.here(object)?;
        let (pose, qualify) = (robot.pose(), self.params.qualify);
        // The heading turns the bearing only, the position moves the place.
        let still = RobotPose::new(pose, robot.covariance_m2(), 0.0).unwrap_or(robot);
        let relative = estimate.widened(still.spread_at(estimate.position_m()));
        let bounds = relative.bounds(qualify.sigmas).seen_from(pose);
        let turned = bounds.turned_within(qualify.sigmas * robot.sigma_heading_rad());
        Some(EgocentricPlace {
            object: object.clone(),
            places: turned.egocentric(&self.reference),
            read: read_offset(
                estimate.seen_from(pose),
                &self.reference,
                qualify.axis_tolerance_rad,
            ),
            mode: Mode::Sound,
        })
    }
}
