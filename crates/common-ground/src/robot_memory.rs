use allocentric_qsr::SceneMemory;

/// What the map keeps of one robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotMemory {
    /// The run and the number of the last report.
    pub last: (u64, u64),
    /// How many reports never came.
    pub lost: u64,
    /// How many reports the memory refused.
    pub refused: u64,
    /// What it has seen, in its own frames.
    pub memory: SceneMemory,
}
