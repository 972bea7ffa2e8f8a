use std::io::Write;
use std::path::Path;
use std::time::{SystemTime, UNIX_EPOCH};

use anyhow::Context as _;
use dorsal::DepthEvidence;
use dorsal::allocentric_qsr::{
    Change, Look, NoDepth, PoseKnowledge, Refused, RobotPose, SceneMemory,
};
use dorsal::egocentric_depth::{DepthMap, LocateParams};
use stereo_formats::{pfm, rig_toml};

use crate::memory_arguments::AddArguments;
use crate::memory_changes::write_changes;
use crate::memory_file::MemoryFile;
use crate::scene_file::SceneFile;

/// `dorsal memory add`: takes the objects of a scene into the memory.
pub(crate) fn add(
    file: &Path,
    arguments: &AddArguments,
    out: &mut dyn Write,
) -> anyhow::Result<()> {
    let file = MemoryFile::hold(file)?;
    let mut memory = file.read()?;
    let path = SceneFile::path(&arguments.scene);
    let scene = SceneFile::read(&path)?;
    let look = Look {
        time_ms: arguments.time.unwrap_or_else(now_ms),
        pose: pose(arguments, &memory)?,
        observations: scene.observations(arguments.eyes_height.unwrap_or(0.0)),
    };
    let changes = observe(&mut memory, &look, arguments, &path)?
        .with_context(|| format!("{} is not taken in", path.display()))?;
    if !arguments.dry_run {
        file.write(&memory)?;
    }
    write_changes(&changes, arguments.form, out)
}

fn observe(
    memory: &mut SceneMemory,
    look: &Look,
    arguments: &AddArguments,
    scene: &Path,
) -> anyhow::Result<Result<Vec<Change>, Refused>> {
    let Some(rig) = &arguments.rig else {
        return Ok(memory.observe(look, &NoDepth));
    };
    let rig = rig_toml::read(rig)?;
    let path = arguments
        .depth
        .clone()
        .unwrap_or_else(|| scene.with_file_name("depth.pfm"));
    let mut depth = DepthMap::new(pfm::read(&path)?);
    // A look by the vector pyramid leaves the disparities' own error beside the depth.
    let sigma = path.with_file_name("sigma.pfm");
    if sigma.is_file() {
        depth = depth
            .with_disparity_sigma(pfm::read(&sigma)?)
            .with_context(|| format!("{} and {}", sigma.display(), path.display()))?;
    }
    let evidence = DepthEvidence::new(
        &depth,
        &rig,
        arguments.eyes_height.unwrap_or(0.0),
        LocateParams::default().disparity_sigma_px,
    );
    Ok(memory.observe(look, &evidence))
}

fn pose(arguments: &AddArguments, memory: &SceneMemory) -> anyhow::Result<PoseKnowledge> {
    if arguments.lost {
        return Ok(PoseKnowledge::Lost);
    }
    let Some(pose) = arguments.pose else {
        return Ok(PoseKnowledge::Known(memory.robot()));
    };
    let Some(error) = arguments.pose_sigma else {
        return Ok(PoseKnowledge::Known(pose.0.into()));
    };
    let variance = error.position_m * error.position_m;
    let covariance = [[variance, 0.0], [0.0, variance]];
    Ok(PoseKnowledge::Known(RobotPose::new(
        pose.0,
        covariance,
        error.heading_rad,
    )?))
}

/// Milliseconds since 1970; a clock before that is a clock that nobody set.
fn now_ms() -> u64 {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    since.map_or(0, |since| {
        u64::try_from(since.as_millis()).unwrap_or(u64::MAX)
    })
}
