//! The four reference systems of the paper.
//!
//! Section 2.2 and Figure 3 put the bound between nearby and far at 150 cm, section 3.2 and
//! Figures 5 to 9 at 120 cm; so there are two systems for the robot.

use crate::depth_reference::{DepthClass, DepthReference};

/// A class as the paper prints it: short label, name, lower bound in centimetres.
type Printed = (&'static str, &'static str, u32);

const DRS1: &[Printed] = &[("c", "close", 0), ("n", "nearby", 40), ("f", "far", 60)];

const DRS2: &[Printed] = &[
    ("ch", "closer_than_halfway", 0),
    ("h", "halfway", 20),
    ("ct", "closer_than", 30),
    ("n", "nearby", 40),
    ("ctw", "closer_than_twice", 60),
    ("d", "double", 80),
    ("fd", "further_than_double", 120),
];

const ROBOT_150: &[Printed] = &[
    ("vc", "very_close", 0),
    ("c", "close", 60),
    ("n", "nearby", 100),
    ("f", "far", 150),
    ("vf", "very_far", 250),
];

const ROBOT_120: &[Printed] = &[
    ("vc", "very_close", 0),
    ("c", "close", 60),
    ("n", "nearby", 100),
    ("f", "far", 120),
    ("vf", "very_far", 250),
];

impl DepthReference {
    /// The names of the preset systems, as [`DepthReference::preset`] takes them.
    pub const PRESETS: [&'static str; 4] = ["drs1", "drs2", "robot-150", "robot-120"];

    /// The preset system of this name, if there is one.
    #[must_use]
    pub fn preset(name: &str) -> Option<Self> {
        match name {
            "drs1" => Some(Self::drs1()),
            "drs2" => Some(Self::drs2()),
            "robot-150" => Some(Self::robot_150()),
            "robot-120" => Some(Self::robot_120()),
            _ => None,
        }
    }

    /// The coarse system of section 3.1 and Table 2: close, nearby, far at 0, 40, 60 cm.
    #[must_use]
    pub fn drs1() -> Self {
        of_printed("drs1", DRS1)
    }

    /// The fine system of section 3.1 and Table 3: seven classes up to 120 cm.
    #[must_use]
    pub fn drs2() -> Self {
        of_printed("drs2", DRS2)
    }

    /// The robot's reach as section 2.2 and Figure 3 divide it; far begins at 150 cm.
    #[must_use]
    pub fn robot_150() -> Self {
        of_printed("robot-150", ROBOT_150)
    }

    /// The robot's reach as section 3.2 and Figures 5 to 9 divide it; far begins at 120 cm.
    #[must_use]
    pub fn robot_120() -> Self {
        of_printed("robot-120", ROBOT_120)
    }
}

fn of_printed(name: &str, classes: &[Printed]) -> DepthReference {
    let classes = classes
        .iter()
        .map(|&(short, name, from_cm)| DepthClass {
            short: short.into(),
            name: name.into(),
            from_mm: from_cm * 10,
        })
        .collect();
    DepthReference::new(name, classes).expect("the paper's bounds ascend from 0")
}
