use std::collections::BTreeMap;

use allocentric_qsr::{
    BadMemoryParams, DepthReference, MemoryLine, MemoryParams, MemoryReply, Policy, SceneMemory,
};

use crate::receipt::{Receipt, Verdict};
use crate::robot_memory::RobotMemory;
use crate::roster::Roster;
use crate::{Report, RobotId};

/// The parameters of a memory that is shared: what a robot sees is believed, free ground stays with the robot that
/// drives over it, and few changes are kept, for every look copies them.
#[must_use]
pub fn shared_params() -> MemoryParams {
    MemoryParams {
        policy: Policy::Follow,
        ground_mm: 0,
        most_changes: 64,
        ..MemoryParams::default()
    }
}

/// One map of what several robots see.
///
/// Each robot has a memory in frames of its own, the same as it would have alone: what others report never changes
/// it. What one robot knows of what another has seen goes through the landmarks both have, when it is asked for. A
/// robot that sends nothing more leaves its sightings.
///
/// The same reports of each robot in the same order make the same map, however those of different robots mingle.
#[derive(Clone, Debug, PartialEq)]
pub struct SharedMap {
    pub(crate) reference: DepthReference,
    pub(crate) params: MemoryParams,
    pub(crate) robots: BTreeMap<RobotId, RobotMemory>,
    /// Which robots have seen an object, so that a question finds them; gone things included.
    pub(crate) roster: Roster,
}

impl SharedMap {
    /// A map of no robot.
    ///
    /// # Errors
    /// [`BadMemoryParams`] says which parameter cannot be.
    pub fn new(reference: &DepthReference, params: MemoryParams) -> Result<Self, BadMemoryParams> {
        SceneMemory::new(reference, params)?;
        Ok(Self {
            reference: reference.clone(),
            params,
            robots: BTreeMap::new(),
            roster: Roster::default(),
        })
    }

    /// A map made like this one, of these robots.
    pub(crate) fn of_robots(
        &self,
        robots: impl IntoIterator<Item = (RobotId, RobotMemory)>,
    ) -> Self {
        let robots: BTreeMap<RobotId, RobotMemory> = robots.into_iter().collect();
        let mut roster = Roster::default();
        for (robot, kept) in &robots {
            for (object, _) in kept.memory.objects() {
                roster.add(robot, object);
            }
        }
        Self {
            reference: self.reference.clone(),
            params: self.params,
            robots,
            roster,
        }
    }

    /// The robots that have reported, by name.
    pub fn robots(&self) -> impl Iterator<Item = (&RobotId, &RobotMemory)> {
        self.robots.iter()
    }

    /// What the map keeps of this robot.
    #[must_use]
    pub fn robot(&self, robot: &RobotId) -> Option<&RobotMemory> {
        self.robots.get(robot)
    }

    /// Takes in a report. The first of a robot opens its memory. One that was taken before, or is older than the
    /// last, changes nothing; a gap before it counts as lost, unless the robot keeps what is missing: then the report is
    /// early, and not taken before that has come.
    ///
    /// # Panics
    /// Never: the parameters were checked when the map was made.
    pub fn take(&mut self, report: &Report) -> Receipt {
        let last = self.robots.get(&report.robot).map(|robot| robot.last);
        let receipt = |lost: u64, verdict: Verdict| Receipt {
            robot: report.robot.clone(),
            run: report.run,
            seq: report.seq,
            lost,
            verdict,
        };
        let lost = self.robots.get(&report.robot).map_or(0, |kept| kept.lost);
        if report.seq == 0 || matches!(report.line, MemoryLine::Ask(_)) {
            let why = "reports are numbered from 1 on, and a question is no report".to_owned();
            return receipt(lost, Verdict::Refused { why });
        }
        if last.is_some_and(|last| (report.run, report.seq) <= last) {
            return receipt(lost, Verdict::Again);
        }
        let expected = match last {
            Some((run, seq)) if run == report.run => seq + 1,
            _ => 1,
        };
        let to_come = report
            .kept_from
            .is_some_and(|from| from.max(expected) < report.seq);
        if to_come {
            return receipt(lost, Verdict::Early { expected });
        }
        let kept = self.robots.entry(report.robot.clone()).or_insert_with(|| {
            let memory = SceneMemory::new(&self.reference, self.params);
            RobotMemory {
                last: (report.run, 0),
                lost: 0,
                refused: 0,
                memory: memory.expect("the parameters were checked when the map was made"),
            }
        });
        kept.lost += report.seq - expected;
        kept.last = (report.run, report.seq);
        let lost = kept.lost;
        match kept.memory.take(report.line.clone()) {
            MemoryReply::Changes(changes) => {
                if let MemoryLine::Look(look) = &report.line {
                    for seen in &look.seen {
                        self.roster.add(&report.robot, &seen.object);
                    }
                }
                receipt(lost, Verdict::Taken { changes })
            }
            MemoryReply::Refused(why) => {
                kept.refused += 1;
                receipt(lost, Verdict::Refused { why })
            }
            MemoryReply::Answer(_) => unreachable!("a question was turned away above"),
        }
    }
}
